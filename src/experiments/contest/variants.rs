//! The builders that experiments compare: the paper's presets with one thing changed.

use crate::bench::contender::{Configuration, Variant};
use crate::builders::{self, AuxiliaryConfig, Extensions, HuntConfig, NAMES, PhrConfig, PresplitConfig};

/// The field that turns spatial splits off, in names.
pub const SPATIAL_OFF: &str = "spatial_threshold=inf";

/// The paper's presets, by name.
const PRESETS: [(&str, PhrConfig); 2] = [("phr-fast", PhrConfig::FAST), ("phr-hq", PhrConfig::HQ)];

/// Their names.
pub fn bases() -> Vec<String> {
    PRESETS.map(|(name, _)| name.to_owned()).into()
}

/// A variant beside the builder that it is a variant of.
pub type OfBase = (String, Variant);

/// Each preset with other `fields`, which `change` sets.
fn of_each(fields: &str, change: impl Fn(PhrConfig) -> PhrConfig) -> Vec<OfBase> {
    let variant = |(name, config): (&str, PhrConfig)| {
        (name.to_owned(), Variant::new(name, fields, Configuration::Phr(change(config))))
    };
    PRESETS.map(variant).into()
}

fn without_spatial(config: PhrConfig) -> PhrConfig {
    PhrConfig { spatial_threshold: f32::INFINITY, ..config }
}

/// Without spatial splits.
pub fn spatial_off() -> Vec<OfBase> {
    of_each(SPATIAL_OFF, without_spatial)
}

/// Sides weighed by triangles.
pub fn triangle_counts() -> Vec<OfBase> {
    of_each("triangle_counts=true", |config| PhrConfig {
        extensions: Extensions { triangle_counts: true, ..config.extensions },
        ..config
    })
}

fn with_auxiliary(config: PhrConfig, auxiliary: AuxiliaryConfig) -> PhrConfig {
    PhrConfig { extensions: Extensions { auxiliary, ..config.extensions }, ..config }
}

/// The auxiliary tree sorted by 12 bits.
pub fn bucket_sort() -> Vec<OfBase> {
    let auxiliary = AuxiliaryConfig { bucket_sort: true, ..AuxiliaryConfig::PAPER };
    of_each("bucket_sort=true", |config| with_auxiliary(config, auxiliary))
}

/// Presplitting with and without spatial splits: each beside the same builder without presplitting.
pub fn presplit() -> Vec<OfBase> {
    let auxiliary = AuxiliaryConfig { presplit: Some(PresplitConfig::NEEDLES), ..AuxiliaryConfig::PAPER };
    let with = of_each("presplit=needles", |config| with_auxiliary(config, auxiliary));
    let both = format!("{SPATIAL_OFF},presplit=needles");
    let alone = of_each(&both, |config| with_auxiliary(without_spatial(config), auxiliary));
    let alone = alone.into_iter().map(|(base, variant)| (format!("{base}[{SPATIAL_OFF}]"), variant));
    with.into_iter().chain(alone).collect()
}

/// Adaptive thresholds from coarse to fine, without spatial splits, with their labels; the paper's two presets among them.
pub fn adaptive() -> Vec<(String, Variant)> {
    let points = [(0.5, 4.0), (0.5, 5.0), (0.5, 6.0), (0.5, 7.0), (0.55, 8.0), (0.55, 9.0)];
    let variant = |(alpha, delta): (f32, f32)| {
        let config = without_spatial(PhrConfig { alpha, delta, ..PhrConfig::FAST });
        let preset = PRESETS.iter().find(|(_, preset)| without_spatial(*preset) == config);
        let variant = match preset {
            Some((name, _)) => Variant::new(name, SPATIAL_OFF, Configuration::Phr(config)),
            None => {
                let fields = format!("alpha={alpha},delta={delta},{SPATIAL_OFF}");
                Variant::new("phr-hq", &fields, Configuration::Phr(config))
            }
        };
        (format!("{alpha}, {delta}"), variant)
    };
    points.map(variant).into()
}

/// Constant lengths, with their labels.
pub fn constant() -> Vec<(String, Variant)> {
    let variant = |cut_length: usize| {
        let config = HuntConfig { cut_length, max_leaf: PhrConfig::FAST.max_leaf };
        (
            cut_length.to_string(),
            Variant::new("hunt", &format!("cut_length={cut_length}"), Configuration::Hunt(config)),
        )
    };
    [25, 50, 100, 200, 500, 1000].map(variant).into()
}

/// Builders over other auxiliary trees (`phr-hq-aux-TREE`) with the builder over an LBVH, as far as the registry has any.
pub fn auxiliary_trees() -> Vec<(String, String)> {
    let names = NAMES.iter().copied().chain(builders::on_request());
    let with_base = |name: &str| {
        let (base, _) = name.split_once("-aux-")?;
        Some((name.to_owned(), base.to_owned()))
    };
    names.filter_map(with_base).collect()
}
