//! What the paper says of its eight methods (5.1, 5.2), as comparisons of two at a time.

use super::experiment::{Among, Comparison, Expectation};
use super::kinds::{LARGE, SCANS};
use crate::report::figures::Figure;

/// What a ratio that is above 1 may be.
const ABOVE_ONE: (f64, f64) = (1.0, f64::INFINITY);
/// What a ratio that is below 1 may be.
const BELOW_ONE: (f64, f64) = (0.0, 1.0);
/// "About 20 % less".
const A_FIFTH_LESS: (f64, f64) = (0.7, 0.9);
/// "Comparable".
const ALIKE: (f64, f64) = (0.8, 1.25);

/// The methods, in the order of Table 1.
pub fn names() -> Vec<String> {
    ["embree-morton", "hunt-50", "aac", "embree-sah", "hunt-500", "embree-fast-spatial", "phr-fast", "phr-hq"]
        .map(String::from)
        .into()
}

/// What 5.1 says of build times.
pub fn builds() -> Vec<Comparison> {
    let build = |says, range| expected(says, Figure::Build, range);
    let slower = || vec![build("it builds more slowly", ABOVE_ONE)];
    let faster = || build("it builds faster", BELOW_ONE);
    let against_hunt = || {
        vec![
            faster(),
            Expectation { among: LARGE, ..build("in about 20 % less time in large scenes", A_FIFTH_LESS) },
            Expectation { among: SCANS, ..build("in about the same time in scans (0.8 to 1.25)", ALIKE) },
            expected("its trees trace no slower", Figure::Trace, BELOW_ONE),
            expected("its trees have no higher SAH cost", Figure::Cost, BELOW_ONE),
        ]
    };
    vec![
        pair("hunt-50", "embree-morton", slower()),
        pair("aac", "hunt-50", slower()),
        pair("embree-sah", "aac", slower()),
        pair("hunt-500", "embree-sah", slower()),
        pair("embree-fast-spatial", "hunt-500", slower()),
        pair("phr-fast", "embree-morton", slower()),
        pair("phr-fast", "hunt-50", against_hunt()),
        pair("phr-fast", "aac", vec![faster()]),
        pair("phr-hq", "embree-sah", slower()),
        pair("phr-hq", "hunt-500", against_hunt()),
        pair("phr-hq", "embree-fast-spatial", vec![build("it builds in about half the time", (0.4, 0.6))]),
    ]
}

/// What 5.2 says of trace times.
pub fn traces() -> Vec<Comparison> {
    let trace = |says, range| expected(says, Figure::Trace, range);
    let slower = || trace("it traces more slowly", ABOVE_ONE);
    vec![
        pair("embree-sah", "embree-fast-spatial", vec![slower()]),
        pair("hunt-500", "embree-fast-spatial", vec![slower()]),
        pair(
            "phr-hq",
            "embree-fast-spatial",
            vec![
                slower(),
                trace("it takes at most 20 % longer", (0.0, 1.2)),
                Expectation {
                    among: Among::Paper(&["Hairball", "Soda Hall"]),
                    ..trace("it traces faster in Hairball and Soda Hall", BELOW_ONE)
                },
            ],
        ),
        pair("phr-hq", "embree-sah", vec![trace("it traces faster", BELOW_ONE)]),
        pair("phr-fast", "embree-sah", vec![slower()]),
        pair("phr-fast", "embree-morton", vec![trace("it traces faster", BELOW_ONE)]),
    ]
}

fn pair(changed: &str, base: &str, expected: Vec<Expectation>) -> Comparison {
    Comparison { changed: changed.into(), base: base.into(), expected }
}

fn expected(says: &'static str, figure: Figure, range: (f64, f64)) -> Expectation {
    Expectation { says, figure, range, among: Among::All }
}
