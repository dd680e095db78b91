//! Configurations that go beyond the paper.

use crate::builders::lbvh::config::{AuxiliaryConfig, Clusters};
use crate::builders::phr::config::{Extensions, LocalThreshold, PhrConfig};
use crate::builders::prims::presplit::PresplitConfig;
use crate::builders::wide::optimal::CollapseCosts;

impl PhrConfig {
    /// For speed: PHR-Fast with shorter cuts that shrink more slowly, over an auxiliary BVH whose leaves are blocks.
    /// The initial cut has 2048 nodes in any scene, and large parts are opened by their own area; spatial splits are
    /// tried only in the largest parts. Needles are presplit, which saves scenes of rods and pipes.
    pub const SPEED: Self = Self {
        alpha: 0.45,
        delta: 5.0,
        spatial_threshold: 3e-2,
        extensions: Extensions {
            auxiliary: AuxiliaryConfig {
                presplit: Some(PresplitConfig::NEEDLES),
                auxiliary_leaf: Some(4),
                calibration: Some(1e3),
                ..AuxiliaryConfig::PAPER
            },
            // With `max_cut` 2048: always 2048 nodes.
            cut_share: Some(1.0 / 256.0),
            local_threshold: Some(LocalThreshold { references: 1 << 15, area: 1.0 / 256.0 }),
            ..Extensions::NONE
        },
        ..Self::FAST
    };

    /// For quality: PHR-Fast with the same initial cut over an auxiliary BVH of single triangles, which spatial splits
    /// clip, and of small clusters. Subtrees near the leaves are swept in one go, and parts that fit a cache are
    /// collapsed to the cheapest wide tree.
    pub const QUALITY: Self = Self {
        extensions: Extensions {
            auxiliary: AuxiliaryConfig {
                auxiliary_leaf: None,
                clusters: Some(Clusters { most: 32, area: 1e-4 }),
                ..Self::SPEED.extensions.auxiliary
            },
            clip_triangles: true,
            subtree_sweep: Some(32),
            collapse: Some(CollapseCosts::EMBREE),
            ..Self::SPEED.extensions
        },
        ..Self::FAST
    };
}
