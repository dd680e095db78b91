//! Policy: where cut-based builders differ.

use super::cut::{CutBuilder, Side};
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::geometry::Aabb;

/// A split of a cut, as it was made.
pub(crate) struct SeenSplit<'a> {
    /// The auxiliary tree, whose nodes are split.
    pub tree: &'a BinaryTree,
    /// Binary splits above.
    pub depth: u32,
    /// The axis of the order or of the plane; 0 where the cut was halved for want of a gain.
    pub axis: usize,
    /// Where the plane of a spatial split is.
    pub plane: Option<f32>,
    /// The nodes of the cut.
    pub cut: &'a [Node],
    /// Those of its sides, clipped, before they are refined.
    pub sides: [&'a [Node]; 2],
    /// What is left of space to either side.
    pub clips: [Aabb; 2],
    /// The sides, refined; empty where clipping left nothing.
    pub refined: [&'a [Node]; 2],
}

/// How a side of a split is refined to a cut of its own.
pub(crate) trait CutPolicy: Sync {
    /// Whether refining opens a lone node into its two children at most. Below a cut of one node the splits are
    /// then those of the auxiliary BVH ([`super::exact::single_node`]).
    const KEEPS_SINGLE_NODES: bool;
    /// Whether splits are shown to [`CutPolicy::see`]. Shortcuts to the same tree, which hide splits, are then not
    /// taken. Where it is false nothing of this is left in the compiled builder.
    const SEES: bool = false;

    /// Is shown each split.
    fn see(&self, _: &SeenSplit<'_>) {}

    /// Appends the nodes of a side of a split at binary depth `depth` to `refined`, some of them opened
    /// ([`super::clip::open`]). The side may be changed: it is not used again.
    fn refine(
        &self,
        tree: &BinaryTree,
        clip: &Aabb,
        depth: u32,
        side: &mut Side,
        refined: &mut CutBuilder<'_>,
    );
}
