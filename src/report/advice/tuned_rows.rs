//! A search of parameters as CSV, one row per configuration and stage, and the table of what searches in several
//! scenes gained.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use crate::bench::environment::{Machine, Program};
use crate::bench::files::{RecordsError, read_csv, write_csv};
use crate::bench::quick::line::TotalTime;
use crate::bench::tune::{Trial, Tuned, mean_ratios};
use crate::report::advice::rays_in_words;
use crate::report::figures::tree_name;
use crate::report::grid::Grid;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the columns.
const SCHEMA: u32 = 1;
/// The file.
pub const TUNE: &str = "tune.csv";
/// The stage of the winner with rays that no choice was made by.
const AGAIN: &str = "again";

/// A configuration in one stage of a search. Ratios are to the anchor, which was measured right before; the ends of
/// intervals are empty for one pair.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TuneRow {
    /// Of these columns: 1.
    pub schema: u32,
    /// The scene.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// The number of rays that the tree is for.
    pub rays: f64,
    /// The tree that all is relative to.
    pub anchor: String,
    /// "trial", "race" or "again".
    pub stage: String,
    /// The builder with its changes.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Pairs of visits behind the figures.
    pub pairs: usize,
    /// Build time.
    pub build_ms: Option<f64>,
    /// Time per ray.
    pub ns_per_ray: Option<f64>,
    /// Build time relative to the anchor's.
    pub build: f64,
    /// Time per ray, likewise.
    pub ray: f64,
    /// Time for the build and all rays, likewise.
    pub total: f64,
    /// Lower end of its 95 % interval.
    pub total_low: Option<f64>,
    /// Upper end of it.
    pub total_high: Option<f64>,
    /// Revision of this program, `-dirty` if the sources differed from it; empty in files of older ones.
    #[serde(default)]
    pub git_rev: String,
    /// Processor model; likewise.
    #[serde(default)]
    pub cpu: String,
}

/// Writes a search to `folder`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write(
    folder: &Path,
    tuned: &Tuned,
    (scene, triangles): (&str, usize),
    rays: f64,
) -> Result<(), RecordsError> {
    let anchor = tree_name((&tuned.anchor.builder, tuned.anchor.width));
    let (git_rev, cpu) = (Program::this().git_rev, Machine::this("").cpu);
    let row = |stage: &str, trial: &Trial| {
        let visits: Vec<_> = trial.pairs.iter().map(|pair| pair.tried).collect();
        let line = TotalTime::of(&visits);
        let [build, ray, total] = mean_ratios(&trial.pairs, rays);
        let end = |value: f64| Some(value).filter(|value| value.is_finite() && *value > 0.0);
        TuneRow {
            schema: SCHEMA,
            scene: scene.to_owned(),
            triangles,
            rays,
            anchor: anchor.clone(),
            stage: stage.to_owned(),
            builder: trial.cell.builder.clone(),
            width: trial.cell.width,
            pairs: trial.pairs.len(),
            build_ms: line.map(|line| line.build_ms.value),
            ns_per_ray: line.map(|line| line.ns_per_ray.value),
            build: build.value,
            ray: ray.value,
            total: total.value,
            total_low: end(total.low),
            total_high: end(total.high),
            git_rev: git_rev.clone(),
            cpu: cpu.clone(),
        }
    };
    let trials = tuned.trials.iter().map(|trial| row("trial", trial));
    let race = tuned.race.iter().map(|trial| row("race", trial));
    let rows: Vec<TuneRow> = trials.chain(race).chain([row(AGAIN, &tuned.fresh)]).collect();
    write_csv(&folder.join(TUNE), &rows)
}

/// What the searches in the subfolders of `folder` gained.
///
/// # Errors
/// A file that cannot be read.
pub fn page(folder: &Path) -> Result<String, RecordsError> {
    let schema = |row: &TuneRow| row.schema;
    let read = |one: &Path| read_csv(one, TUNE, (schema, SCHEMA), "run `phr tune` first");
    let found: Vec<Vec<TuneRow>> =
        super::rows::with_file(folder, TUNE).iter().map(|one| read(one)).collect::<Result<_, _>>()?;
    let winners: Vec<&TuneRow> =
        found.iter().filter_map(|rows| rows.iter().find(|row| row.stage == AGAIN)).collect();
    Ok(table(&winners))
}

fn table(winners: &[&TuneRow]) -> String {
    let mut grid = Grid::new(["scene", "best configuration", "build", "ray", "total", "95 %", "pairs"]);
    for row in winners {
        let ends = match (row.total_low, row.total_high) {
            (Some(low), Some(high)) => format!("[{low:.2}, {high:.2}]"),
            _ => "?".into(),
        };
        let ratios = [row.build, row.ray, row.total].map(|ratio| format!("{ratio:.2}"));
        // Whole names are long, and in the file.
        let base = row.builder.split_once('[').map(|(base, _)| format!("{base}[...]"));
        let name = tree_name((base.as_deref().unwrap_or(&row.builder), row.width));
        let cells = [row.scene.clone(), name].into_iter().chain(ratios);
        grid.push(cells.chain([ends, row.pairs.to_string()]).collect());
    }
    // The anchor itself is as often measured below 1 as above: that gains nothing.
    let is_other = |row: &&&TuneRow| tree_name((&row.builder, row.width)) != row.anchor;
    let others: Vec<&TuneRow> = winners.iter().filter(is_other).copied().collect();
    let count = |is_so: &dyn Fn(&TuneRow) -> bool| others.iter().filter(|row| is_so(row)).count();
    let less = count(&|row| row.total < 1.0);
    let surely = count(&|row| row.total_high.is_some_and(|high| high < 1.0));
    let worse = count(&|row| row.total_low.is_some_and(|low| low > 1.0));
    let mut told: Vec<String> =
        winners.iter().map(|row| format!("{} for {} rays", row.anchor, rays_in_words(row.rays))).collect();
    told.sort();
    told.dedup();
    format!(
        "{}\nAll relative to {}, measured right before each visit, with rays that no choice was made by. [...]: with changed \
         parameters, which tune.csv has. The best configuration takes less time in all in {less} of {} scenes, surely in \
         {surely}; surely more in {worse}; in {} it is the anchor itself.\n",
        grid.markdown(),
        told.join(", "),
        winners.len(),
        winners.len() - others.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::cell::Cell;
    use crate::bench::quick::QuickVisit;
    use crate::bench::tune::Pair;
    use crate::builders::Recipe;

    fn tuned(builder: &str, totals: &[f64]) -> Tuned {
        let visit = |factor: f64| QuickVisit { build_ms: 100.0 * factor, ns_per_ray: 100.0 * factor };
        let pair = |&factor: &f64| Pair { tried: visit(factor), anchor: visit(1.0) };
        let trial = Trial {
            cell: Cell::new(builder, 8, &[]),
            recipe: Recipe::parse(builder).unwrap(),
            pairs: totals.iter().map(pair).collect(),
        };
        Tuned {
            anchor: Cell::new("phr-quality", 8, &[]),
            trials: vec![trial.clone()],
            failures: Vec::new(),
            race: vec![trial.clone()],
            fresh: trial,
        }
    }

    #[test]
    fn searches_are_read_as_written_and_counted() {
        let folder = tempfile::tempdir().unwrap();
        let best = "phr-best[phr.delta=5]";
        let cases = [
            ("hall", best, &[0.8, 0.81, 0.79][..]),
            ("same", "phr-quality", &[0.9, 0.91, 0.89]),
            ("shed", best, &[0.9]),
            ("yard", best, &[1.2, 1.21, 1.19]),
        ];
        for (scene, builder, totals) in cases {
            let place = folder.path().join(scene);
            std::fs::create_dir(&place).unwrap();
            write(&place, &tuned(builder, totals), (scene, 1000), 1e9).unwrap();
        }
        let text = page(folder.path()).unwrap();
        assert!(text.contains("| hall  |  phr-best[...] / 8 |  0.80 | 0.80 |  0.80 | [0.7"), "{text}");
        assert!(text.contains(" ? |"), "{text}");
        assert!(text.contains("phr-quality / 8 for 1G rays"), "{text}");
        assert!(
            text.contains("in 2 of 4 scenes, surely in 1; surely more in 1; in 1 it is the anchor itself"),
            "{text}"
        );
        let why = page(&folder.path().join("none")).unwrap_err().to_string();
        assert!(why.contains("phr tune"), "{why}");
    }
}
