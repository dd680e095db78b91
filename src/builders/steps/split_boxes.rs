//! A split of a cut as boxes, for pictures of it (Figures 3 and 5 of the paper).

use crate::builders::binary::node::Node;
use crate::builders::phr::policy::SeenSplit;
use crate::geometry::Aabb;
use std::collections::HashMap;

/// A split as boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitBoxes {
    /// Binary splits above.
    pub depth: u32,
    /// The axis of the order or of the plane.
    pub axis: usize,
    /// Where the plane of a spatial split is.
    pub plane: Option<f32>,
    /// The nodes of the cut.
    pub cut: Vec<Aabb>,
    /// Its sides.
    pub sides: [SideBoxes; 2],
}

/// A side of a split, refined by opening nodes one level, as PHR does. Boxes are clipped by the planes of spatial
/// splits.
#[derive(Clone, Debug, PartialEq)]
pub struct SideBoxes {
    /// What is left of space; infinite where nothing was cut off.
    pub clip: Aabb,
    /// The nodes that stay.
    pub kept: Vec<Aabb>,
    /// Those that are opened.
    pub opened: Vec<OpenedNode>,
}

/// A node that is replaced by its children.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenedNode {
    /// Its box.
    pub bounds: Aabb,
    /// Those of its children that are nodes of the refined side.
    pub children: Vec<Aabb>,
    /// Those that are not, as they lie beyond a plane; not clipped.
    pub discarded: Vec<Aabb>,
}

impl SplitBoxes {
    pub(super) fn of(split: &SeenSplit<'_>) -> Self {
        Self {
            depth: split.depth,
            axis: split.axis,
            plane: split.plane,
            cut: split.cut.iter().map(Node::bounds).collect(),
            sides: [0, 1].map(|side| SideBoxes::of(split, side)),
        }
    }

    /// The union of the cut's boxes.
    pub fn bounds(&self) -> Aabb {
        self.cut.iter().copied().collect()
    }

    /// Depth and corners, by which splits are put in order.
    pub(super) fn place(&self) -> (u32, [f32; 3], [f32; 3]) {
        let bounds = self.bounds();
        (self.depth, bounds.min.to_array(), bounds.max.to_array())
    }
}

impl SideBoxes {
    fn of(split: &SeenSplit<'_>, side: usize) -> Self {
        let refined: HashMap<_, _> =
            split.refined[side].iter().map(|it| (subtree(it), it.bounds())).collect();
        let (mut kept, mut opened) = (Vec::new(), Vec::new());
        for node in split.sides[side] {
            if node.is_leaf() || refined.contains_key(&subtree(node)) {
                kept.push(node.bounds());
                continue;
            }
            let (mut children, mut discarded) = (Vec::new(), Vec::new());
            for child in split.tree.children(node) {
                match refined.get(&subtree(child)) {
                    Some(bounds) => children.push(*bounds),
                    None => discarded.push(child.bounds()),
                }
            }
            opened.push(OpenedNode { bounds: node.bounds(), children, discarded });
        }
        Self { clip: split.clips[side], kept, opened }
    }

    /// Its nodes before it is refined.
    pub fn nodes(&self) -> impl Iterator<Item = &Aabb> {
        self.kept.iter().chain(self.opened.iter().map(|node| &node.bounds))
    }

    /// Its nodes after.
    pub fn refined(&self) -> impl Iterator<Item = &Aabb> {
        self.kept.iter().chain(self.opened.iter().flat_map(|node| &node.children))
    }
}

/// Which subtree a node is, whatever of its box is left.
fn subtree(node: &Node) -> (bool, usize) {
    node.pair().map_or_else(|| (true, node.run().start), |pair| (false, pair))
}
