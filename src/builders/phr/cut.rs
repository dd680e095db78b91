//! Cuts of the auxiliary BVH, and the two sides that a split makes of one.

use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::bvh::limits::BLOCK;
use crate::geometry::Aabb;
use crate::memory::huge_pages;
use glam::Vec3A;

/// All of space: the clip box above the first spatial split.
pub(crate) const SPACE: Aabb = Aabb::new(Vec3A::NEG_INFINITY, Vec3A::INFINITY);

/// A cut: disjoint subtrees of the auxiliary BVH in depth-first order, which is that of the Morton codes. Its
/// nodes, with clipped boxes, stand in the arena of a thread.
///
/// All fields are of four bytes or vectors: cuts are copied often, and copies of single bytes are slow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    /// Index of the first node in the arena.
    pub first: u32,
    /// Number of nodes.
    pub len: u32,
    /// What spatial splits above have left of space; each finite face lies in a split plane.
    pub clip: Aabb,
    /// The union of the nodes' clipped boxes.
    pub bounds: Aabb,
    /// Its half area.
    pub area: f32,
    /// References below.
    pub count: u32,
    /// References that may be made below: bounds duplication by spatial splits.
    pub capacity: u32,
    /// Binary splits above.
    pub depth: u32,
    /// What its nodes are.
    pub level: CutLevel,
    /// What becomes of it.
    pub kind: Kind,
}

/// What the nodes of a cut are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum CutLevel {
    /// Subtrees of the auxiliary BVH.
    Subtrees,
    /// Single references, near the leaves: splits count blocks.
    References,
    /// One subtree that has been split down to its leaves ([`super::split_down`]).
    SplitDown,
}

/// A cut with nodes of its own.
pub(crate) struct OwnedCut {
    /// Its nodes.
    pub nodes: Vec<Node>,
    /// What is below its node, where it has been split down to its leaves.
    pub subtrees: Subtrees,
    cut: Cut,
}

/// A cut that is built at the end of an arena, measured as it grows.
pub(crate) struct CutBuilder<'a> {
    /// Its nodes are the last ones.
    pub arena: &'a mut Vec<Node>,
    first: usize,
    bounds: Aabb,
    count: u32,
}

impl<'a> CutBuilder<'a> {
    /// An empty cut.
    #[inline]
    pub fn new(arena: &'a mut Vec<Node>) -> Self {
        Self { first: arena.len(), bounds: Aabb::EMPTY, count: 0, arena }
    }

    /// Appends a node.
    #[inline]
    pub fn push(&mut self, node: Node) {
        self.bounds = self.bounds.union(node.bounds());
        self.count += node.count();
        huge_pages::push(self.arena, node, "cuts");
    }

    /// The cut, otherwise as `like`.
    #[inline]
    pub fn finish(self, like: &Cut) -> Cut {
        let kind = match &self.arena[self.first..] {
            [lone] => Kind::of_lone(lone),
            // Finished leaves are not merged to one.
            nodes if self.count <= BLOCK && nodes.iter().any(Node::is_finished) => Kind::Inner,
            _ => Kind::of_count(self.count),
        };
        Cut {
            first: self.first as u32,
            len: (self.arena.len() - self.first) as u32,
            bounds: self.bounds,
            area: self.bounds.half_area(),
            count: self.count,
            kind,
            ..*like
        }
    }
}

impl Cut {
    const EMPTY: Self = Self {
        first: 0,
        len: 0,
        clip: SPACE,
        bounds: Aabb::EMPTY,
        area: 0.0,
        count: 0,
        capacity: 0,
        depth: 0,
        level: CutLevel::Subtrees,
        kind: Kind::Inner,
    };

    /// The whole scene as a cut of `nodes`, with room for `max_references` per reference and for `most` in all.
    pub fn whole(nodes: Vec<Node>, max_references: f32, most: usize) -> OwnedCut {
        let mut owned = Vec::with_capacity(nodes.len());
        let mut cut = CutBuilder::new(&mut owned);
        nodes.into_iter().for_each(|node| cut.push(node));
        let mut cut = cut.finish(&Self::EMPTY);
        cut.capacity = ((cut.count as f32 * max_references) as u32).min(most as u32).max(cut.count);
        OwnedCut { nodes: owned, subtrees: Subtrees::default(), cut }
    }

    /// The indices of its nodes in the arena.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.len) as usize
    }

    /// A cut of the last node in `arena` alone, otherwise as this one.
    #[inline]
    pub fn of_last(&self, arena: &[Node], level: CutLevel, kind: Kind) -> Self {
        let first = arena.len() - 1;
        let bounds = arena[first].bounds();
        Self {
            first: first as u32,
            len: 1,
            bounds,
            area: bounds.half_area(),
            count: arena[first].count(),
            level,
            kind,
            ..*self
        }
    }

    /// Copies the cut out of the arena.
    pub fn export(&self, arena: &[Node]) -> OwnedCut {
        OwnedCut { nodes: arena[self.range()].to_vec(), subtrees: Subtrees::default(), cut: *self }
    }
}

impl OwnedCut {
    /// Copies the cut to the end of `arena`; returns it with what is below.
    pub fn import(self, arena: &mut Vec<Node>) -> (Cut, Subtrees) {
        let first = arena.len() as u32;
        huge_pages::make_room(arena, self.nodes.len(), "cuts");
        arena.extend(self.nodes);
        (Cut { first, ..self.cut }, self.subtrees)
    }
}

/// A side of a split.
#[derive(Default)]
pub(crate) struct Side {
    /// Its nodes, in the order of the cut.
    pub nodes: Vec<Node>,
    /// References below them.
    pub count: u32,
    /// Of [`crate::builders::hunt`] alone: a key for each node, which is ordered as its area.
    pub keys: Vec<i32>,
    /// Of the same alone: the nodes of the next round.
    pub refined: Vec<Node>,
}

impl Side {
    /// Removes the nodes.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.count = 0;
    }

    /// Appends a node.
    #[inline]
    pub fn push(&mut self, node: Node) {
        self.count += node.count();
        huge_pages::push(&mut self.nodes, node, "cuts");
    }

    /// Half area of the union of the nodes' boxes, and the number of references.
    pub fn measure(&self) -> (f32, u32) {
        let bounds: Aabb = self.nodes.iter().map(Node::bounds).collect();
        (bounds.half_area(), self.count)
    }

    /// Partitions the nodes of a cut.
    #[inline]
    pub fn partition(sides: &mut [Self; 2], nodes: &[Node], is_left: impl Fn(usize, &Node) -> bool) {
        for (i, node) in nodes.iter().enumerate() {
            sides[usize::from(!is_left(i, node))].push(*node);
        }
    }
}
