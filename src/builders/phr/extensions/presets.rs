//! Configurations that go beyond the paper.

use crate::builders::lbvh::config::{AuxiliaryConfig, Clusters};
use crate::builders::phr::config::{Extensions, LocalThreshold, PhrConfig};
use crate::builders::prims::presplit::PresplitConfig;
use crate::builders::wide::optimal::CollapseCosts;

impl PhrConfig {
    /// For the shortest build whose trees trace as Embree SAH's: PHR-Fast with shorter cuts that shrink more
    /// slowly, over an auxiliary BVH whose leaves are blocks. The initial cut has 2048 nodes in any scene, and
    /// large parts are opened by their own area; spatial splits are tried only in the largest parts.
    pub const TURBO: Self = Self {
        alpha: 0.45,
        delta: 5.0,
        spatial_threshold: 3e-2,
        extensions: Extensions {
            auxiliary: AuxiliaryConfig {
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

    /// For speed: PHR-Fast from an initial cut of 2048 nodes in any scene, over an auxiliary BVH whose leaves are
    /// blocks or small clusters. Subtrees near the leaves are swept in one go, parts that fit a cache are collapsed
    /// to the cheapest wide tree, and spatial splits are tried only in large parts. Needles are presplit, which
    /// saves scenes of rods and pipes.
    pub const SPEED: Self = Self {
        spatial_threshold: 1e-2,
        extensions: Extensions {
            auxiliary: AuxiliaryConfig {
                presplit: Some(PresplitConfig::NEEDLES),
                auxiliary_leaf: Some(4),
                clusters: Some(Clusters { most: 32, area: 1e-3 }),
                calibration: Some(1e3),
                ..AuxiliaryConfig::PAPER
            },
            // With `max_cut` 2048: always 2048 nodes.
            cut_share: Some(1.0 / 256.0),
            local_threshold: Some(LocalThreshold { references: 1 << 15, area: 1.0 / 256.0 }),
            spatial_bias: Some(1.07),
            subtree_sweep: Some(32),
            collapse: Some(CollapseCosts::EMBREE),
            ..Extensions::NONE
        },
        ..Self::FAST
    };

    /// For quality: larger initial cuts, spatial splits tried in smaller parts, only the smallest clusters kept
    /// together in the auxiliary BVH, which else has single triangles, all of which spatial splits clip, and larger
    /// subtrees swept in one go. Equation 2 has little effect then: large parts are opened by their own area.
    pub const QUALITY: Self = Self {
        delta: 5.0,
        max_cut: 1 << 14,
        spatial_threshold: 3e-4,
        extensions: Extensions {
            auxiliary: AuxiliaryConfig {
                auxiliary_leaf: None,
                clusters: Some(Clusters { most: 32, area: 1e-4 }),
                ..Self::SPEED.extensions.auxiliary
            },
            cut_share: Some(1.0 / 32.0),
            local_threshold: Some(LocalThreshold { references: 1 << 16, area: 1.0 / 256.0 }),
            spatial_bias: Some(1.08),
            clip_triangles: true,
            subtree_sweep: Some(64),
            ..Self::SPEED.extensions
        },
        ..Self::SPEED
    };
}
