//! Two programs measured by turns: is a builder faster in the second, slower or the same?

use super::runs::Change;
use crate::bench::statistics::{Ratio, median};
use crate::bench::turns::paired::PairedMean;
use crate::bench::turns::row::TurnRow;
use crate::report::grid::{Grid, short};

/// Changes up to this count as none, unless a command line tells another.
pub const THRESHOLD: f64 = 0.02;

/// A verdict for each builder.
#[derive(Clone, Debug, PartialEq)]
pub struct ByTurns {
    /// In the order of the rows: the mean over scenes, and what it says.
    pub verdicts: Vec<(Ratio, Change)>,
    grid: Grid,
    legend: String,
}

impl ByTurns {
    /// Judges `rows`; changes up to `threshold` count as none.
    pub fn of(rows: &[TurnRow], threshold: f64) -> Self {
        let mut grid = Grid::new(["builder", "scene", "A ms", "B ms", "B / A", "95 % interval", "verdict"]);
        let mut verdicts = Vec::new();
        for tree in once_each(rows, TurnRow::tree) {
            let of_tree: Vec<&TurnRow> = rows.iter().filter(|row| row.tree() == tree).collect();
            let mut line = |scene: &str, ms: [String; 2], mean: PairedMean| {
                let ratio = mean.ratio();
                let verdict = Change::of(&ratio, threshold);
                let [a, b] = ms;
                let (name, value) = (name_of(tree), format!("{:.3}", ratio.value));
                grid.push(vec![name, scene.into(), a, b, value, interval(&ratio), verdict.name().into()]);
                (ratio, verdict)
            };
            for scene in once_each(rows, |row| &*row.scene) {
                let sessions = || of_tree.iter().copied().filter(|row| row.scene == scene);
                let middle = |ms: fn(&TurnRow) -> f64| {
                    median(&sessions().map(ms).collect::<Vec<f64>>()).map_or_else(String::new, short)
                };
                let ms = [middle(|row| row.before_ms), middle(|row| row.after_ms)];
                line(scene, ms, PairedMean::of_rows(sessions()));
            }
            verdicts.push(line("all", Default::default(), PairedMean::of_rows(of_tree.iter().copied())));
        }
        let legend = format!(
            "A and B by turns, {} sessions of fresh processes per scene; changes up to {} % count as none.\n",
            sessions(rows),
            short(100.0 * threshold)
        );
        Self { verdicts, grid, legend }
    }

    /// Builders with a verdict.
    pub fn count(&self, verdict: Change) -> usize {
        self.verdicts.iter().filter(|found| found.1 == verdict).count()
    }

    /// The table.
    pub fn document(&self) -> String {
        format!("{}\n{}{}\n", self.grid.markdown(), self.legend, self.summary())
    }

    /// One line of counts.
    pub fn summary(&self) -> String {
        let counts = Change::ALL.map(|verdict| format!("{} {}", self.count(verdict), verdict.name()));
        format!("{} builders: {}", self.verdicts.len(), counts.join(", "))
    }
}

/// For a page: the mean of each builder over scenes, with its least and largest scene.
pub fn page(rows: &[TurnRow]) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let mut grid = Grid::new(["builder", "new / old time", "verdict", "least", "in", "most", "in"]);
    for tree in once_each(rows, TurnRow::tree) {
        let of_tree = || rows.iter().filter(|row| row.tree() == tree);
        let all = PairedMean::of_rows(of_tree()).ratio();
        let mut scenes: Vec<(&str, Ratio)> = once_each(rows, |row| &*row.scene)
            .into_iter()
            .map(|scene| (scene, PairedMean::of_rows(of_tree().filter(|row| row.scene == scene)).ratio()))
            .collect();
        scenes.sort_by(|a, b| a.1.value.total_cmp(&b.1.value));
        let shown = |ratio: &Ratio| format!("{:.2} [{:.2}, {:.2}]", ratio.value, ratio.low, ratio.high);
        let end = |of: Option<&(&str, Ratio)>| {
            of.map_or_else(Default::default, |(scene, ratio)| [shown(ratio), (*scene).to_owned()])
        };
        let verdict = Change::of(&all, THRESHOLD).name().to_owned();
        let mut cells = vec![name_of(tree), shown(&all), verdict];
        cells.extend([end(scenes.first()), end(scenes.last())].into_iter().flatten());
        grid.push(cells);
    }
    let revision = |rev: &str| if rev.is_empty() { "unknown".to_owned() } else { rev.to_owned() };
    format!(
        "{}\nBuild time of revision {} relative to that of {}, both by turns: geometric means over {} scenes with 95 % \
         intervals; changes up to {} % count as none. {}, {}, threads: {}; {} sessions of fresh processes per scene.\n",
        grid.markdown(),
        revision(&first.after_rev),
        revision(&first.before_rev),
        once_each(rows, |row| &*row.scene).len(),
        short(100.0 * THRESHOLD),
        first.utc,
        first.cpu,
        first.threads,
        sessions(rows)
    )
}

/// What rows have, each once, in their order.
fn once_each<'a, T: PartialEq>(rows: &'a [TurnRow], of: impl Fn(&'a TurnRow) -> T) -> Vec<T> {
    let mut found = Vec::new();
    for value in rows.iter().map(of) {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

fn sessions(rows: &[TurnRow]) -> u32 {
    rows.iter().map(|row| row.session).max().unwrap_or(0)
}

fn name_of((builder, width): (&str, u32)) -> String {
    format!("{builder} / {width}")
}

fn interval(ratio: &Ratio) -> String {
    format!("{:.3} to {:.3}", ratio.low, ratio.high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<TurnRow> {
        let of_scene = |builder: &'static str, scene: &'static str, logs: [f64; 3]| {
            logs.into_iter().zip(1..).map(move |(log, session)| TurnRow {
                builder: builder.into(),
                width: 4,
                scene: scene.into(),
                session,
                before_ms: 10.0 * f64::from(session),
                after_ms: 10.5 * f64::from(session),
                ratio: log.exp(),
                after_rev: "b".into(),
                ..TurnRow::default()
            })
        };
        let scene = |name, logs: [[f64; 3]; 3]| {
            ["slow", "same", "noisy"]
                .into_iter()
                .zip(logs)
                .flat_map(move |(builder, logs)| of_scene(builder, name, logs))
        };
        let first = scene("first", [[0.05, 0.051, 0.049], [0.001, -0.001, 0.0], [0.05, -0.05, 0.0]]);
        let second = scene("second", [[0.062, 0.058, 0.06], [0.0, 0.001, -0.001], [0.05, 0.0, -0.05]]);
        first.chain(second).collect()
    }

    #[test]
    fn each_builder_has_a_verdict_over_all_scenes() {
        let judged = ByTurns::of(&rows(), THRESHOLD);
        let verdicts: Vec<Change> = judged.verdicts.iter().map(|verdict| verdict.1).collect();
        assert_eq!(verdicts, [Change::Slower, Change::Same, Change::Inconclusive]);
        let text = judged.document();
        assert!(text.contains("3 builders: 1 slower, 1 inconclusive, 0 faster, 1 same"), "{text}");
        assert!(text.contains("3 sessions"), "{text}");
        let slow: Vec<&str> = text.lines().filter(|line| line.starts_with("| slow ")).collect();
        assert_eq!(slow.len(), 3);
        // The times are those of the middle session.
        assert!(slow[0].contains("20.0") && slow[0].contains("21.0"), "{text}");
    }

    #[test]
    fn a_page_names_the_ends() {
        let text = page(&rows());
        let slow = text.lines().find(|line| line.starts_with("| slow ")).unwrap();
        let place = |part: &str| slow.find(part).unwrap_or_else(|| panic!("{part} in {text}"));
        assert!(place("slower") < place("1.05 [") && place("1.05 [") < place("first"));
        assert!(place("first") < place("1.06 [1.06, 1.07]") && place("1.06 [1.06, 1.07]") < place("second"));
        assert!(
            text.contains("revision b relative to that of unknown") && text.contains("2 scenes"),
            "{text}"
        );
        assert_eq!(page(&[]), "");
    }
}
