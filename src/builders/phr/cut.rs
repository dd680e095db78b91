//! Cuts of the auxiliary BVH, clipping under spatial splits (paper 4.4), leaves.

use crate::builders::binary::{BinaryTree, Node};
use crate::builders::lbvh::sort::{Key, reference};
use crate::builders::prims::refs::References;
use crate::builders::wide::top_down::{Kind, QUARTET};
use crate::geometry::Aabb;

/// All of space: the clip box above the first spatial split.
pub(crate) const SPACE: Aabb = Aabb::new(glam::Vec3A::NEG_INFINITY, glam::Vec3A::INFINITY);

/// A cut: disjoint subtrees of the auxiliary BVH in its depth-first order, which is that of the Morton codes.
/// Their boxes are clipped, and stand in the arena of a thread.
///
/// All fields are of four bytes or vectors: cuts are copied often, and copies of single bytes are slow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    /// Place of the first subtree in the arena.
    pub first: u32,
    /// Number of subtrees.
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
    pub stage: Stage,
    /// What is to become of it.
    pub kind: Kind,
}

/// What the nodes of a cut are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Stage {
    /// Subtrees of the auxiliary BVH.
    Nodes,
    /// Single references, near the leaves: splits count quartets.
    References,
    /// One subtree that is split down to its leaves ([`crate::builders::binary::subtrees`]).
    Swept,
}

/// A cut with nodes of its own.
pub(crate) struct OwnCut {
    pub nodes: Vec<Node>,
    cut: Cut,
}

/// A cut in the making at the end of an arena, measured as it grows.
pub(crate) struct Growing<'a> {
    /// Its nodes are the last ones.
    pub arena: &'a mut Vec<Node>,
    first: usize,
    bounds: Aabb,
    count: u32,
}

impl<'a> Growing<'a> {
    /// An empty one.
    #[inline]
    pub fn new(arena: &'a mut Vec<Node>) -> Self {
        Self { first: arena.len(), bounds: Aabb::EMPTY, count: 0, arena }
    }

    /// Appends a node.
    #[inline]
    pub fn push(&mut self, node: Node) {
        self.bounds = self.bounds.union(node.bounds());
        self.count += node.count();
        self.arena.push(node);
    }

    /// The cut, otherwise as `like`.
    #[inline]
    pub fn finish(self, like: &Cut) -> Cut {
        let kind = if self.count <= QUARTET { Kind::Leaf } else { Kind::Inner };
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
    /// The whole scene as a cut of `nodes`, with room for `max_references` per reference.
    pub fn whole(nodes: Vec<Node>, max_references: f32) -> OwnCut {
        let empty = Self {
            first: 0,
            len: 0,
            clip: SPACE,
            bounds: Aabb::EMPTY,
            area: 0.0,
            count: 0,
            capacity: 0,
            depth: 0,
            stage: Stage::Nodes,
            kind: Kind::Inner,
        };
        let mut own = Vec::with_capacity(nodes.len());
        let mut cut = Growing::new(&mut own);
        nodes.into_iter().for_each(|node| cut.push(node));
        let mut cut = cut.finish(&empty);
        cut.capacity = (cut.count as f32 * max_references) as u32;
        OwnCut { nodes: own, cut }
    }

    /// The places of its nodes in the arena.
    pub fn places(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.len) as usize
    }

    /// Takes the cut out of the arena.
    pub fn lift(&self, arena: &[Node]) -> OwnCut {
        OwnCut { nodes: arena[self.places()].to_vec(), cut: *self }
    }
}

impl OwnCut {
    /// Puts the cut at the end of `arena`.
    pub fn plant(self, arena: &mut Vec<Node>) -> Cut {
        let first = arena.len() as u32;
        arena.extend(self.nodes);
        Cut { first, ..self.cut }
    }
}

/// Which boxes of a node's children a clip box leaves something of.
///
/// A box that merely touches a split plane from one side belongs to that side alone, and one that lies in the
/// plane belongs to the left, unless its parent began at the plane and so never was there: else an
/// axis-aligned wall in the plane would be on both sides, or on neither.
struct Clipper<'a> {
    clip: &'a Aabb,
    parent: Aabb,
}

impl Clipper<'_> {
    #[inline]
    fn clip(&self, b: Aabb) -> Option<Aabb> {
        let clip = self.clip;
        // Right of a split plane (clip.min): what ends there is on the left, if the parent was there at all.
        let left_of = b.max.cmple(clip.min) & self.parent.min.cmplt(clip.min);
        // Left of a split plane (clip.max): what begins there and goes on is on the right.
        let right_of = b.min.cmpge(clip.max) & b.max.cmpgt(clip.max);
        (!(left_of | right_of).any()).then(|| b.intersection(*clip))
    }
}

/// Whether a member of a cut lies wholly within the clip box, so that nothing below it is clipped: strictly, as
/// a box cut by a face ends there.
#[inline]
pub(crate) fn is_whole(node: &Node, clip: &Aabb) -> bool {
    is_inside(node.bounds(), clip)
}

/// Whether a box lies strictly within the clip box.
#[inline]
pub(crate) fn is_inside(bounds: Aabb, clip: &Aabb) -> bool {
    (bounds.min.cmpgt(clip.min) & bounds.max.cmplt(clip.max)).all()
}

/// Gives `take` the children of an inner `node` that reach into `clip`, their boxes clipped.
#[inline]
pub(crate) fn open(tree: &BinaryTree, node: &Node, clip: &Aabb, mut take: impl FnMut(Node)) {
    let children = tree.children(node);
    if is_whole(node, clip) {
        take(children[0]);
        take(children[1]);
        return;
    }
    let clipper = Clipper { clip, parent: children[0].bounds().union(children[1].bounds()) };
    for child in children {
        if let Some(bounds) = clipper.clip(child.bounds()) {
            take(child.with_bounds(bounds));
        }
    }
}

/// The references in Morton order, to which the leaves of the auxiliary BVH are opened.
#[derive(Clone, Copy)]
pub(crate) struct Order<'a> {
    /// Sorted keys.
    pub keys: &'a [Key],
    /// What they refer to.
    pub references: References<'a>,
}

impl Order<'_> {
    /// Gives `take` the references below `node`, a member of a cut clipped to `clip`: leaves of one
    /// reference, their boxes clipped.
    pub fn each(&self, tree: &BinaryTree, node: &Node, clip: &Aabb, take: &mut impl FnMut(Node)) {
        if !node.is_leaf() {
            open(tree, node, clip, |child| self.each(tree, &child, clip, take));
            return;
        }
        if node.count() == 1 {
            take(*node);
            return;
        }
        let bounds = |place: usize| self.references.bounds(reference(self.keys[place]));
        if is_whole(node, clip) {
            node.run().for_each(|place| take(Node::leaf(bounds(place), place, 1)));
            return;
        }
        let clipper = Clipper { clip, parent: node.run().map(bounds).collect() };
        for place in node.run() {
            if let Some(bounds) = clipper.clip(bounds(place)) {
                take(Node::leaf(bounds, place, 1));
            }
        }
    }

    /// The triangle at a position.
    pub fn prim(&self, place: usize) -> u32 {
        self.references.prim(reference(self.keys[place]))
    }
}
