//! Two programs measured by turns: is a builder faster in the second, slower or the same?

use super::runs::Verdict;
use crate::bench::cell::Cell;
use crate::bench::statistics::Ratio;
use crate::bench::turns::Measured;
use crate::bench::turns::paired::PairedMean;
use crate::report::grid::{Grid, short};

/// A verdict for each builder.
#[derive(Clone, Debug, PartialEq)]
pub struct ByTurns {
    /// In the order of the cells: the mean over scenes, and what it says.
    pub verdicts: Vec<(Ratio, Verdict)>,
    grid: Grid,
    legend: String,
}

impl ByTurns {
    /// Judges what was measured of `cells` in `scenes`, by their names; changes up to `threshold` count as none.
    pub fn of(measured: &Measured, cells: &[Cell], scenes: &[String], threshold: f64) -> Self {
        let mut grid = Grid::new(["builder", "scene", "A ms", "B ms", "B / A", "95 % interval", "verdict"]);
        let mut verdicts = Vec::new();
        for (cell, of_scenes) in cells.iter().zip(&measured.samples) {
            let name = format!("{} / {}", cell.builder, cell.width);
            let mut line = |scene: &str, ms: [String; 2], mean: PairedMean| {
                let ratio = mean.ratio();
                let verdict = Verdict::of(&ratio, threshold);
                let [a, b] = ms;
                let interval = format!("{:.3} to {:.3}", ratio.low, ratio.high);
                let value = format!("{:.3}", ratio.value);
                grid.push(vec![name.clone(), scene.into(), a, b, value, interval, verdict.name().into()]);
                (ratio, verdict)
            };
            for (scene, of_scene) in scenes.iter().zip(of_scenes) {
                line(scene, of_scene.ms.map(short), PairedMean::of([&of_scene.logs[..]].into_iter()));
            }
            let all = PairedMean::of(of_scenes.iter().map(|scene| &scene.logs[..]));
            verdicts.push(line("all", Default::default(), all));
        }
        let Measured { sessions, spent, is_precise, .. } = measured;
        let ended = if *is_precise { "" } else { ", when the time was over" };
        let legend = format!(
            "A and B by turns, {sessions} sessions of fresh processes per scene in {} s{ended}; changes up to {} % \
             count as none.\n",
            spent.as_secs(),
            short(100.0 * threshold)
        );
        Self { verdicts, grid, legend }
    }

    /// Builders with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.verdicts.iter().filter(|found| found.1 == verdict).count()
    }

    /// The table.
    pub fn document(&self) -> String {
        format!("{}\n{}{}\n", self.grid.markdown(), self.legend, self.summary())
    }

    /// One line of counts.
    pub fn summary(&self) -> String {
        let counts = Verdict::ALL.map(|verdict| format!("{} {}", self.count(verdict), verdict.name()));
        format!("{} builders: {}", self.verdicts.len(), counts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::turns::OfScene;
    use std::time::Duration;

    #[test]
    fn each_builder_has_a_verdict_over_all_scenes() {
        let of_scene = |logs: &[f64]| OfScene { logs: logs.into(), ms: [10.0, 10.5] };
        let measured = Measured {
            samples: vec![
                vec![of_scene(&[0.05, 0.051, 0.049]), of_scene(&[0.052, 0.048, 0.05])],
                vec![of_scene(&[0.001, -0.001, 0.0]), of_scene(&[0.0, 0.001, -0.001])],
                vec![of_scene(&[0.05, -0.05, 0.0]), of_scene(&[0.05, 0.0, -0.05])],
            ],
            is_precise: false,
            sessions: 3,
            spent: Duration::from_secs(61),
        };
        let cell = |builder: &str| Cell::new(builder, 4, &[]);
        let cells = ["slow", "same", "noisy"].map(cell);
        let judged = ByTurns::of(&measured, &cells, &["a".into(), "b".into()], 0.02);
        let verdicts: Vec<Verdict> = judged.verdicts.iter().map(|verdict| verdict.1).collect();
        assert_eq!(verdicts, [Verdict::Slower, Verdict::Same, Verdict::Inconclusive]);
        let text = judged.document();
        assert!(text.contains("3 builders: 1 slower, 1 inconclusive, 0 faster, 1 same"), "{text}");
        assert!(text.contains("when the time was over") && text.contains("61 s"), "{text}");
        assert_eq!(text.lines().filter(|line| line.starts_with("| slow ")).count(), 3);
    }
}
