//! How many times as fast builds are on several threads as on one.

use crate::bench::rounds::paired;
use crate::bench::row::Row;
use crate::report::figures::interval::{Interval, Noise, SceneRatio};
use crate::report::figures::{Tree, scenes, tree_name, trees};
use crate::report::grid::Grid;
use crate::report::means::Ratios;

/// The speedup of a tree's builds in a scene.
pub struct Speedup {
    /// Threads, more than one.
    pub threads: u32,
    /// Time on one thread to time on as many.
    pub ratio: SceneRatio,
}

/// A geometric mean over scenes of the speedups by a number of threads.
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// `None` where too little is known.
    pub interval: Option<Interval>,
}

/// The means of a tree's speedups by each of `counts` threads, where there are any.
pub fn means(speedups: &[Speedup], counts: &[u32]) -> Vec<Mean> {
    counts.iter().filter_map(|&count| mean(&of_count(speedups, count))).collect()
}

/// Those by `count` threads.
fn of_count(speedups: &[Speedup], count: u32) -> Ratios {
    let of_count = speedups.iter().filter(|speedup| speedup.threads == count);
    Ratios(of_count.map(|speedup| speedup.ratio.clone()).collect())
}

fn mean(ratios: &Ratios) -> Option<Mean> {
    let interval = ratios.interval(ratios.over()).filter(|interval| interval.high.is_finite());
    Some(Mean { value: ratios.geometric()?, interval })
}

/// A line for each tree whose builds were timed on one thread and on more: means over scenes, the scenes of the least
/// and of the largest speedup. Empty where there are none.
pub fn table(rows: &[Row]) -> String {
    let mut grid =
        Grid::new(["tree", "threads", "times as fast", "95 %", "least", "in", "most", "in", "scenes"]);
    for tree in trees(rows) {
        let speedups = speedups(rows, tree);
        let mut counts: Vec<u32> = speedups.iter().map(|speedup| speedup.threads).collect();
        counts.sort_unstable();
        counts.dedup();
        for count in counts {
            let mut of_count = of_count(&speedups, count);
            let Some(Mean { value, interval }) = mean(&of_count) else { continue };
            of_count.0.sort_by(|a, b| a.value.total_cmp(&b.value));
            let [Some(least), Some(most)] = [of_count.0.first(), of_count.0.last()] else { continue };
            grid.push(vec![
                tree_name(tree),
                count.to_string(),
                format!("{value:.2}"),
                interval.map_or_else(String::new, |interval| interval.shown(2)),
                format!("{:.2}", least.value),
                least.scene.clone(),
                format!("{:.2}", most.value),
                most.scene.clone(),
                of_count.0.len().to_string(),
            ]);
        }
    }
    if grid.is_empty() {
        return String::new();
    }
    format!(
        "{}\nTime of a fresh build on one thread to that on several, both in the same rounds. Geometric means over scenes; \
         95 %: their interval over scenes and rounds.\n",
        grid.markdown()
    )
}

/// The speedups of a tree, scene by scene, by more threads than one.
pub fn speedups(rows: &[Row], tree: Tree<'_>) -> Vec<Speedup> {
    let is_of_tree = |row: &&Row| {
        (row.builder.as_str(), row.width) == tree && row.is_total() && row.is_compared() && row.is_good()
    };
    let mut all = Vec::new();
    for scene in scenes(rows) {
        let of_scene = rows.iter().filter(is_of_tree).filter(|row| row.scene == scene);
        // A tree has a row for each kernel, all with the same builds.
        let mut builds: Vec<&Row> = of_scene.filter(|row| row.build_ms().is_some()).collect();
        builds.sort_by_key(|row| row.threads);
        builds.dedup_by_key(|row| row.threads);
        if let Some((alone, several)) = builds.split_first().filter(|(alone, _)| alone.threads == 1) {
            all.extend(several.iter().filter_map(|several| speedup(alone, several)));
        }
    }
    all
}

/// How many times as fast as `alone` the builds of `several` threads are; both are timed in each round of a run.
fn speedup(alone: &Row, several: &Row) -> Option<Speedup> {
    // A time of zero has no place on a logarithmic axis.
    let build = |row: &Row| row.build_ms().filter(|ms| ms.median > 0.0 && ms.median.is_finite());
    let (one, more) = (build(alone)?, build(several)?);
    let pairs = match alone.run_id == several.run_id {
        true => paired(&alone.by_round.build, &several.by_round.build),
        false => Vec::new(),
    };
    let (value, noise) = (one.median / more.median, Noise::of(&one, &more, pairs));
    Some(Speedup {
        threads: several.threads,
        ratio: SceneRatio { scene: several.scene.clone(), value, noise },
    })
}

#[cfg(test)]
pub(in crate::report) mod tests {
    use super::*;
    use crate::bench::rounds::RowRounds;

    /// Builds of a tree in two scenes on one thread and on two, in three rounds.
    pub(in crate::report) fn two_scenes() -> [Row; 4] {
        let row = |scene: &str, threads, times: [f64; 3]| {
            let build = (0..).zip(times).collect();
            let by_round = RowRounds { build, ..RowRounds::default() };
            let scene = scene.into();
            Row { scene, threads, by_round, ..Row::by_hand("lbvh", 4, "none", times[1], 1.0) }
        };
        // Drift from round to round hits both.
        [
            row("a", 1, [9.0, 18.0, 36.0]),
            row("a", 2, [5.0, 10.0, 20.0]),
            row("b", 1, [8.0, 16.0, 32.0]),
            row("b", 2, [5.0, 10.0, 20.0]),
        ]
    }

    #[test]
    fn builds_on_one_thread_are_set_beside_those_on_more() {
        let row = |threads, ms| Row { threads, ..Row::by_hand("lbvh", 4, "none", ms, 1.0) };
        let rows = [row(2, 10.0), row(1, 18.0), row(4, 6.0), row(4, 6.0)];
        let told: Vec<(u32, f64)> =
            speedups(&rows, ("lbvh", 4)).iter().map(|it| (it.threads, it.ratio.value)).collect();
        assert_eq!(told, [(2, 1.8), (4, 3.0)]);
        assert!(speedups(&[row(1, 18.0), row(2, 0.0)], ("lbvh", 4)).is_empty(), "a time of zero");
    }

    #[test]
    fn means_have_intervals_over_scenes_and_paired_rounds() {
        let rows = two_scenes();
        let both = speedups(&rows, ("lbvh", 4));
        let mean = |speedups: &[Speedup]| means(speedups, &[2]).remove(0);
        let Mean { value, interval } = mean(&both[..1]);
        let Interval { low, high } = interval.unwrap();
        assert!((value - 1.8).abs() < 1e-9 && (low - 1.8).abs() < 1e-9 && (high - 1.8).abs() < 1e-9);
        let Interval { low, high } = mean(&both).interval.unwrap();
        assert!(low < 1.65 && 1.75 < high, "{low} {high}");
        let table = table(&rows);
        let line = table.lines().nth(2).unwrap();
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        assert_eq!(cells[1..4], ["lbvh", "2", "1.70"], "{table}");
        assert_eq!(cells[5..10], ["1.60", "b", "1.80", "a", "2"], "{table}");
        assert_eq!(super::table(&rows[..1]), "");
    }
}
