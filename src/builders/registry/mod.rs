//! The builders by name: those of the paper, PLOC, ours, the paper's with one extension each, and ours without one
//! each.

pub mod by_name;
mod make;
#[cfg(feature = "serde")]
pub mod recipe;

use crate::builders::clusters::aac::config::AacConfig;
use crate::builders::clusters::ploc::config::PlocConfig;
use crate::builders::hunt::pipeline::HuntConfig;
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::optimise::config::OptimiseConfig;
use crate::builders::optimise::optimised_phr::OptimisedPhrConfig;
use crate::builders::phr::config::{Extensions, PhrConfig};
use crate::builders::phr::extensions::auxiliary_tree::AuxiliaryTree;
use crate::builders::phr::extensions::binned::config::BinnedSahConfig;
use crate::builders::phr::extensions::clustered::ClusteredPhrConfig;
use crate::builders::prims::presplit::PresplitConfig;
use crate::builders::wide::optimal::CollapseCosts;

/// The configuration of a builder; as JSON its fields alone.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(untagged))]
pub(crate) enum Config {
    Lbvh,
    Aac(AacConfig),
    Ploc(PlocConfig),
    Hunt(HuntConfig),
    Phr(PhrConfig),
    ClusteredPhr(ClusteredPhrConfig),
    OptimisedPhr(OptimisedPhrConfig),
}

const QUALITY: Extensions = PhrConfig::QUALITY.extensions;
const BEST: Extensions = OptimisedPhrConfig::DEFAULT.phr.extensions;
const NONE: Extensions = Extensions::NONE;

/// PHR-Fast with one extension.
const fn fast(extensions: Extensions) -> Config {
    Config::Phr(PhrConfig { extensions, ..PhrConfig::FAST })
}

/// PHR-HQ with one extension.
const fn hq(extensions: Extensions) -> Config {
    Config::Phr(PhrConfig { extensions, ..PhrConfig::HQ })
}

/// An extension of the auxiliary BVH.
const fn auxiliary(auxiliary: AuxiliaryConfig) -> Extensions {
    Extensions { auxiliary, ..NONE }
}

const PAPER: AuxiliaryConfig = AuxiliaryConfig::PAPER;
const COARSE: Extensions = auxiliary(AuxiliaryConfig { auxiliary_leaf: Some(4), ..PAPER });

/// Every builder by name. The first [`IN_TABLES`] are those of a table, in its order; the others show what single
/// extensions gain and cost, and are run on request.
const REGISTRY: &[(&str, Config)] = &[
    ("lbvh", Config::Lbvh),
    ("hunt-50", Config::Hunt(HuntConfig { cut_length: 50, max_leaf: 8 })),
    ("hunt-500", Config::Hunt(HuntConfig { cut_length: 500, max_leaf: 8 })),
    ("aac", Config::Aac(AacConfig::FAST)),
    ("ploc", Config::Ploc(PlocConfig::DEFAULT)),
    ("phr-fast", Config::Phr(PhrConfig::FAST)),
    ("phr-hq", Config::Phr(PhrConfig::HQ)),
    ("phr-draft", Config::ClusteredPhr(ClusteredPhrConfig::DRAFT)),
    ("phr-turbo", Config::ClusteredPhr(ClusteredPhrConfig::TURBO)),
    ("phr-speed", Config::Phr(PhrConfig::SPEED)),
    ("phr-quality", Config::Phr(PhrConfig::QUALITY)),
    ("phr-best", Config::OptimisedPhr(OptimisedPhrConfig::DEFAULT)),
    ("phr-fast-bucket", fast(auxiliary(AuxiliaryConfig { bucket_sort: true, ..PAPER }))),
    ("phr-fast-coarse", fast(COARSE)),
    ("phr-fast-clusters", fast(auxiliary(AuxiliaryConfig { clusters: QUALITY.auxiliary.clusters, ..PAPER }))),
    ("phr-fast-subtrees", fast(Extensions { subtree_sweep: QUALITY.subtree_sweep, ..NONE })),
    ("phr-hq-coarse", hq(COARSE)),
    (
        "phr-hq-cut",
        Config::Phr(PhrConfig {
            max_cut: 1 << 14,
            extensions: Extensions { cut_share: BEST.cut_share, ..NONE },
            ..PhrConfig::HQ
        }),
    ),
    ("phr-hq-own", hq(Extensions { local_threshold: QUALITY.local_threshold, ..NONE })),
    ("phr-hq-subtrees", hq(Extensions { subtree_sweep: QUALITY.subtree_sweep, ..NONE })),
    ("phr-hq-clip", hq(Extensions { clip_triangles: true, ..NONE })),
    ("phr-hq-presplit", hq(auxiliary(AuxiliaryConfig { presplit: Some(PresplitConfig::NEEDLES), ..PAPER }))),
    ("phr-hq-leaf-28", Config::Phr(PhrConfig { max_leaf: 28, ..PhrConfig::HQ })),
    (
        "phr-hq-calibration",
        hq(auxiliary(AuxiliaryConfig { calibration: QUALITY.auxiliary.calibration, ..PAPER })),
    ),
    ("phr-hq-collapse", hq(Extensions { collapse: Some(CollapseCosts::EMBREE), ..NONE })),
    (
        "phr-hq-optimised",
        Config::OptimisedPhr(OptimisedPhrConfig { phr: PhrConfig::HQ, optimise: OptimiseConfig::DEFAULT }),
    ),
];

/// Builders of a table.
const IN_TABLES: usize = 12;

const ALL: [&str; REGISTRY.len()] = {
    let mut names = [""; REGISTRY.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = REGISTRY[i].0;
        i += 1;
    }
    names
};

/// Names of the builders of a table, in its order.
pub const NAMES: &[&str] = ALL.split_at(IN_TABLES).0;

/// Names of the builders that show what single extensions gain and cost: PHR-Fast and PHR-HQ with one each. They
/// are run on request.
pub const ABLATION: &[&str] = ALL.split_at(IN_TABLES).1;

/// Names of PHR over other auxiliary trees (paper 5.5): `phr-hq-aux-ploc`, `-aux-aac`, `-aux-sah`. They are run on
/// request.
pub const OVER: &[&str] = &[
    "phr-fast-aux-ploc",
    "phr-fast-aux-aac",
    "phr-fast-aux-sah",
    "phr-hq-aux-ploc",
    "phr-hq-aux-aac",
    "phr-hq-aux-sah",
    "phr-speed-aux-ploc",
    "phr-speed-aux-aac",
    "phr-speed-aux-sah",
    "phr-quality-aux-ploc",
    "phr-quality-aux-aac",
    "phr-quality-aux-sah",
];

/// Names of the builders that are run on request alone: [`ABLATION`] and [`OVER`].
pub fn on_request() -> impl Iterator<Item = &'static str> {
    ABLATION.iter().chain(OVER).copied()
}

/// The configuration of the builder called `name`, one of [`NAMES`], [`ABLATION`] and [`OVER`].
pub(crate) fn config(name: &str) -> Option<(&'static str, Config)> {
    let whole = REGISTRY.iter().find(|(known, _)| *known == name).copied();
    whole.or_else(|| over(name))
}

/// PHR over another auxiliary tree.
fn over(name: &str) -> Option<(&'static str, Config)> {
    let name = *OVER.iter().find(|known| **known == name)?;
    let (preset, tree) = name.split_once("-aux-")?;
    let Config::Phr(mut preset) = config(preset)?.1 else { return None };
    preset.extensions.auxiliary_tree = match tree {
        "ploc" => AuxiliaryTree::Ploc(PlocConfig::DEFAULT),
        "aac" => AuxiliaryTree::Aac(AacConfig::FAST),
        _ => AuxiliaryTree::BinnedSah(BinnedSahConfig::DEFAULT),
    };
    Some((name, Config::Phr(preset)))
}

/// The configuration of a builder over cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutConfig {
    /// Of PHR.
    Phr(PhrConfig),
    /// Of Hunt's method.
    Hunt(HuntConfig),
}

/// The cuts of the builder called `name`, before its tree is optimised where it is; `None` of builders without cuts,
/// and of cuts over finished clusters.
pub fn cuts_of(name: &str) -> Option<CutConfig> {
    match config(name)?.1 {
        Config::Phr(config) => Some(CutConfig::Phr(config)),
        Config::OptimisedPhr(config) => Some(CutConfig::Phr(config.phr)),
        Config::Hunt(config) => Some(CutConfig::Hunt(config)),
        Config::Lbvh | Config::Aac(_) | Config::Ploc(_) | Config::ClusteredPhr(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::by_name;

    #[test]
    fn every_name_is_that_of_its_builder() {
        for name in NAMES.iter().copied().chain(on_request()) {
            assert_eq!(by_name::<4>(name).map(|builder| builder.name().to_owned()), Some(name.to_owned()));
        }
        for name in OVER {
            let preset = name.split_once("-aux-").unwrap().0;
            assert_ne!(cuts_of(name), cuts_of(preset), "{name}");
        }
        assert_eq!((NAMES.len(), ABLATION.len()), (12, 14));
        assert!(by_name::<4>("phr").is_none());
    }
}
