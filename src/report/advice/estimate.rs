//! A tree's time per ray from few noisy visits, helped by the inner nodes that its rays visit, which are counted
//! without noise: the measured time is drawn to what the nodes tell, the more the noisier it is.
//!
//! Of a tree let `y` be the mean logarithm of its times over `n` visits, `v` the variance of one visit, and
//! `x = NODES ln(nodes) + EIGHT` (8-wide; else without `EIGHT`). The scene's own level is `c`, the mean of `y - x` over
//! its trees with weights `1 / (v/n + SPREAD²)`. With `g = SPREAD² / (SPREAD² + v/n)` the estimate is
//!
//! `x + c + g (y - x - c)`, of variance `g v/n + (1 - g)² / Σ 1 / (v/n + SPREAD²)`,
//!
//! the best linear one if trees scatter about `x + c` by `SPREAD`. `v` is the tree's own variance averaged with that
//! of all trees of the scene, and this one with `NOISE`², which count as `VISITS` degrees of freedom each. Build
//! times stay as measured, and trees whose nodes were not counted.
//!
//! The constants come from the rows of `results/reference` alone, to which a test holds them, not from any advice.

use crate::bench::quick::line::Estimate;
use crate::bench::statistics::student95;

/// How the time per ray grows with the nodes that a ray visits: the exponent.
const NODES: f64 = 0.67;
/// By how much, as a logarithm, an 8-wide tree takes longer for as many nodes.
const EIGHT: f64 = 0.14;
/// How far trees of a scene scatter about what nodes and width tell, as a logarithm: deviation in scenes left out.
const SPREAD: f64 = 0.067;
/// Deviation of the logarithm of a tree's time per ray between the rounds of a run.
const NOISE: f64 = 0.09;
/// Degrees of freedom that [`NOISE`] has beside a scene's visits, and a scene's noise beside a tree's. Not from the
/// reference, a choice: 2 and 8 change the advice for one pair each of the 209 of `results/advice`.
const VISITS: usize = 4;

/// What was found of a tree that was traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traced {
    /// Children per node.
    pub width: u32,
    /// Measured time per ray: geometric mean, with Student's interval over the visits.
    pub ns_per_ray: Estimate,
    /// Visits behind it.
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

    /// The sum of squared deviations of the visits' logarithms, from the interval.
    fn squares(&self) -> f64 {
        let half = (self.ns_per_ray.high / self.ns_per_ray.value).ln();
        let error = half / student95(self.degrees());
        if half.is_finite() { (self.visits * self.degrees()) as f64 * error.powi(2) } else { 0.0 }
    }
}

/// The time per ray of each of a scene's trees.
pub fn estimates(trees: &[Traced]) -> Vec<Estimate> {
    let sum = |of: &dyn Fn(&Traced) -> f64| trees.iter().map(of).sum::<f64>();
    let noise = averaged(NOISE.powi(2), sum(&Traced::squares), sum(&|tree| tree.degrees() as f64));
    let spread = SPREAD.powi(2);
    let error =
        |tree: &Traced| averaged(noise, tree.squares(), tree.degrees() as f64) / tree.visits.max(1) as f64;
    let weight = |tree: &Traced| tree.told().map_or(0.0, |_| 1.0 / (error(tree) + spread));
    let weights = sum(&weight);
    let excess = |tree: &Traced| tree.told().map_or(0.0, |told| tree.ns_per_ray.value.ln() - told);
    let level = sum(&|tree| weight(tree) * excess(tree)) / weights;
    let estimate = |tree: &Traced| {
        let Some(told) = tree.told() else { return tree.ns_per_ray };
        let kept = spread / (spread + error(tree));
        let log = told + level + kept * (excess(tree) - level);
        let variance = kept * error(tree) + (1.0 - kept).powi(2) / weights;
        let half = student95(VISITS + tree.degrees()) * variance.sqrt();
        Estimate { value: log.exp(), low: (log - half).exp(), high: (log + half).exp() }
    };
    trees.iter().map(estimate).collect()
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
        let ns_per_ray = Estimate { value: ns, low: at(-half), high: at(half) };
        Traced { width: 4, ns_per_ray, visits, nodes_per_ray: Some(nodes) }
    }

    /// The distance of the first estimate from the measured time, as a logarithm, beside a tree that is well known.
    fn moved(visits: usize, noise: f64) -> f64 {
        let [first, ..] = estimates(&[tree(150.0, visits, noise, 20.0), tree(100.0, 1000, noise, 20.0)])[..]
        else {
            panic!("two trees");
        };
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
        let found = estimates(&[noisy, known, known, known, known])[0];
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
        let once = Traced {
            ns_per_ray: Estimate { value: 120.0, low: 0.0, high: f64::INFINITY },
            visits: 1,
            ..tree(120.0, 2, 0.1, 20.0)
        };
        let uncounted = Traced { nodes_per_ray: None, ..tree(80.0, 3, 0.1, 20.0) };
        let found = estimates(&[once, tree(100.0, 9, 0.05, 20.0), uncounted]);
        assert!(found[0].value < 120.0 && found[0].low > 50.0 && found[0].high < 200.0, "{found:?}");
        assert_eq!(found[2], uncounted.ns_per_ray);
        // Alone it is all that is known of the scene.
        assert!((estimates(&[once])[0].value - 120.0).abs() < 1e-9);
        assert_eq!(estimates(&[uncounted]), [uncounted.ns_per_ray]);
        assert_eq!(estimates(&[]), []);
    }

    /// What the reference run tells of a tree in a scene: logarithms of nodes and time, 1 if 8-wide, the variance
    /// between rounds.
    fn of_row(traced: &Row, counted: &Row) -> Option<[f64; 4]> {
        let nodes = counted.node_visits_per_ray?;
        let ns = 1e6 * traced.trace_ms_median? / traced.rays? as f64;
        let logs = |rounds: &ByRound| rounds.iter().map(|(_, ms)| ms.ln()).collect::<Vec<_>>();
        let logs = logs(&traced.by_round.trace);
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        let squares: f64 = logs.iter().map(|log| (log - mean).powi(2)).sum();
        let eight = f64::from(u8::from(traced.width == 8));
        Some([nodes.ln(), eight, ns.ln(), squares / (logs.len() as f64 - 1.0)])
    }

    /// The weights of `x` by least squares over some scenes, all centred.
    fn fitted(scenes: &[&Vec<[f64; 4]>]) -> [f64; 2] {
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
    fn the_constants_are_those_of_the_reference() {
        let rows = row::read(Path::new("results/reference")).unwrap();
        let of_scene = |name: &String| {
            let figures = SceneFigures::of(&rows, name);
            let of_tree =
                |tree| of_row(figures.trace(tree, GRAFTED).value()?, figures.trace(tree, PHR).value()?);
            let mut found: Vec<[f64; 4]> = trees(&rows).into_iter().filter_map(of_tree).collect();
            for i in 0..3 {
                let mean = found.iter().map(|tree| tree[i]).sum::<f64>() / found.len() as f64;
                found.iter_mut().for_each(|tree| tree[i] -= mean);
            }
            found
        };
        let scenes: Vec<Vec<[f64; 4]>> = scenes(&rows).iter().map(of_scene).collect();
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
        for (constant, found, within) in
            [(NODES, nodes, 0.05), (EIGHT, eight, 0.03), (SPREAD, spread, 0.01), (NOISE, noise, 0.02)]
        {
            assert!((constant - found).abs() < within, "{constant} is {found} by the reference");
        }
    }
}
