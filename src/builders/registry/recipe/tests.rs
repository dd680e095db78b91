//! Changed builders: what their names, fields and refusals are.

use super::*;
use crate::builders::testing::soup;
use crate::builders::{NAMES, by_name, on_request};

fn error(name: &str) -> String {
    let text = Recipe::parse(name).unwrap_err().to_string();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

#[test]
fn names_are_read_as_they_are_written() {
    for name in [
        "phr-hq",
        "phr-hq[delta=8]",
        "phr-speed[presplit=none+max_cut=4096]",
        "phr-fast[presplit.filled=0.2+clusters=on+spatial_threshold=1e-5]",
        "phr-fast[spatial_threshold=off+triangle_counts=on+delta=4]",
        "phr-hq-aux-sah[spatial_threshold=none]",
        "hunt-50[cut_length=70]",
        "aac[epsilon=0.1]",
        "phr-best[optimise.rounds=2+phr.delta=5]",
        "phr-hq-cut[max_cut=512]",
    ] {
        assert_eq!(Recipe::parse(name).unwrap().name(), name);
        assert_eq!(by_name::<8>(name).unwrap().name(), name);
    }
    let name = |text: &str| Recipe::parse(text).unwrap().name();
    assert_eq!(name("phr-hq[delta=8.0+delta=7]"), "phr-hq[delta=7]");
    assert_eq!(name("phr-hq[filled=0.2]"), "phr-hq[presplit.filled=0.2]", "the end of a name is enough");
    assert_eq!(name("phr-hq[filled=0.2+presplit=off]"), "phr-hq[presplit=off]");
    assert_eq!(name("phr-best[delta=5]"), "phr-best[phr.delta=5]");
    assert_eq!(
        name("phr-hq[spatial_threshold=off+spatial_threshold=off+delta=4]"),
        "phr-hq[spatial_threshold=off+delta=4]"
    );
    assert_eq!(name("hunt-50[cut_length=1000]"), "hunt-50[cut_length=1e3]");
}

#[test]
fn the_configuration_has_the_change_and_nothing_else() {
    let config = |name: &str| by_name::<4>(name).unwrap().config();
    let (mut expected, found) =
        (config("phr-hq"), config("phr-hq[delta=8+presplit.filled=0.25+clip_triangles=on]"));
    expected["delta"] = 8.0.into();
    expected["clip_triangles"] = true.into();
    expected["presplit"] = config("phr-quality")["presplit"].clone();
    expected["presplit"]["filled"] = 0.25.into();
    assert_eq!(found, expected);
    assert_eq!(config("phr-speed[presplit=none]")["presplit"], Value::Null);
    assert_eq!(config("phr-speed[cut_share=off]")["cut_share"], Value::Null);
    let back = config("phr-hq[spatial_threshold=off+delta=8+spatial_threshold=0.5]");
    assert_eq!(back, config("phr-hq[delta=8+spatial_threshold=0.5]"));
    let changes = Recipe::parse("phr-speed[presplit=none+max_cut=64]").unwrap().changes();
    assert_eq!(Value::Object(changes), serde_json::json!({"presplit": null, "max_cut": 64}));
}

#[test]
fn objects_set_what_is_within() {
    let mut recipe = Recipe::of("phr-hq").unwrap();
    recipe.set("clusters", &serde_json::json!({"most": 16, "area": 0.25})).unwrap();
    assert_eq!(recipe.name(), "phr-hq[clusters.area=0.25+clusters.most=16]");
    recipe.set("clusters", &serde_json::json!({"area": 0.5, "most": 0})).unwrap_err();
    assert_eq!(recipe.name(), "phr-hq[clusters.area=0.25+clusters.most=16]", "all of them, or none");
}

#[test]
fn what_cannot_be_set_is_refused_with_the_fields_that_can() {
    let listed = |text: &str| {
        ["delta, ", "presplit, ", "presplit.filled", "own_threshold.area"]
            .iter()
            .all(|name| text.contains(name))
    };
    let unknown = error("phr-hq[gamma=1]");
    assert!(unknown.contains("phr-hq has no single field gamma") && listed(&unknown), "{unknown}");
    for (name, reason) in [
        ("phr-hq[delta=x]", "phr-hq.delta=x: invalid type: string"),
        ("phr-hq[delta=99]", "phr-hq.delta=99: delta = 99.0 is out of range; give 0.0 to 64.0"),
        ("phr-hq[max_leaf=8.5]", "expected u32"),
        ("phr-hq[max_cut=-1]", "expected usize"),
        ("phr-hq[delta=none]", "phr-hq.delta=none: invalid type: null"),
        ("phr-hq[presplit=3]", "phr-hq.presplit=3: invalid type"),
        ("phr-hq[delta=8,alpha=0.4]", "give a number, on or off, and + between two changes"),
        ("phr-speed[local_threshold.area=-1]", "local_threshold.area = -1.0 is out of range"),
    ] {
        let text = error(name);
        assert!(text.contains(reason) && !listed(&text), "{name}: {text}");
    }
    // By its name in Rust, too.
    assert_eq!(
        Recipe::parse("phr-speed[local_threshold=off]").unwrap().name(),
        "phr-speed[own_threshold=off]"
    );
    assert!(error("phr-best[max_leaf=8]").contains("phr.max_leaf, "), "several fields end so");
    assert_eq!(error("lbvh[delta=8]"), "lbvh has no single field delta; lbvh has none");
    assert!(error("phr[delta=8]").contains("no builder of ours is called phr; there are lbvh, "));
    for name in ["phr-hq[\n]", "phr-hq[\n=8]", "\n[delta=8]"] {
        assert_eq!(error(name).lines().count(), 1, "{name:?}");
    }
    for name in ["phr-hq[delta=8", "phr-hq[]", "phr-hq[delta]"] {
        assert!(error(name).contains("write BUILDER.FIELD=VALUE"), "{name}");
    }
    assert!(by_name::<4>("phr-hq[delta=99]").is_none());
}

#[test]
fn every_field_of_every_builder_can_be_set_to_what_it_is() {
    for base in NAMES.iter().copied().chain(on_request()) {
        let plain = Recipe::of(base).unwrap();
        let template = fields::with_everything_on(&plain.config);
        for field in
            fields::paths(&template).into_iter().filter(|path| !fields::at(&template, path).is_object())
        {
            let mut changed = plain.clone();
            let set = changed.set(&field, fields::at(&template, &field));
            // `phr-best` collapses its tree once, after optimization.
            if field.starts_with("phr.collapse") {
                assert!(set.unwrap_err().to_string().contains("give none"), "{base}, {field}");
                continue;
            }
            set.unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(Recipe::parse(&changed.name()).unwrap().name(), changed.name());
            let of = |recipe: &Recipe| recipe.builder::<4>().config();
            assert_eq!(of(&Recipe::parse(&changed.name()).unwrap()), of(&changed));
        }
    }
}

#[test]
fn a_changed_builder_builds() {
    let mesh = soup(500, 0.2, 1);
    for name in ["phr-hq[max_cut=7+presplit=on]", "phr-best[rounds=1]", "hunt-50[cut_length=9]"] {
        let tree = by_name::<4>(name).unwrap().build(&mesh).tree;
        assert_eq!(tree.validate(&mesh), Ok(()), "{name}");
    }
}

#[test]
fn a_refused_value_is_told_in_one_line() {
    for name in ["phr-fast[max_leaf=l_l\u{1}\n0]", "phr-fast[alpha=\n]", "phr-fast[delta=1\n=2]"] {
        let error = Recipe::parse(name).unwrap_err().to_string();
        assert_eq!(error.lines().count(), 1, "{error:?}");
    }
}
