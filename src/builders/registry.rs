//! The builders by name: those of the paper, ours, the paper's with one extension each, and ours without one each.

use super::aac::{Aac, AacConfig};
use super::builder::Builder;
use super::config_error::ConfigError;
use super::hunt::{Hunt, HuntConfig};
use super::lbvh::auxiliary::AuxiliaryConfig;
use super::lbvh::direct::Lbvh;
use super::optimise::{OptimiseConfig, OptimisedPhr, OptimisedPhrConfig};
use super::phr::{Extensions, LocalThreshold, Phr, PhrConfig};
use super::prims::presplit::PresplitConfig;
use super::wide::optimal::CollapseCosts;

/// The configuration of a builder.
#[derive(Clone, Copy)]
enum Config {
    Lbvh,
    Aac(AacConfig),
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
const IN_TABLES: usize = 10;

const ALL: [&str; REGISTRY.len()] = names(REGISTRY);

/// Names of the builders of a table, in its order.
pub const NAMES: &[&str] = ALL.split_at(IN_TABLES).0;

/// Names of the builders that show what single extensions gain and cost: PHR-Fast and PHR-HQ with one each. They are run
/// on request.
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

/// Names of our presets without one extension each: what the rest of the preset does not make up for. They are run on
/// request.
pub const WITHOUT: [&[&str]; 3] =
    [&names::<_, 4>(TURBO_WITHOUT), &names::<_, 9>(SPEED_WITHOUT), &names::<_, 9>(QUALITY_WITHOUT)];

/// Names of the builders that are run on request alone: [`ABLATION`] and [`WITHOUT`].
pub fn on_request() -> impl Iterator<Item = &'static str> {
    ABLATION.iter().chain(WITHOUT.into_iter().flatten()).copied()
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

/// The builder of trees of nodes of up to `N` children, 4 or 8, called `name`, or `None`; names are those of [`NAMES`],
/// [`ABLATION`] and [`WITHOUT`].
pub fn by_name<const N: usize>(name: &str) -> Option<Box<dyn Builder<N>>> {
    let known = REGISTRY.iter().find(|(known, _)| *known == name).copied();
    let (name, config) = known.or_else(|| without(name))?;
    Some(build(name, config).expect("the registry's parameters are in range, as a test tells"))
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
    match REGISTRY.iter().find(|(known, _)| *known == name).copied().or_else(|| without(name))?.1 {
        Config::Phr(config) => Some(CutConfig::Phr(config)),
        Config::OptimisedPhr(config) => Some(CutConfig::Phr(config.phr)),
        Config::Hunt(config) => Some(CutConfig::Hunt(config)),
        Config::Lbvh | Config::Aac(_) => None,
    }
}

fn build<const N: usize>(name: &'static str, config: Config) -> Result<Box<dyn Builder<N>>, ConfigError> {
    Ok(match config {
        Config::Lbvh => Box::<Lbvh<N>>::default(),
        Config::Aac(config) => Box::new(Aac::new(config)?),
        Config::Hunt(config) => Box::new(Hunt::new(name, config)?),
        Config::Phr(config) => Box::new(Phr::new(name, config)?),
        Config::OptimisedPhr(config) => Box::new(OptimisedPhr::new(name, config)?),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_that_of_its_builder() {
        for name in NAMES.iter().chain(ABLATION).chain(WITHOUT.into_iter().flatten()) {
            assert_eq!(by_name::<4>(name).map(|builder| builder.name()), Some(*name));
        }
        for (without, whole) in [(TURBO_WITHOUT, TURBO), (SPEED_WITHOUT, SPEED), (QUALITY_WITHOUT, QUALITY)] {
            assert!(without.iter().all(|(_, extensions)| *extensions != whole));
        }
        assert_eq!((NAMES.len(), ABLATION.len()), (10, 15));
        assert!(by_name::<4>("phr").is_none());
    }
}
