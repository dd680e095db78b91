//! How builders grow: build time per triangle over scenes of the same kind and growing size, relative to the
//! smallest of them.

use super::judge::Verdict;
use super::list::{GROWTH, GROWTH_BUILDERS, GROWTH_SIZES};
use crate::bench::row::Row;
use crate::report::figures::interval::Interval;
use crate::report::figures::{Place, SceneFigures, Tree, WIDTH, only, scenes, trees};
use crate::report::grid::{Grid, short};
use crate::scene::{scalable_name, scalable_triangles};

/// What a builder takes for each size.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The builder.
    pub builder: String,
    /// Nanoseconds per triangle, by the sizes of the [`Growth`].
    pub ns: Vec<Place<f64>>,
    /// Half the 95 % intervals of these, relative to them; infinite where there is no figure.
    pub errors: Vec<f64>,
}

/// Build times over sizes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Growth {
    /// Triangles, ascending.
    pub sizes: Vec<u64>,
    /// The builders of 4-wide trees, in the table's order.
    pub lines: Vec<Line>,
    /// Threads of each side.
    pub threads: u32,
}

impl Growth {
    /// That of the scenes of any size among `rows`: of the run that has most of them, as times of two runs
    /// are not compared.
    pub fn of(rows: &[Row]) -> Self {
        let rows = only(rows, |row| row.width == WIDTH && scalable_triangles(&row.scene).is_some());
        let sizes_of = |run: &str| scenes(&only(&rows, |row| row.run_id == run)).len();
        let mut runs: Vec<&str> = rows.iter().map(|row| row.run_id.as_str()).collect();
        runs.dedup();
        let run = runs.into_iter().rev().max_by_key(|run| sizes_of(run)).unwrap_or_default().to_owned();
        let rows = only(&rows, |row| row.run_id == run);
        let threads = rows.first().map_or(0, |row| row.threads);
        let mut by_size: Vec<(u64, SceneFigures<'_>)> = scenes(&rows)
            .iter()
            .map(|scene| SceneFigures::of(&rows, scene))
            .map(|figures| (figures.triangles(), figures))
            .collect();
        by_size.sort_by_key(|size| size.0);
        let line = |tree: Tree<'_>| {
            let summary = |figures: &SceneFigures<'_>| figures.build(tree).and_then(Row::build_ms);
            let ns = |(triangles, figures): &(u64, SceneFigures<'_>)| {
                summary(figures).and_then(|ms| Some(ms.median * 1e6 / *triangles as f64))
            };
            let error = |(_, figures): &(u64, SceneFigures<'_>)| {
                summary(figures).value().map_or(f64::INFINITY, |ms| ms.cautious_error())
            };
            let (ns, errors) = (by_size.iter().map(ns).collect(), by_size.iter().map(error).collect());
            Line { builder: tree.0.into(), ns, errors }
        };
        let lines = trees(&rows).into_iter().map(line);
        Self { lines: lines.collect(), sizes: by_size.iter().map(|size| size.0).collect(), threads }
    }

    /// How many times as long a triangle takes at the `index`-th size as at the first.
    pub fn relative(&self, line: &Line, index: usize) -> Place<f64> {
        let first = line.ns.first().and_then(|first| first.value());
        line.ns[index].and_then(|ns| Some(ns / first?))
    }

    /// The 95 % interval over rounds of what the target is for.
    fn interval(&self, builder: &str) -> Option<Interval> {
        let line = self.lines.iter().find(|line| line.builder == builder)?;
        let at = |size| {
            let index = self.sizes.iter().position(|other| *other == size)?;
            Some((line.ns[index].value()?, line.errors[index]))
        };
        let (from, to) = GROWTH_SIZES;
        let ((from, error_from), (to, error_to)) = at(from).zip(at(to))?;
        let (growth, error) = (to / from, error_from.hypot(error_to));
        Some(Interval { low: growth * (1.0 - error).max(0.0), high: growth * (1.0 + error) })
    }

    /// Whether a builder's growth is within the target; `None` for builders without one.
    fn verdict(&self, builder: &str) -> Option<Verdict> {
        GROWTH_BUILDERS.contains(&builder).then(|| {
            let within = |interval| Verdict::at_most(GROWTH, interval);
            self.interval(builder).map_or(Verdict::NotMeasured, within)
        })
    }
}

/// The size as in the scene's name.
pub fn size_name(triangles: u64) -> String {
    let name = scalable_name(triangles as usize);
    name.rsplit('-').next().unwrap_or_default().to_owned()
}

/// The table; empty without scenes of any size.
pub fn growth(rows: &[Row]) -> String {
    let growth = Growth::of(rows);
    let Some(&first) = growth.sizes.first() else { return String::new() };
    let header = ["builder".into(), format!("ns at {}", size_name(first))].into_iter();
    let sizes = growth.sizes.iter().skip(1).map(|&size| size_name(size));
    let mut grid = Grid::new(header.chain(sizes).chain(["95 %".into(), "target".into(), String::new()]));
    let lacking = GROWTH_BUILDERS.iter().filter(|name| growth.lines.iter().all(|l| l.builder != **name));
    let lacking = lacking.map(|name| Line {
        builder: (*name).into(),
        ns: growth.sizes.iter().map(|_| Place::Missing).collect(),
        errors: growth.sizes.iter().map(|_| f64::INFINITY).collect(),
    });
    for line in growth.lines.iter().cloned().chain(lacking) {
        let mut cells = vec![line.builder.clone(), line.ns[0].cell(short)];
        cells.extend((1..growth.sizes.len()).map(|i| growth.relative(&line, i).cell(|x| format!("{x:.3}"))));
        let known = growth.interval(&line.builder).filter(|interval| interval.high.is_finite());
        cells.push(known.map_or_else(|| "?".into(), |it| format!("[{:.2}, {:.2}]", it.low, it.high)));
        let verdict = growth.verdict(&line.builder);
        cells.push(verdict.as_ref().map_or_else(String::new, |_| format!("≤ {GROWTH:.2}")));
        cells.push(verdict.map_or_else(|| "-".into(), |verdict| verdict.cell()));
        grid.push(cells);
    }
    let (from, to) = GROWTH_SIZES;
    format!(
        "{}\nBuild time per triangle, 4-wide trees, {} threads: nanoseconds in the smallest scene, then relative to \
         that. The target is for {} relative to {}, with the whole 95 % interval over rounds, which stands beside it.\n",
        grid.markdown(),
        growth.threads,
        size_name(to),
        size_name(from)
    )
}
