//! The builders by name: those of the paper, PLOC, ours, the paper's with one extension each, and ours without one
//! each.

pub mod by_name;
mod make;
#[cfg(feature = "serde")]
pub mod recipe;

use crate::builders::clusters::aac::AacConfig;
use crate::builders::clusters::ploc::PlocConfig;
use crate::builders::hunt::HuntConfig;
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::optimise::{OptimiseConfig, OptimisedPhrConfig};
use crate::builders::phr::{AuxiliaryTree, BinnedSahConfig, Extensions, LocalThreshold, PhrConfig};
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
    OptimisedPhr(OptimisedPhrConfig),
}

/// The tree of [`PhrConfig::QUALITY`] from larger cuts of single triangles, optimised as a whole.
const BEST: OptimisedPhrConfig = OptimisedPhrConfig {
    phr: PhrConfig {
        alpha: 0.55,
        delta: 8.0,
        max_cut: 1 << 16,
        extensions: Extensions {
            auxiliary: AuxiliaryConfig { clusters: None, ..QUALITY.auxiliary },
            local_threshold: Some(LocalThreshold { references: 1 << 14, area: 1.0 / 1024.0 }),
            collapse: None,
            ..QUALITY
        },
        ..PhrConfig::QUALITY
    },
    optimise: OptimiseConfig::DEFAULT,
};

#[cfg(test)]
const TURBO: Extensions = PhrConfig::TURBO.extensions;
const SPEED: Extensions = PhrConfig::SPEED.extensions;
const QUALITY: Extensions = PhrConfig::QUALITY.extensions;
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
    ("phr-turbo", Config::Phr(PhrConfig::TURBO)),
    ("phr-speed", Config::Phr(PhrConfig::SPEED)),
    ("phr-quality", Config::Phr(PhrConfig::QUALITY)),
    ("phr-best", Config::OptimisedPhr(BEST)),
    ("phr-fast-bucket", fast(auxiliary(AuxiliaryConfig { bucket_sort: true, ..PAPER }))),
    ("phr-fast-coarse", fast(COARSE)),
    ("phr-fast-clusters", fast(auxiliary(AuxiliaryConfig { clusters: SPEED.auxiliary.clusters, ..PAPER }))),
    ("phr-fast-subtrees", fast(Extensions { subtree_sweep: Some(32), ..NONE })),
    ("phr-hq-coarse", hq(COARSE)),
    (
        "phr-hq-cut",
        Config::Phr(PhrConfig {
            max_cut: PhrConfig::QUALITY.max_cut,
            extensions: Extensions { cut_share: QUALITY.cut_share, ..NONE },
            ..PhrConfig::HQ
        }),
    ),
    ("phr-hq-own", hq(Extensions { local_threshold: QUALITY.local_threshold, ..NONE })),
    ("phr-hq-bias", hq(Extensions { spatial_bias: QUALITY.spatial_bias, ..NONE })),
    ("phr-hq-subtrees", hq(Extensions { subtree_sweep: Some(64), ..NONE })),
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
const IN_TABLES: usize = 11;

const ALL: [&str; REGISTRY.len()] = names(REGISTRY);

/// Names of the builders of a table, in its order.
pub const NAMES: &[&str] = ALL.split_at(IN_TABLES).0;

/// Names of the builders that show what single extensions gain and cost: PHR-Fast and PHR-HQ with one each. They
/// are run on request.
pub const ABLATION: &[&str] = ALL.split_at(IN_TABLES).1;

/// A preset without one field of its extensions, or of those of its auxiliary BVH, each a builder
/// `PRESET-no-FIELD`.
macro_rules! without {
    ($preset:literal, $config:expr; $($extension:ident)*; $($of_auxiliary:ident)*) => {
        &[
            $((
                concat!($preset, "-no-", stringify!($extension)),
                Extensions { $extension: NONE.$extension, ..$config.extensions },
            ),)*
            $((
                concat!($preset, "-no-", stringify!($of_auxiliary)),
                Extensions {
                    auxiliary: AuxiliaryConfig { $of_auxiliary: PAPER.$of_auxiliary, ..$config.extensions.auxiliary },
                    ..$config.extensions
                },
            ),)*
        ]
    };
}

const TURBO_WITHOUT: &[(&str, Extensions)] = without!("phr-turbo", PhrConfig::TURBO;
    cut_share local_threshold; auxiliary_leaf calibration);
const SPEED_WITHOUT: &[(&str, Extensions)] = without!("phr-speed", PhrConfig::SPEED;
    cut_share local_threshold spatial_bias subtree_sweep collapse;
    auxiliary_leaf clusters calibration presplit);
const QUALITY_WITHOUT: &[(&str, Extensions)] = without!("phr-quality", PhrConfig::QUALITY;
    cut_share local_threshold spatial_bias clip_triangles subtree_sweep collapse;
    clusters calibration presplit);

/// A configuration over another auxiliary tree than an LBVH, each a builder `PRESET-aux-TREE`.
macro_rules! over {
    ($($name:literal, $config:expr;)*) => {
        &[
            $(
                (concat!($name, "-aux-ploc"), over($config, AuxiliaryTree::Ploc(PlocConfig::DEFAULT))),
                (concat!($name, "-aux-aac"), over($config, AuxiliaryTree::Aac(AacConfig::FAST))),
                (concat!($name, "-aux-sah"), over($config, AuxiliaryTree::BinnedSah(BinnedSahConfig::DEFAULT))),
            )*
        ]
    };
}

const fn over(config: PhrConfig, auxiliary_tree: AuxiliaryTree) -> PhrConfig {
    PhrConfig { extensions: Extensions { auxiliary_tree, ..config.extensions }, ..config }
}

const AUXILIARY_TREES: &[(&str, PhrConfig)] = over!(
    "phr-fast", PhrConfig::FAST;
    "phr-hq", PhrConfig::HQ;
    "phr-speed", PhrConfig::SPEED;
    "phr-quality", PhrConfig::QUALITY;
);

/// Names of PHR over other auxiliary trees (paper 5.5): `phr-hq-aux-ploc`, `-aux-aac`, `-aux-sah`. They are run on
/// request.
pub const OVER: &[&str] = &names::<_, 12>(AUXILIARY_TREES);

/// Names of our presets without one extension each: what the rest of the preset does not make up for. They are run on
/// request.
pub const WITHOUT: [&[&str]; 3] =
    [&names::<_, 4>(TURBO_WITHOUT), &names::<_, 9>(SPEED_WITHOUT), &names::<_, 9>(QUALITY_WITHOUT)];

/// Names of the builders that are run on request alone: [`ABLATION`], [`WITHOUT`] and [`OVER`].
pub fn on_request() -> impl Iterator<Item = &'static str> {
    ABLATION.iter().chain(WITHOUT.into_iter().flatten()).chain(OVER).copied()
}

const fn names<T: Copy, const N: usize>(of: &[(&'static str, T)]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = of[i].0;
        i += 1;
    }
    names
}

/// A configuration over another auxiliary tree.
fn over_tree(name: &str) -> Option<(&'static str, Config)> {
    let &(name, config) = AUXILIARY_TREES.iter().find(|(known, _)| *known == name)?;
    Some((name, Config::Phr(config)))
}

/// A preset without one extension.
fn without(name: &str) -> Option<(&'static str, Config)> {
    let presets = [
        (TURBO_WITHOUT, PhrConfig::TURBO),
        (SPEED_WITHOUT, PhrConfig::SPEED),
        (QUALITY_WITHOUT, PhrConfig::QUALITY),
    ];
    presets.iter().find_map(|&(without, preset)| {
        let &(name, extensions) = without.iter().find(|(known, _)| *known == name)?;
        Some((name, Config::Phr(PhrConfig { extensions, ..preset })))
    })
}

impl OptimisedPhrConfig {
    /// The configuration of `phr-best`.
    pub const DEFAULT: Self = BEST;
}

/// The configuration of the builder called `name`, one of [`NAMES`], [`ABLATION`], [`WITHOUT`] and [`OVER`].
pub(crate) fn config(name: &str) -> Option<(&'static str, Config)> {
    REGISTRY
        .iter()
        .find(|(known, _)| *known == name)
        .copied()
        .or_else(|| without(name))
        .or_else(|| over_tree(name))
}

/// The configuration of a builder over cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutConfig {
    /// Of PHR.
    Phr(PhrConfig),
    /// Of Hunt's method.
    Hunt(HuntConfig),
}

/// The cuts of the builder called `name`, before its tree is optimised where it is; `None` of builders without cuts.
pub fn cuts_of(name: &str) -> Option<CutConfig> {
    match config(name)?.1 {
        Config::Phr(config) => Some(CutConfig::Phr(config)),
        Config::OptimisedPhr(config) => Some(CutConfig::Phr(config.phr)),
        Config::Hunt(config) => Some(CutConfig::Hunt(config)),
        Config::Lbvh | Config::Aac(_) | Config::Ploc(_) => None,
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
        for (without, whole) in [(TURBO_WITHOUT, TURBO), (SPEED_WITHOUT, SPEED), (QUALITY_WITHOUT, QUALITY)] {
            assert!(without.iter().all(|(_, extensions)| *extensions != whole));
        }
        assert_eq!((NAMES.len(), ABLATION.len()), (11, 15));
        assert!(by_name::<4>("phr").is_none());
    }
}
