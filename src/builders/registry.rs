//! The builders by name: those of the paper, ours, and ours with one step less or more.

use crate::builders::{
    Aac, AacConfig, Best, BestConfig, Builder, Clusters, Costs, Hunt, HuntConfig, Lbvh, OptimiseConfig,
    OwnThreshold, Phr, PhrConfig, PresplitConfig,
};

/// Names of the builders of a table, in its order.
pub const NAMES: &[&str] =
    &["lbvh", "hunt-50", "hunt-500", "aac", "phr-fast", "phr-hq", "phr-speed", "phr-quality", "phr-best"];

/// Names of the builders that show what single steps gain and cost: PHR-Fast and PHR-HQ with one extension each.
/// They are run where they are asked for.
pub const ABLATION: &[&str] = &[
    "phr-fast-coarse",
    "phr-fast-clusters",
    "phr-fast-subtrees",
    "phr-hq-coarse",
    "phr-hq-cut",
    "phr-hq-own",
    "phr-hq-bias",
    "phr-hq-overlap",
    "phr-hq-subtrees",
    "phr-hq-clip",
    "phr-hq-presplit",
    "phr-hq-sweep",
    "phr-hq-leaf-28",
    "phr-hq-calibration",
    "phr-hq-collapse",
    "phr-hq-optimised",
];

impl PhrConfig {
    /// For speed: PHR-Fast from an initial cut of 2048 nodes in any scene, over an auxiliary BVH whose leaves are
    /// quartets or small clusters; subtrees near the leaves are swept in one go, parts that fit a cache made wide as is
    /// cheapest, spatial splits tried only of what is large and overlaps. Needles are presplit and triangles clipped,
    /// which costs little and saves scenes of rods and pipes.
    pub const SPEED: Self = Self {
        cut_share: 1.0 / 256.0,
        own_threshold: Some(OwnThreshold { references: 1 << 15, area: 1.0 / 256.0 }),
        spatial_threshold: 1e-2,
        spatial_bias: 1.07,
        overlap_threshold: 1e-3,
        auxiliary_leaf: 4,
        clusters: Some(Clusters { most: 32, area: 1e-3 }),
        subtree_sweep: 32,
        presplit: Some(PresplitConfig::NEEDLES),
        clip_triangles: true,
        calibration: Some(1e3),
        collapse: Some(Costs::EMBREE),
        ..Self::FAST
    };

    /// For quality: larger initial cuts, spatial splits tried of smaller parts, only the smallest clusters left together
    /// in the auxiliary BVH, single triangles else, all of which spatial splits can clip, and larger subtrees swept in
    /// one go. Equation 2 has little to do then: large parts are opened by their own area.
    pub const QUALITY: Self = Self {
        delta: 5.0,
        max_cut: 1 << 14,
        cut_share: 1.0 / 32.0,
        own_threshold: Some(OwnThreshold { references: 1 << 16, area: 1.0 / 256.0 }),
        spatial_threshold: 3e-4,
        spatial_bias: 1.08,
        overlap_threshold: 3e-5,
        auxiliary_leaf: 1,
        clusters: Some(Clusters { most: 32, area: 1e-4 }),
        leaf_sweep: 16,
        subtree_sweep: 64,
        ..Self::SPEED
    };
}

impl BestConfig {
    /// The tree of [`PhrConfig::QUALITY`] from larger cuts of single triangles, optimised.
    pub const DEFAULT: Self = Self {
        phr: PhrConfig {
            alpha: 0.55,
            delta: 8.0,
            max_cut: 1 << 16,
            own_threshold: Some(OwnThreshold { references: 1 << 14, area: 1.0 / 1024.0 }),
            clusters: None,
            // The whole tree is collapsed when it has been optimised.
            collapse: None,
            ..PhrConfig::QUALITY
        },
        optimise: OptimiseConfig::DEFAULT,
    };
}

/// The builder called `name`, or `None`; names are those of [`NAMES`] and [`ABLATION`].
pub fn by_name(name: &str) -> Option<Box<dyn Builder>> {
    let name = NAMES.iter().chain(ABLATION).copied().find(|known| *known == name)?;
    let hunt = |cut_length| Box::new(Hunt::new(name, HuntConfig { cut_length, max_leaf: 8 }));
    let phr = |config| Box::new(Phr::new(name, config));
    let hq = PhrConfig::HQ;
    Some(match name {
        "lbvh" => Box::new(Lbvh::default()),
        "hunt-50" => hunt(50),
        "hunt-500" => hunt(500),
        "aac" => Box::new(Aac::new(AacConfig::FAST)),
        "phr-fast" => phr(PhrConfig::FAST),
        "phr-hq" => phr(hq),
        "phr-speed" => phr(PhrConfig::SPEED),
        "phr-quality" => phr(PhrConfig::QUALITY),
        "phr-best" => Box::new(Best::new(name, BestConfig::DEFAULT)),
        "phr-fast-coarse" => phr(PhrConfig { auxiliary_leaf: 4, ..PhrConfig::FAST }),
        "phr-fast-clusters" => phr(PhrConfig { clusters: PhrConfig::SPEED.clusters, ..PhrConfig::FAST }),
        "phr-fast-subtrees" => phr(PhrConfig { subtree_sweep: 32, ..PhrConfig::FAST }),
        "phr-hq-cut" => {
            let PhrConfig { max_cut, cut_share, .. } = PhrConfig::QUALITY;
            phr(PhrConfig { max_cut, cut_share, ..hq })
        }
        "phr-hq-own" => phr(PhrConfig { own_threshold: PhrConfig::QUALITY.own_threshold, ..hq }),
        "phr-hq-bias" => phr(PhrConfig { spatial_bias: PhrConfig::QUALITY.spatial_bias, ..hq }),
        "phr-hq-overlap" => phr(PhrConfig { overlap_threshold: 1e-4, ..hq }),
        "phr-hq-subtrees" => phr(PhrConfig { subtree_sweep: 64, ..hq }),
        "phr-hq-coarse" => phr(PhrConfig { auxiliary_leaf: 4, ..hq }),
        "phr-hq-clip" => phr(PhrConfig { clip_triangles: true, ..hq }),
        "phr-hq-presplit" => phr(PhrConfig { presplit: Some(PresplitConfig::NEEDLES), ..hq }),
        "phr-hq-sweep" => phr(PhrConfig { leaf_sweep: 16, ..hq }),
        "phr-hq-leaf-28" => phr(PhrConfig { max_leaf: 28, ..hq }),
        "phr-hq-calibration" => phr(PhrConfig { calibration: PhrConfig::QUALITY.calibration, ..hq }),
        "phr-hq-collapse" => phr(PhrConfig { collapse: Some(Costs::EMBREE), ..hq }),
        "phr-hq-optimised" => {
            Box::new(Best::new(name, BestConfig { phr: hq, optimise: OptimiseConfig::DEFAULT }))
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_that_of_its_builder() {
        for name in NAMES.iter().chain(ABLATION) {
            assert_eq!(by_name(name).map(|builder| builder.name()), Some(*name));
        }
        assert!(by_name("phr").is_none());
    }
}
