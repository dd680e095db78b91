//! Policy: where cut-based builders differ.

use super::cut::{CutBuilder, Side};
use crate::builders::binary::tree::BinaryTree;
use crate::geometry::Aabb;

/// How a side of a split is refined to a cut of its own.
pub(crate) trait CutPolicy: Sync {
    /// Whether refining opens a lone node into its two children at most. Below a cut of one node the splits are then those
    /// of the auxiliary BVH ([`super::exact::single_node`]).
    const KEEPS_SINGLE_NODES: bool;

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
