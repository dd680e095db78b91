//! Paper 4.3: refinement of a cut by an adaptive threshold of area (equation 2).

use super::clip::{is_whole, open};
use super::config::{LocalThreshold, PhrConfig};
use super::cut::{CutBuilder, Side};
use super::policy::CutPolicy;
use crate::builders::binary::tree::BinaryTree;
use crate::geometry::Aabb;

/// The rule of equation 2: nodes larger than `t_d = S / 2^(alpha d + delta)` are opened one level.
pub(crate) struct Threshold {
    /// Half of `t_d` by depth d: areas are compared halved.
    by_depth: Vec<f32>,
    local: Option<LocalThreshold>,
}

impl Threshold {
    /// The thresholds of a scene whose box has the given half area.
    pub fn new(scene: f32, config: &PhrConfig) -> Self {
        let at = |d: u32| f64::from(scene) / f64::from(config.alpha * d as f32 + config.delta).exp2();
        Self { by_depth: (0..=128).map(|d| at(d) as f32).collect(), local: config.extensions.local_threshold }
    }

    /// Half of `t_d` at depth `depth`.
    pub fn at(&self, depth: u32) -> f32 {
        self.by_depth[(depth as usize).min(self.by_depth.len() - 1)]
    }

    /// The threshold for a side of a split at depth `depth`.
    #[inline]
    fn of(&self, depth: u32, side: &Side) -> f32 {
        let threshold = self.at(depth);
        match self.local {
            Some(local) if side.count >= local.references => threshold.min(side.measure().0 * local.area),
            _ => threshold,
        }
    }
}

impl CutPolicy for Threshold {
    const KEEPS_SINGLE_NODES: bool = true;

    #[inline]
    fn refine(
        &self,
        tree: &BinaryTree,
        clip: &Aabb,
        depth: u32,
        side: &mut Side,
        refined: &mut CutBuilder<'_>,
    ) {
        if let [node] = side.nodes[..] {
            // A lone node is opened before the next split, whatever its area.
            tree.prefetch(&node);
            if is_whole(&node, clip) {
                refined.push(node);
                return;
            }
        }
        let threshold = self.of(depth, side);
        for &node in &side.nodes {
            if node.is_leaf() || node.bounds().half_area() <= threshold {
                refined.push(node);
            } else {
                open(tree, &node, clip, |child| {
                    tree.prefetch(&child);
                    refined.push(child);
                });
            }
        }
    }
}
