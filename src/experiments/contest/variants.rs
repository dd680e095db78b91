//! The builders that experiments compare: the paper's presets with one thing changed.

use crate::builders::{OVER, PhrConfig, Recipe};

/// The change that turns spatial splits off.
pub const SPATIAL_OFF: &str = "spatial_threshold=off";

/// The paper's presets, by name.
const PRESETS: [(&str, PhrConfig); 2] = [("phr-fast", PhrConfig::FAST), ("phr-hq", PhrConfig::HQ)];

/// Their names.
pub fn bases() -> Vec<String> {
    PRESETS.map(|(name, _)| name.to_owned()).into()
}

/// The name of `base` with `changes`, as "alpha=0.5+delta=7".
pub fn changed(base: &str, changes: &str) -> String {
    let recipe = Recipe::parse(&format!("{base}[{changes}]"));
    recipe.expect("experiments change fields within their ranges, as a test tells").name()
}

/// A builder beside the one that it is a variant of.
#[derive(Clone, Debug)]
pub struct OfBase {
    /// The name of that.
    pub base: String,
    /// Its own.
    pub changed: String,
}

/// Each preset with `changes`.
fn of_each(changes: &str) -> Vec<OfBase> {
    PRESETS.map(|(name, _)| OfBase { base: name.into(), changed: changed(name, changes) }).into()
}

/// Without spatial splits.
pub fn spatial_off() -> Vec<OfBase> {
    of_each(SPATIAL_OFF)
}

/// Sides weighed by triangles.
pub fn triangle_counts() -> Vec<OfBase> {
    of_each("triangle_counts=on")
}

/// The auxiliary tree sorted by 12 bits.
pub fn bucket_sort() -> Vec<OfBase> {
    of_each("bucket_sort=on")
}

/// Presplitting of needles with and without spatial splits: each beside the same builder without presplitting.
pub fn presplit() -> Vec<OfBase> {
    let with = of_each("presplit=on");
    let alone = PRESETS.map(|(name, _)| OfBase {
        base: changed(name, SPATIAL_OFF),
        changed: changed(name, &format!("{SPATIAL_OFF}+presplit=on")),
    });
    with.into_iter().chain(alone).collect()
}

/// Adaptive thresholds from coarse to fine, without spatial splits, with their labels; the paper's two presets
/// among them.
pub fn adaptive() -> Vec<(String, String)> {
    let points = [(0.5, 4.0), (0.5, 5.0), (0.5, 6.0), (0.5, 7.0), (0.55, 8.0), (0.55, 9.0)];
    let variant = |(alpha, delta): (f32, f32)| {
        let preset = PRESETS.iter().find(|(_, preset)| (preset.alpha, preset.delta) == (alpha, delta));
        let name = match preset {
            Some((name, _)) => changed(name, SPATIAL_OFF),
            None => changed("phr-hq", &format!("alpha={alpha}+delta={delta}+{SPATIAL_OFF}")),
        };
        (format!("{alpha}, {delta}"), name)
    };
    points.map(variant).into()
}

/// Hunt's method with cuts of a length, leaves as those of PHR.
pub fn hunt(cut_length: usize) -> String {
    match cut_length {
        50 | 500 => format!("hunt-{cut_length}"),
        _ => changed("hunt-50", &format!("cut_length={cut_length}")),
    }
}

/// Constant lengths, with their labels.
pub fn constant() -> Vec<(String, String)> {
    [25, 50, 100, 200, 500, 1000].map(|cut_length| (cut_length.to_string(), hunt(cut_length))).into()
}

/// The paper's presets over other auxiliary trees (`phr-hq-aux-TREE`), each beside the preset over an LBVH.
pub fn auxiliary_trees() -> Vec<OfBase> {
    let with_base = |name: &&str| {
        let (base, _) = name.split_once("-aux-")?;
        let is_preset = PRESETS.iter().any(|(preset, _)| *preset == base);
        is_preset.then(|| OfBase { base: base.into(), changed: (*name).into() })
    };
    OVER.iter().filter_map(with_base).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::{HuntConfig, PresplitConfig, by_name};
    use serde_json::{Value, to_value};

    fn config(name: &str) -> Value {
        by_name::<4>(name).unwrap().config()
    }

    #[test]
    fn one_thing_differs() {
        let hq = PhrConfig::HQ;
        let off = PhrConfig { spatial_threshold: f32::INFINITY, ..hq };
        assert_eq!(config("phr-hq[spatial_threshold=off]"), to_value(off).unwrap());
        assert_eq!(config("phr-hq[spatial_threshold=off]")["spatial_threshold"], Value::Null);
        assert_ne!(config("phr-hq[spatial_threshold=off]"), config("phr-hq"));
        let mut counts = hq;
        counts.extensions.triangle_counts = true;
        assert_eq!(config("phr-hq[triangle_counts=on]"), to_value(counts).unwrap());
        let mut presplit = off;
        presplit.extensions.auxiliary.presplit = Some(PresplitConfig::NEEDLES);
        assert_eq!(config("phr-hq[spatial_threshold=off+presplit=on]"), to_value(presplit).unwrap());
        assert_eq!(config("phr-fast[bucket_sort=on]"), config("phr-fast-bucket"));
        for (length, (label, name)) in [25, 50, 100, 200, 500, 1000].into_iter().zip(constant()) {
            let expected = HuntConfig { cut_length: length, max_leaf: PhrConfig::FAST.max_leaf };
            assert_eq!((label, config(&name)), (length.to_string(), to_value(expected).unwrap()));
        }
        let adaptive = adaptive();
        assert_eq!(adaptive[2].1, "phr-fast[spatial_threshold=off]");
        assert_eq!(adaptive[3].1, "phr-hq[alpha=0.5+delta=7+spatial_threshold=off]");
        assert_eq!(adaptive[5].1, "phr-hq[spatial_threshold=off]");
    }

    #[test]
    fn both_presets_stand_over_every_auxiliary_tree() {
        let names: Vec<String> = auxiliary_trees().into_iter().map(|it| it.changed).collect();
        let all = ["ploc", "aac", "sah"].map(|tree| format!("-aux-{tree}"));
        assert_eq!(
            names,
            [
                all.each_ref().map(|it| format!("phr-fast{it}")),
                all.each_ref().map(|it| format!("phr-hq{it}"))
            ]
            .concat()
        );
    }
}
