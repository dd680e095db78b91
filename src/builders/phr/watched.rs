//! A policy that shows every split to a watcher. The tree stays the same; the build takes longer.

use super::cut::{CutBuilder, Side};
use super::policy::{CutPolicy, SeenSplit};
use crate::builders::binary::tree::BinaryTree;
use crate::geometry::Aabb;

/// Refines as another policy.
pub(crate) struct Watched<'w, P> {
    /// The other.
    pub policy: P,
    /// Is shown each split, by any thread.
    pub watcher: &'w (dyn Fn(&SeenSplit<'_>) + Sync),
}

impl<P: CutPolicy> CutPolicy for Watched<'_, P> {
    // Below a single node splits are known without being made: here they are made.
    const KEEPS_SINGLE_NODES: bool = false;
    const SEES: bool = true;

    fn see(&self, split: &SeenSplit<'_>) {
        (self.watcher)(split);
    }

    fn refine(
        &self,
        tree: &BinaryTree,
        clip: &Aabb,
        depth: u32,
        side: &mut Side,
        refined: &mut CutBuilder<'_>,
    ) {
        self.policy.refine(tree, clip, depth, side, refined);
    }
}
