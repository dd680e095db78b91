//! Tables of scaling: how much faster builds are on more workers, and what keeps them.

use crate::bench::scaling::row::{ALL, ScalingRow};
use crate::bench::statistics::geometric_mean;
use crate::report::grid::{Grid, short};

/// The figures of one scene: milliseconds by the number of workers.
pub fn scene_table(rows: &[ScalingRow], scene: &str) -> String {
    let rows: Vec<&ScalingRow> = rows.iter().filter(|row| row.scene == scene && row.phase == ALL).collect();
    let workers = numbers(rows.iter().copied());
    let header = workers.iter().map(|workers| format!("{workers} workers"));
    let mut grid = Grid::new([scene.to_owned(), "width".to_owned()].into_iter().chain(header));
    for (builder, width) in trees(rows.iter().copied()) {
        let of = |workers: u32| {
            let row =
                rows.iter().find(|row| (&*row.builder, row.width, row.workers) == (builder, width, workers));
            row.map_or_else(String::new, |row| {
                let measured = row.measured_ms.map_or_else(String::new, |ms| format!(" ({})", short(ms)));
                short(row.scheduled_ms) + &measured
            })
        };
        let cells = [builder.to_owned(), width.to_string()];
        grid.push(cells.into_iter().chain(workers.iter().map(|&workers| of(workers))).collect());
    }
    grid.markdown()
}

/// How many times faster than one thread or worker, geometric means over scenes, and the phase that takes most of
/// the time of most workers.
pub fn means(rows: &[ScalingRow]) -> String {
    let workers = numbers(rows.iter());
    let (Some(first), Some(&most)) = (rows.first(), workers.last()) else { return String::new() };
    let header = workers.iter().skip(1).flat_map(|&workers| {
        let measured = rows.iter().any(|row| row.workers == workers && row.measured_ms.is_some());
        [measured.then(|| format!("{workers} threads")), Some(format!("{workers} workers"))]
            .into_iter()
            .flatten()
    });
    let header: Vec<String> = header.collect();
    let limits = [format!("longest phase of {most}"), "its share".to_owned()];
    let names = ["builder", "width"].map(str::to_owned);
    let mut grid = Grid::new(names.into_iter().chain(header.iter().cloned()).chain(limits));
    for (builder, width) in trees(rows.iter()) {
        let of_tree: Vec<&ScalingRow> =
            rows.iter().filter(|row| row.builder == builder && row.width == width).collect();
        let mut cells = vec![builder.to_owned(), width.to_string()];
        for column in &header {
            let (number, kind) = column.split_once(' ').unwrap_or_default();
            let workers = number.parse().unwrap_or(1);
            let ratios =
                if kind == "threads" { measured(&of_tree, workers) } else { scheduled(&of_tree, workers) };
            cells.push(geometric_mean(&ratios).map_or_else(String::new, |mean| format!("{mean:.2}")));
        }
        if let Some((phase, share)) = longest(&of_tree, most) {
            cells.extend([phase.to_owned(), format!("{:.0} %", 100.0 * share)]);
        }
        grid.push(cells);
    }
    let mut scenes: Vec<&str> = rows.iter().map(|row| &*row.scene).collect();
    scenes.dedup();
    format!(
        "{}\n{}, revision {}, {}; {} scenes, medians of {} builds. workers: how many times as \
         long all tasks take as their schedule, of the same builds; threads: how many times faster builds were measured than on \
         one.\n",
        grid.markdown(),
        first.utc,
        first.git_rev,
        first.cpu,
        scenes.len(),
        first.rounds
    )
}

/// For a page: the means, with every scene folded away.
pub fn page(rows: &[ScalingRow]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut scenes: Vec<&str> = rows.iter().map(|row| &*row.scene).collect();
    scenes.dedup();
    let each: String = scenes.iter().map(|scene| scene_table(rows, scene) + "\n").collect();
    format!(
        "{}\n<details><summary>Every scene</summary>\n\nMilliseconds of the schedule, in brackets measured on as many \
        threads.\n\n{each}</details>\n",
        means(rows)
    )
}

/// Numbers of workers, ascending.
pub fn numbers<'a>(rows: impl Iterator<Item = &'a ScalingRow>) -> Vec<u32> {
    let mut workers: Vec<u32> = rows.map(|row| row.workers).collect();
    workers.sort_unstable();
    workers.dedup();
    workers
}

/// Builders and widths in the order of the rows.
pub fn trees<'a>(rows: impl Iterator<Item = &'a ScalingRow>) -> Vec<(&'a str, u32)> {
    let mut trees = Vec::new();
    for row in rows {
        if !trees.contains(&(&*row.builder, row.width)) {
            trees.push((&*row.builder, row.width));
        }
    }
    trees
}

/// Of each scene, the work of all tasks by their schedule on `workers`: both are of the same builds, so that none
/// is faster than `workers` times.
pub fn scheduled(rows: &[&ScalingRow], workers: u32) -> Vec<f64> {
    let whole =
        rows.iter().filter(|row| row.phase == ALL && row.workers == workers && row.scheduled_ms > 0.0);
    whole.map(|row| row.work_ms / row.scheduled_ms).collect()
}

/// Of each scene, the time measured on the least threads by that on `threads`.
pub fn measured(rows: &[&ScalingRow], threads: u32) -> Vec<f64> {
    let whole = || rows.iter().filter(|row| row.phase == ALL);
    let least = rows.iter().map(|row| row.workers).min().unwrap_or(1);
    let ratio = |row: &&ScalingRow| {
        let alone = whole().find(|other| other.scene == row.scene && other.workers == least)?;
        Some(alone.measured_ms? / row.measured_ms?)
    };
    whole().filter(|row| row.workers == threads).filter_map(ratio).collect()
}

/// The phase whose schedule on `workers` takes the largest share of the whole, in the mean of scenes, and that share.
fn longest<'a>(rows: &[&'a ScalingRow], workers: u32) -> Option<(&'a str, f64)> {
    let (whole, phases): (Vec<&ScalingRow>, Vec<&ScalingRow>) =
        rows.iter().filter(|row| row.workers == workers).partition(|row| row.phase == ALL);
    let mut shares: Vec<(&str, f64)> = Vec::new();
    for row in phases {
        let all = whole.iter().find(|all| all.scene == row.scene)?;
        let share = row.scheduled_ms / all.scheduled_ms;
        match shares.iter_mut().find(|(phase, _)| *phase == row.phase) {
            Some((_, sum)) => *sum += share,
            None => shares.push((&row.phase, share)),
        }
    }
    let longest = shares.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    longest.map(|(phase, sum)| (phase, sum / whole.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(workers: u32, phase: &str, scheduled_ms: f64, measured_ms: Option<f64>) -> ScalingRow {
        ScalingRow {
            scene: "a".into(),
            builder: "lbvh".into(),
            width: 4,
            workers,
            phase: phase.into(),
            work_ms: 7.5,
            scheduled_ms,
            measured_ms,
            ..ScalingRow::default()
        }
    }

    #[test]
    fn speedups_and_what_limits_them() {
        let rows = [
            row(1, ALL, 8.0, Some(9.0)),
            row(2, ALL, 5.0, Some(6.0)),
            row(16, ALL, 2.0, None),
            row(16, "sort", 1.5, None),
            row(16, "tree", 0.5, None),
        ];
        let page = page(&rows);
        let line = page.lines().find(|line| line.starts_with("| lbvh")).unwrap().replace(' ', "");
        assert_eq!(line, "|lbvh|4|1.50|1.50|3.75|sort|75%|", "{page}");
        let scene = scene_table(&rows, "a");
        assert!(scene.contains("8.00 (9.00)") && scene.contains("2.00 |"), "{scene}");
    }
}
