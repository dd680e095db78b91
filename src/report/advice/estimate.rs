//! A tree's total time from few noisy visits. Its time per ray is helped by the inner nodes that its rays visit, which
//! are counted without noise: the measured time is drawn to what the nodes tell, the more the noisier it is.
//!
//! Of a tree let `y` be the mean logarithm of its times over `n` visits, `v` the variance of one visit, and
//! `x = NODES ln(nodes) + EIGHT` (8-wide; else without `EIGHT`). The scene's own level is `c`, the mean of `y - x` over
//! its trees with weights `1 / (v/n + SPREAD²)`. With `g = SPREAD² / (SPREAD² + v/n)` the estimate is
//!
//! `x + c + g (y - x - c)`, of variance `g v/n + (1 - g)² / Σ 1 / (v/n + SPREAD²)`,
//!
//! the best linear one if trees scatter about `x + c` by `SPREAD`. `v` is the tree's own variance averaged with that
//! of all trees of the scene, and this one with `NOISE`², which count as `VISITS` degrees of freedom each: a few visits
//! that happen to be alike make nothing sure. Build times stay as measured, and times per ray of trees whose nodes were
//! not counted; the variance behind their intervals is `v/n`, `v` averaged likewise, with `BUILD_NOISE` for builds.
//!
//! The constants come from the rows of `results/reference-epyc` alone, to which a test holds them, not from any advice.

use crate::bench::quick::line::{Estimate, TotalTime};
use crate::bench::statistics::student95;

/// How the time per ray grows with the nodes that a ray visits: the exponent.
const NODES: f64 = 0.67;
/// By how much, as a logarithm, an 8-wide tree takes longer for as many nodes.
const EIGHT: f64 = 0.14;
/// How far trees of a scene scatter about what nodes and width tell, as a logarithm: deviation in scenes left out.
const SPREAD: f64 = 0.067;
/// Deviation of the logarithm of a tree's time per ray between the rounds of a run.
const NOISE: f64 = 0.09;
/// The same of its build time.
const BUILD_NOISE: f64 = 0.14;
/// Degrees of freedom that [`NOISE`] has beside a scene's visits, and a scene's noise beside a tree's. Not from the
/// run, a choice: 2 and 8 change the advice for one pair each of the 209 of `results/advice`.
const VISITS: usize = 4;

/// What was found of a tree that was traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traced {
    /// Children per node.
    pub width: u32,
    /// Measured build time, ms: geometric mean, with Student's interval over the visits.
    pub build_ms: Estimate,
    /// Measured time per ray, ns, likewise.
    pub ns_per_ray: Estimate,
    /// Visits behind both.
    pub visits: usize,
    /// Inner nodes that a ray visits, where they were counted.
    pub nodes_per_ray: Option<f64>,
}

impl Traced {
    /// What nodes and width tell, `x`.
    fn told(&self) -> Option<f64> {
        let nodes = self.nodes_per_ray.filter(|&nodes| nodes > 0.0 && self.visits > 0)?;
        Some(NODES * nodes.ln() + if self.width == 8 { EIGHT } else { 0.0 })
    }

    fn degrees(&self) -> usize {
        self.visits.saturating_sub(1)
    }

    /// The sum of squared deviations of the visits' logarithms, from the interval of their mean.
    fn squares(&self, mean: Estimate) -> f64 {
        let half = (mean.high / mean.value).ln();
        let error = half / student95(self.degrees());
        if half.is_finite() { (self.visits * self.degrees()) as f64 * error.powi(2) } else { 0.0 }
    }
}

/// The total time of each of a scene's trees.
pub fn estimates(trees: &[Traced]) -> Vec<TotalTime> {
    let builds = errors(trees, |tree| tree.build_ms, BUILD_NOISE);
    let traces = errors(trees, |tree| tree.ns_per_ray, NOISE);
    let spread = SPREAD.powi(2);
    let weight = |tree: &Traced, error: f64| if tree.told().is_some() { 1.0 / (error + spread) } else { 0.0 };
    let excess = |tree: &Traced| tree.told().map_or(0.0, |told| tree.ns_per_ray.value.ln() - told);
    let (mut weights, mut weighted) = (0.0, 0.0);
    for (tree, &error) in trees.iter().zip(&traces) {
        weights += weight(tree, error);
        weighted += weight(tree, error) * excess(tree);
    }
    let level = weighted / weights;
    let ns_per_ray = |tree: &Traced, error: f64| {
        let Some(told) = tree.told() else { return around(tree, tree.ns_per_ray.value, error) };
        let kept = spread / (spread + error);
        let log: f64 = told + level + kept * (excess(tree) - level);
        around(tree, log.exp(), kept * error + (1.0 - kept).powi(2) / weights)
    };
    let line = |((tree, build), trace): ((&Traced, f64), f64)| TotalTime {
        build_ms: around(tree, tree.build_ms.value, build),
        ns_per_ray: ns_per_ray(tree, trace),
    };
    trees.iter().zip(builds).zip(traces).map(line).collect()
}

/// The variance of each tree's mean logarithm of a figure whose `noise` is known from before.
fn errors(trees: &[Traced], figure: fn(&Traced) -> Estimate, noise: f64) -> Vec<f64> {
    let squares = |tree: &Traced| tree.squares(figure(tree));
    let degrees = |tree: &Traced| tree.degrees() as f64;
    let noise = averaged(noise.powi(2), trees.iter().map(squares).sum(), trees.iter().map(degrees).sum());
    let error = |tree: &Traced| averaged(noise, squares(tree), degrees(tree)) / tree.visits.max(1) as f64;
    trees.iter().map(error).collect()
}

/// A figure of `tree` with its interval, of which the logarithm has this variance.
fn around(tree: &Traced, value: f64, variance: f64) -> Estimate {
    let half = student95(VISITS + tree.degrees()) * variance.sqrt();
    Estimate { value, low: value * (-half).exp(), high: value * half.exp() }
}

/// A variance from a sum of squares, and from one known before, which counts as [`VISITS`] degrees of freedom.
fn averaged(before: f64, squares: f64, degrees: f64) -> f64 {
    (VISITS as f64 * before + squares) / (VISITS as f64 + degrees)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::rounds::ByRound;
    use crate::bench::row::{self, Row};
    use crate::report::figures::{GRAFTED, PHR, SceneFigures, scenes, trees};
    use std::path::Path;

    /// A tree of so many visits whose logarithms deviate by `noise`.
    fn tree(ns: f64, visits: usize, noise: f64, nodes: f64) -> Traced {
        let half = student95(visits - 1) * noise / (visits as f64).sqrt();
        let at = |log: f64| ns * log.exp();
        let time = Estimate { value: ns, low: at(-half), high: at(half) };
        Traced { width: 4, build_ms: time, ns_per_ray: time, visits, nodes_per_ray: Some(nodes) }
    }

    /// The distance of the first estimate from the measured time, as a logarithm, beside a tree that is well known.
    fn moved(visits: usize, noise: f64) -> f64 {
        let [first, ..] = estimates(&[tree(150.0, visits, noise, 20.0), tree(100.0, 1000, noise, 20.0)])[..]
        else {
            panic!("two trees");
        };
        let first = first.ns_per_ray;
        assert!(first.low < first.value && first.value < first.high);
        (150.0 / first.value).ln()
    }

    #[test]
    fn without_noise_the_measured_time_stays() {
        assert!(moved(1000, 1e-3).abs() < 1e-3, "{}", moved(1000, 1e-3));
    }

    #[test]
    fn under_much_noise_the_nodes_tell() {
        let known = tree(100.0, 1000, 0.01, 20.0);
        let noisy = tree(300.0, 50, 10.0, 40.0);
        let found = estimates(&[noisy, known, known, known, known])[0].ns_per_ray;
        let told = 100.0 * 2f64.powf(NODES);
        assert!((found.value / told).ln().abs() < 0.01, "{found:?}");
        assert!(found.low < told && told < found.high, "{found:?}");
    }

    #[test]
    fn more_visits_are_nearer_to_the_measured_time() {
        let moved: Vec<f64> = [2, 4, 8, 16, 64].iter().map(|&visits| moved(visits, 0.1)).collect();
        assert!(moved.windows(2).all(|pair| pair[0] > pair[1]) && moved[4] > 0.0, "{moved:?}");
    }

    #[test]
    fn one_visit_has_an_interval_and_uncounted_trees_stay() {
        let unsure = Estimate { value: 120.0, low: 0.0, high: f64::INFINITY };
        let once = Traced { build_ms: unsure, ns_per_ray: unsure, visits: 1, ..tree(120.0, 2, 0.1, 20.0) };
        let uncounted = Traced { nodes_per_ray: None, ..tree(80.0, 3, 0.1, 20.0) };
        let found = estimates(&[once, tree(100.0, 9, 0.05, 20.0), uncounted]);
        let [TotalTime { build_ms, ns_per_ray }, _, stayed] = found[..] else { panic!("three trees") };
        assert!(ns_per_ray.value < 120.0 && ns_per_ray.low > 50.0 && ns_per_ray.high < 200.0, "{found:?}");
        assert!(build_ms.value == 120.0 && build_ms.low > 80.0 && build_ms.high < 180.0, "{found:?}");
        assert_eq!((stayed.build_ms.value, stayed.ns_per_ray.value), (80.0, 80.0));
        // Alone it is all that is known of the scene.
        assert!((estimates(&[once])[0].ns_per_ray.value - 120.0).abs() < 1e-9);
        assert_eq!(estimates(&[uncounted])[0].ns_per_ray.value, 80.0);
        assert_eq!(estimates(&[]), []);
    }

    #[test]
    fn visits_that_happen_to_be_alike_make_nothing_sure() {
        let alike = tree(100.0, 3, 1e-4, 20.0);
        let noisy = tree(100.0, 3, 0.3, 20.0);
        let among = |others: Traced| estimates(&[alike, others, others, others])[0];
        let width = |time: Estimate| time.high / time.low;
        assert!(width(alike.build_ms) < 1.01);
        for line in [among(alike), among(noisy)] {
            assert!(width(line.build_ms) > 1.1 && width(line.ns_per_ray) > 1.02, "{line:?}");
        }
        assert!(width(among(noisy).build_ms) > width(among(alike).build_ms));
    }

    /// What the reference run tells of a tree in a scene: the logarithm of its nodes, 1 if 8-wide, the logarithm of its
    /// time per ray, the variances of that and of the build time between rounds.
    fn of_row(traced: &Row, counted: &Row) -> Option<[f64; 5]> {
        let nodes = counted.node_visits_per_ray?;
        let ns = 1e6 * traced.trace_ms_median? / traced.rays? as f64;
        let variance = |rounds: &ByRound| {
            let logs: Vec<f64> = rounds.iter().map(|(_, ms)| ms.ln()).collect();
            let mean = logs.iter().sum::<f64>() / logs.len() as f64;
            logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / (logs.len() as f64 - 1.0)
        };
        let (trace, build) = (variance(&traced.by_round.trace), variance(&traced.by_round.build));
        let eight = f64::from(u8::from(traced.width == 8));
        Some([nodes.ln(), eight, ns.ln(), trace, build])
    }

    /// The weights of `x` by least squares over some scenes, all centred.
    fn fitted(scenes: &[&Vec<[f64; 5]>]) -> [f64; 2] {
        let sum = |a: usize, b: usize| -> f64 {
            scenes.iter().flat_map(|trees| trees.iter()).map(|tree| tree[a] * tree[b]).sum()
        };
        let determinant = sum(0, 0) * sum(1, 1) - sum(0, 1).powi(2);
        [
            (sum(0, 2) * sum(1, 1) - sum(1, 2) * sum(0, 1)) / determinant,
            (sum(1, 2) * sum(0, 0) - sum(0, 2) * sum(0, 1)) / determinant,
        ]
    }

    #[test]
    fn the_constants_are_those_of_the_run() {
        let rows = row::read(Path::new("results/reference-epyc")).unwrap();
        let of_scene = |name: &String| {
            let figures = SceneFigures::of(&rows, name);
            let of_tree =
                |tree| of_row(figures.trace(tree, GRAFTED).value()?, figures.trace(tree, PHR).value()?);
            let mut found: Vec<[f64; 5]> = trees(&rows).into_iter().filter_map(of_tree).collect();
            for i in 0..3 {
                let mean = found.iter().map(|tree| tree[i]).sum::<f64>() / found.len() as f64;
                found.iter_mut().for_each(|tree| tree[i] -= mean);
            }
            found
        };
        let scenes: Vec<Vec<[f64; 5]>> = scenes(&rows).iter().map(of_scene).collect();
        let [nodes, eight] = fitted(&scenes.iter().collect::<Vec<_>>());
        let (mut squares, mut noise, mut count, mut degrees) = (0.0, 0.0, 0.0, 0.0);
        for (out, trees) in scenes.iter().enumerate() {
            let others = scenes.iter().enumerate().filter(|(i, _)| *i != out).map(|(_, trees)| trees);
            let [nodes, eight] = fitted(&others.collect::<Vec<_>>());
            squares += trees.iter().map(|it| (it[2] - nodes * it[0] - eight * it[1]).powi(2)).sum::<f64>();
            noise += trees.iter().map(|tree| tree[3]).sum::<f64>();
            count += trees.len() as f64;
            degrees += trees.len() as f64 - 1.0;
        }
        // What scatters but for the error of the mean of three rounds.
        let spread = (squares / degrees - noise / count / 3.0).sqrt();
        let noise = (noise / count).sqrt();
        let builds = (scenes.iter().flatten().map(|tree| tree[4]).sum::<f64>() / count).sqrt();
        for (constant, found, within) in [
            (NODES, nodes, 0.05),
            (EIGHT, eight, 0.03),
            (SPREAD, spread, 0.01),
            (NOISE, noise, 0.02),
            (BUILD_NOISE, builds, 0.02),
        ] {
            assert!((constant - found).abs() < within, "{constant} is {found} by the run");
        }
    }
}
