//! Two runs over the same scenes and trees on one machine as one run of more rounds, which judges with less noise.

use super::observed::Observed;
use crate::bench::quick::line::TotalTime;
use crate::bench::statistics::{arithmetic_mean, median};

/// `scenes` with the rounds of `other` added. The machine is not as fast in one hour as in another: in each scene the
/// other's times are scaled so that the trees' mean is that of the first. Scenes of which `other` lacks a tree, or
/// either run the rounds, stay as they are.
pub fn pooled(scenes: Vec<Observed>, other: &[Observed]) -> Vec<Observed> {
    let with_other = |scene: Observed| {
        let more = other.iter().find(|other| other.scene == scene.scene);
        more.and_then(|more| joined(&scene, more)).unwrap_or(scene)
    };
    scenes.into_iter().map(with_other).collect()
}

fn joined(scene: &Observed, other: &Observed) -> Option<Observed> {
    let place = |tree| other.trees.iter().position(|known| known == tree);
    let other = other.only(&scene.trees.iter().map(place).collect::<Option<Vec<_>>>()?);
    if scene.by_round.is_empty() || other.by_round.is_empty() {
        return None;
    }
    let level = |figure: fn(&TotalTime) -> f64| {
        let logs = scene.lines.iter().zip(&other.lines).map(|(a, b)| (figure(a) / figure(b)).ln());
        Some(arithmetic_mean(&logs.collect::<Vec<_>>())?.exp())
    };
    let (build, ray) = (level(build)?, level(ray)?);
    let scaled =
        |line: &TotalTime| TotalTime::exact(build * line.build_ms.value, ray * line.ns_per_ray.value);
    let more = other.by_round.iter().map(|lines| lines.iter().map(scaled).collect::<Vec<_>>());
    let by_round: Vec<Vec<TotalTime>> = scene.by_round.iter().cloned().chain(more).collect();
    let lines = medians(&by_round)?;
    Some(Observed { lines, by_round, ..scene.clone() })
}

/// The median of each figure of each tree over some rounds; `None` without any.
pub fn medians<T: AsRef<[TotalTime]>>(rounds: &[T]) -> Option<Vec<TotalTime>> {
    let trees = rounds.first()?.as_ref().len();
    let of = |tree: usize, figure: fn(&TotalTime) -> f64| {
        median(&rounds.iter().filter_map(|lines| lines.as_ref().get(tree)).map(figure).collect::<Vec<_>>())
    };
    (0..trees).map(|tree| Some(TotalTime::exact(of(tree, build)?, of(tree, ray)?))).collect()
}

fn build(line: &TotalTime) -> f64 {
    line.build_ms.value
}

fn ray(line: &TotalTime) -> f64 {
    line.ns_per_ray.value
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::report::advice::model::facts::SceneFacts;

    /// A scene of two trees, `a` and `b`, with builds of so many ms in its rounds; rays take ten times as many ns.
    pub fn scene(rounds: &[[f64; 2]]) -> Observed {
        let by_round: Vec<Vec<TotalTime>> =
            rounds.iter().map(|round| round.map(|ms| TotalTime::exact(ms, 10.0 * ms)).to_vec()).collect();
        Observed {
            scene: "hall".into(),
            facts: SceneFacts { triangles: 1e5, sah: 40.0, epo: 5.0, leaf_fill: 0.8 },
            trees: ["a", "b"].map(|builder| (builder.to_owned(), 4)).to_vec(),
            lines: medians(&by_round).unwrap(),
            by_round,
        }
    }

    #[test]
    fn the_second_run_is_brought_to_the_level_of_the_first() {
        let first = scene(&[[10.0, 20.0], [11.0, 20.0], [10.0, 21.0]]);
        // In a slower hour, by two, and its trees the other way round.
        let mut second = scene(&[[40.0, 20.0], [40.0, 22.0]]);
        second.trees.reverse();
        let pooled = pooled(vec![first.clone()], &[second]);
        assert_eq!(pooled[0].by_round.len(), 5);
        let [a, b] = [0, 1].map(|tree| build(&pooled[0].by_round[3][tree]));
        assert!((a * b / 200.0 - 1.0).abs() < 0.06 && (b / a - 2.0).abs() < 1e-9, "{a} {b}");
        assert!((build(&pooled[0].lines[0]) - 10.0).abs() < 0.5);
    }

    #[test]
    fn a_run_without_a_tree_or_rounds_adds_nothing() {
        let first = scene(&[[10.0, 20.0]]);
        let of_another = Observed { scene: "yard".into(), ..first.clone() };
        let without_tree = first.only(&[0]);
        let without_rounds = Observed { by_round: Vec::new(), ..first.clone() };
        for other in [of_another, without_tree, without_rounds] {
            assert_eq!(pooled(vec![first.clone()], &[other])[0].by_round.len(), 1);
        }
    }
}
