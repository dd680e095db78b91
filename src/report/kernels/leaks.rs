//! The table of leaks.

use crate::bench::kernels::leaks::LeakRow;
use crate::report::grid::Grid;
use crate::report::targets::judge::Verdict;

/// Rays at vertices and edges together that the watertight kernel has to keep.
const AIMED_AT: u64 = 100_000_000;

/// The rays that got out, by kernel and target; the watertight kernel's are judged.
pub fn leaks_table(rows: &[LeakRow]) -> String {
    let mut grid = Grid::new(["kernel", "width", "aimed at", "rays", "leaks", "share", "target", ""]);
    for row in rows {
        let share = 100.0 * row.leaks as f64 / row.rays.max(1) as f64;
        let same = |other: &&LeakRow| (other.width, &other.kernel) == (row.width, &row.kernel);
        let of_tree: u64 = rows.iter().filter(same).map(|row| row.rays).sum();
        let verdict = match (row.leaks, of_tree) {
            (0, AIMED_AT..) => Verdict::Met,
            (0, _) => Verdict::Undecided,
            _ => Verdict::NotMet,
        };
        let is_judged = row.is_watertight();
        grid.push(vec![
            row.kernel.clone(),
            row.width.to_string(),
            row.target.clone(),
            row.rays.to_string(),
            row.leaks.to_string(),
            if row.leaks == 0 { String::new() } else { format!("{share:.2} %") },
            if is_judged { "none".into() } else { String::new() },
            if is_judged { verdict.cell() } else { "-".into() },
        ]);
    }
    let about = rows.first().map_or_else(String::new, |row| {
        let LeakRow { utc, git_rev, cpu, triangles, scene, builder, .. } = row;
        let isas = |ours: bool| rows.iter().find(|row| row.kernel.starts_with("phr") == ours);
        let isa = |ours: bool| isas(ours).map_or("-", |row| &row.isa);
        format!(
            "\nRays from within a {scene} of {triangles} triangles, over the trees of {builder}: each that hits nothing leaks. The \
             target is for {AIMED_AT} rays over a tree. {utc}, revision {git_rev}, {cpu}; our kernels {}, Embree's {}.\n",
            isa(true),
            isa(false)
        )
    });
    grid.markdown() + &about
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::kernels::row::WATERTIGHT;

    #[test]
    fn few_rays_prove_nothing_and_one_leak_does() {
        let row = |kernel: &str, width, rays, leaks| LeakRow {
            kernel: kernel.into(),
            width,
            rays,
            leaks,
            ..LeakRow::default()
        };
        let rows = [
            row(WATERTIGHT, 4, AIMED_AT / 2, 0),
            row(WATERTIGHT, 4, AIMED_AT / 2, 0),
            row(WATERTIGHT, 8, AIMED_AT / 2, 0),
            row(WATERTIGHT, 16, AIMED_AT, 1),
            row("phr", 4, 1000, 50),
        ];
        let text = leaks_table(&rows);
        let verdicts: Vec<&str> =
            text.lines().skip(2).take(5).filter_map(|line| line.rsplit('|').map(str::trim).nth(1)).collect();
        assert_eq!(verdicts, ["met", "met", "undecided", "not met", "-"], "{text}");
        assert!(text.contains("5.00 %"), "{text}");
    }
}
