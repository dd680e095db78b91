//! In how many scenes trees of Embree's are on the front of build and trace time, beside what is aimed at.

use super::judge::Verdict;
use super::list::MOST_ON_FRONT;
use crate::bench::cell::is_saved;
use crate::bench::row::Row;
use crate::bench::statistics::median;
use crate::random::SplitMix64;
use crate::report::figures::interval::{Interval, LEAST_ROUNDS, wider};
use crate::report::figures::{Figure, SceneFigures, Tree, Under, tree_name, trees};
use crate::report::grid::Grid;
use crate::report::plot::pareto::front;

/// Draws behind an interval.
const DRAWS: usize = 400;

/// What a tree is compared with: the name, under which kernels, and whether with trees of its width alone.
fn comparisons(rows: &[Row]) -> [(&'static str, Under, bool); 3] {
    let best = Under::best(rows);
    [
        ("trees of its width", best.clone(), true),
        ("trees of both widths", best, false),
        ("trees of both widths, own kernels", Under::Own, false),
    ]
}

/// The table; empty where no tree of Embree's is beside another.
pub fn fronts(rows: &[Row]) -> String {
    let header =
        ["compared with", "target", "most scenes", "95 %", "by", "others that may be beyond", "scenes", ""];
    let mut grid = Grid::new(header);
    let scenes = SceneFigures::all(rows);
    // A saved tree was loaded, not built.
    let of_rows: Vec<Tree<'_>> = trees(rows).into_iter().filter(|tree| !is_saved(tree.0)).collect();
    let embrees: Vec<Tree<'_>> =
        of_rows.iter().copied().filter(|tree| tree.0.starts_with("embree-")).collect();
    if embrees.len() == of_rows.len() {
        return String::new();
    }
    for (name, under, same_width) in comparisons(rows) {
        let points: Vec<Points<'_>> =
            scenes.iter().map(|scene| Points::of(scene, &of_rows, &under)).collect();
        let mut counted: Vec<(Tree<'_>, usize, Interval)> =
            embrees.iter().map(|&tree| counted(&points, tree, same_width)).collect();
        counted.sort_by_key(|(_, count, interval)| std::cmp::Reverse((*count, interval.high as usize)));
        let Some((tree, most, interval)) = counted.first().cloned() else { continue };
        let verdicts =
            counted.iter().map(|(_, _, interval)| Verdict::at_most(MOST_ON_FRONT as f64, *interval));
        // Of no more scenes than the limit none could be beyond it.
        let none_can_be = (scenes.len() <= MOST_ON_FRONT).then_some(Verdict::Undecided);
        let verdict = verdicts.chain(none_can_be).reduce(Verdict::and);
        let beyond = counted.iter().skip(1).filter(|(_, _, interval)| interval.high > MOST_ON_FRONT as f64);
        let beyond: Vec<String> = beyond
            .map(|(tree, count, interval)| format!("{}: {count} {}", tree_name(*tree), interval.shown(0)))
            .collect();
        grid.push(vec![
            name.into(),
            format!("≤ {MOST_ON_FRONT}"),
            most.to_string(),
            interval.shown(0),
            tree_name(tree),
            beyond.join(", "),
            scenes.len().to_string(),
            verdict.map_or_else(String::new, |verdict| verdict.cell()),
        ]);
    }
    format!(
        "{}\nNumbers of scenes in which no other tree builds and traces as fast; 95 %: over rounds. Met if no tree of Embree's can \
         be beyond, not met if one surely is, else undecided, as over no more scenes than the target.\n",
        grid.markdown()
    )
}

/// Build and trace time of each tree in a scene, with the times of its rounds.
struct Points<'a> {
    trees: &'a [Tree<'a>],
    times: Vec<Option<[Times; 2]>>,
    /// Rounds of the tree that has most.
    rounds: usize,
}

struct Times {
    median: f64,
    by_round: Vec<f64>,
}

impl<'a> Points<'a> {
    fn of(scene: &SceneFigures<'_>, trees: &'a [Tree<'a>], under: &Under) -> Self {
        let times = |tree: Tree<'_>, figure: Figure| {
            let median = scene.figure(tree, figure, under).value()?.median;
            let by_round = scene.rounds(tree, figure, under);
            let by_round =
                by_round.map_or_else(Vec::new, |(_, times)| times.iter().map(|time| time.1).collect());
            Some(Times { median, by_round })
        };
        let both = |&tree: &Tree<'a>| Some([times(tree, Figure::Build)?, times(tree, Figure::Trace)?]);
        let times: Vec<Option<[Times; 2]>> = trees.iter().map(both).collect();
        let rounds = times.iter().flatten().flatten().map(|times| times.by_round.len()).max().unwrap_or(0);
        Self { trees, times, rounds }
    }

    /// Whether `tree` is on the front, of the rounds `drawn` or of all.
    fn has_on_front(&self, tree: Tree<'_>, same_width: bool, drawn: Option<&[usize]>) -> bool {
        let rivals = self.trees.iter().zip(&self.times).filter(|(rival, _)| !same_width || rival.1 == tree.1);
        let rivals: Vec<(Tree<'_>, (f64, f64))> = rivals
            .filter_map(|(rival, times)| {
                let [build, trace] = times.as_ref()?;
                Some((*rival, (build.of(drawn), trace.of(drawn))))
            })
            .collect();
        let points: Vec<(f64, f64)> = rivals.iter().map(|rival| rival.1).collect();
        front(&points).into_iter().any(|on| rivals.get(on).is_some_and(|rival| rival.0 == tree))
    }
}

impl Times {
    /// The median of the rounds `drawn`, its deviation enlarged, since few rounds differ too little and tell little of
    /// how much they do; of trees that have not all rounds, that of all.
    fn of(&self, drawn: Option<&[usize]>) -> f64 {
        let Some(drawn) = drawn.filter(|_| self.by_round.len() > 1) else { return self.median };
        let times: Option<Vec<f64>> = drawn.iter().map(|&round| self.by_round.get(round).copied()).collect();
        let Some(drawn) = times.and_then(|times| median(&times)) else { return self.median };
        self.median * (drawn / self.median).powf(wider(self.by_round.len()))
    }
}

/// Scenes in which `tree` is on the front, with the interval of their number over rounds, which are drawn with
/// replacement, in a scene the same for all trees.
fn counted<'t>(scenes: &[Points<'_>], tree: Tree<'t>, same_width: bool) -> (Tree<'t>, usize, Interval) {
    let count = scenes.iter().filter(|scene| scene.has_on_front(tree, same_width, None)).count();
    let mut random = SplitMix64::new(1);
    let mut draw = || {
        let is_on = |scene: &&Points<'_>| {
            let drawn: Vec<usize> = (0..scene.rounds).map(|_| random.below(scene.rounds)).collect();
            scene.has_on_front(tree, same_width, Some(&drawn))
        };
        scenes.iter().filter(is_on).count() as f64
    };
    let mut drawn: Vec<f64> = (0..DRAWS).map(|_| draw()).collect();
    drawn.sort_by(f64::total_cmp);
    if scenes.iter().any(|scene| scene.rounds < LEAST_ROUNDS) {
        return (tree, count, Interval { low: 0.0, high: scenes.len() as f64 });
    }
    let at = |index: usize| drawn.get(index).copied().unwrap_or(count as f64);
    let (low, high) = (at(DRAWS / 40), at(DRAWS - 1 - DRAWS / 40));
    (tree, count, Interval { low: low.min(count as f64), high: high.max(count as f64) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::rounds::RowRounds;
    use crate::report::figures::GRAFTED;

    /// Embree's builds take `build` of ours by round, over trees that trace as fast.
    fn scene(scene: &str, build: [f64; 3]) -> [Row; 2] {
        let row = |builder, build: [f64; 3]| {
            let by_round = |times: [f64; 3]| (0..3).zip(times).collect();
            let median = median(&build).unwrap();
            Row {
                scene: scene.into(),
                by_round: RowRounds {
                    build: by_round(build),
                    trace: by_round([1.0; 3]),
                    ..RowRounds::default()
                },
                ..Row::by_hand(builder, 4, GRAFTED, median, 1.0)
            }
        };
        [row("embree-sah", build), row("phr-speed", [1.0; 3])]
    }

    fn verdict(rows: &[Row]) -> (String, String) {
        let text = fronts(rows);
        let line = text.lines().find(|line| line.contains("trees of its width")).unwrap().to_owned();
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        (cells[3..5].join(" "), cells.iter().rev().nth(1).unwrap().to_string())
    }

    #[test]
    fn trees_of_embrees_are_counted_where_none_of_ours_is_ahead() {
        let of = |build: &[[f64; 3]]| -> Vec<Row> {
            let named = build.iter().enumerate().map(|(i, build)| (i.to_string(), *build));
            named.flat_map(|(name, build)| scene(&name, build)).collect()
        };
        let (ahead, behind, unsure) = ([0.5; 3], [2.0; 3], [0.9, 0.95, 1.3]);
        assert_eq!(verdict(&of(&[ahead, ahead, ahead, behind])), ("3 [3, 3]".into(), "not met".into()));
        assert_eq!(verdict(&of(&[ahead, behind, behind, behind])), ("1 [1, 1]".into(), "met".into()));
        assert_eq!(verdict(&of(&[ahead, ahead, unsure, behind])), ("3 [2, 3]".into(), "undecided".into()));
        // Of so few none could be more.
        assert_eq!(verdict(&of(&[behind, behind])), ("0 [0, 0]".into(), "undecided".into()));
        assert_eq!(fronts(&of(&[ahead])[..1]), "");
        // A single round decides nothing.
        let one = |row: Row| Row {
            by_round: RowRounds { build: [(0, 1.0)].into(), ..RowRounds::default() },
            ..row
        };
        let once: Vec<Row> = of(&[ahead, ahead, ahead, behind]).into_iter().map(one).collect();
        assert_eq!(verdict(&once), ("3 [0, 4]".into(), "undecided".into()));
        // A tree that was only loaded takes no place.
        let loaded = |row: Row| Row { builder: "saved:best".into(), ..row };
        let rows = [ahead; 4].map(|build| scene("", build)).concat();
        let named = rows.into_iter().enumerate().map(|(i, row)| Row { scene: (i / 2).to_string(), ..row });
        let beside: Vec<Row> =
            named.flat_map(|row| [loaded(Row { build_ms_median: Some(0.1), ..row.clone() }), row]).collect();
        assert_eq!(verdict(&beside), ("4 [4, 4]".into(), "not met".into()));
    }
}
