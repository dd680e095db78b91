//! SAH costs on real scenes stay where they were first measured: a builder that loses quality fails here.
//! Runs where the folder of scenes is (`PHR_SCENES`, or `../shared/scenes`); else it has nothing to do and
//! says so.

#![cfg(feature = "files")]

use crate::thorough;
use phr::builders;
use phr::bvh::sah_cost;
use std::path::PathBuf;

/// SAH costs of an independent scalar program: scene, PHR-Fast, PHR-HQ.
const EXPECTED: [(&str, f64, f64); 13] = [
    ("karhumaki_bridge", 18.64, 15.77),
    ("house_bitterli", 16.26, 15.33),
    ("kitchen_bitterli", 13.69, 12.80),
    ("clinic", 40.29, 37.72),
    ("car_bitterli", 30.22, 29.01),
    ("bodo_mep", 16.62, 15.48),
    ("bodo_arch", 36.68, 34.46),
    ("igea", 20.44, 19.47),
    ("duplex", 28.30, 28.12),
    ("campus_vianen", 5.30, 4.47),
    ("dream_apartment", 11.56, 11.75),
    ("brain_icbm152", 38.89, 38.46),
    ("bunny_144k", 18.69, 17.91),
];

#[test]
fn costs_are_at_most_5_percent_above_those_expected_and_no_triangle_is_lost() {
    let folder = std::env::var_os("PHR_SCENES")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"), PathBuf::from);
    let (mut found, mut too_high) = (0, Vec::new());
    for (name, fast, hq) in EXPECTED {
        let path = folder.join(format!("{name}.ply.zst"));
        if !path.exists() {
            println!("skipped: no {}", path.display());
            continue;
        }
        // Without time for more, the smallest.
        if !thorough() && path.metadata().unwrap().len() > 2_000_000 {
            println!("skipped without PHR_THOROUGH: {}", path.display());
            continue;
        }
        found += 1;
        let scene = phr::scene::load(&path).unwrap();
        for (builder, expected) in [("phr-fast", fast), ("phr-hq", hq)] {
            let tree = builders::by_name::<4>(builder).unwrap().build(&scene.mesh).tree;
            tree.validate(&scene.mesh).unwrap_or_else(|invalid| panic!("{builder} on {name}: {invalid}"));
            let cost = sah_cost(&tree);
            println!("{name} {builder}: {cost:.2}, expected {expected}");
            if cost > 1.05 * expected {
                too_high.push(format!("{builder} on {name}: {cost:.2} instead of {expected}"));
            }
        }
    }
    assert!(
        found > 0 || std::env::var_os("PHR_SCENES").is_none(),
        "PHR_SCENES: no scene in {}",
        folder.display()
    );
    assert!(too_high.is_empty(), "{too_high:#?}");
}
