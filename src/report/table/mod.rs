//! The table of a run as a Markdown document, made from the rows alone: Table 1 as in the paper, the means,
//! every scene in full, what the columns mean, errors and warnings.

pub mod brief;
pub mod details;
pub mod table1;

use super::figures::{BASELINE, Under, has_baseline, scenes};
use super::means::means;
use crate::bench::row::{NO_KERNEL, Row};
use crate::bench::warnings::Warning;
use details::kernels_are_mixed;
use table1::table1;

pub use details::scene;

/// The document, with the fairest choice of kernel.
pub fn document(rows: &[Row], complete: bool) -> String {
    document_under(rows, complete, &Under::best(rows))
}

/// The document, traces compared under `under`.
pub fn document_under(rows: &[Row], complete: bool, under: &Under) -> String {
    let mut text = heading(rows);
    if !complete {
        text += "**Part of a run: it was stopped before all rounds of all scenes were done.**\n\n";
    }
    let paper = table1(rows, under);
    if !paper.is_empty() {
        text += &(paper + "\n");
    }
    text += &means_of_scenes(rows, under);
    for scene in scenes(rows) {
        text += &(details::scene(rows, &scene) + "\n");
    }
    text + &legend(rows) + &remarks(rows)
}

/// What follows the scenes where these were told one by one: means, and what the columns mean.
pub fn closing(rows: &[Row]) -> String {
    means_of_scenes(rows, &Under::best(rows)) + &legend(rows)
}

fn means_of_scenes(rows: &[Row], under: &Under) -> String {
    if scenes(rows).len() > 1 { means(rows, under) + "\n" } else { String::new() }
}

/// The run: its time, revision and engines.
pub fn heading(rows: &[Row]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let mut engines: Vec<&str> =
        rows.iter().map(|row| row.engine.as_str()).filter(|e| !e.is_empty()).collect();
    engines.sort_unstable();
    engines.dedup();
    let (engines, id, utc, revision) = (engines.join(", "), &row.run_id, &row.utc, &row.git_rev);
    // Said first: every row of such a run is marked.
    let is_busy =
        rows.iter().all(|row| Warning::parse(&row.warnings).any(|found| found == Warning::Contended));
    let busy = if is_busy { ", on a busy machine" } else { "" };
    format!("# Run {id}{busy}\n\n{utc}, revision {revision}; {engines}\n\n")
}

/// How many rounds rows had, or from how many to how many.
pub fn rounds<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let (least, most) =
        rows.fold((u32::MAX, 0), |(least, most), row| (least.min(row.rounds), most.max(row.rounds)));
    if least >= most { most.to_string() } else { format!("{least} to {most}") }
}

/// The same with its noun: `1 round`, `3 to 5 rounds`.
pub fn counted_rounds(rounds: &str) -> String {
    format!("{rounds} round{}", if rounds == "1" { "" } else { "s" })
}

/// What the columns of the scenes' tables mean.
fn legend(rows: &[Row]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let rounds = counted_rounds(&rounds(rows.iter().filter(|row| row.error.is_empty())));
    let kernel = if kernels_are_mixed(rows, &scenes(rows)) {
        "under the same kernel, or where it was not traced under that, under Embree's: tree and kernel together"
    } else {
        "under the same kernel"
    };
    // Without it there is no such column.
    let relative = if has_baseline(rows) {
        let (base, width) = BASELINE;
        format!(
            " /SAH: relative to {base} at width {width}, {kernel}; ± half the 95 % interval (±?: of too few rounds, or too far apart)."
        )
    } else {
        String::new()
    };
    format!(
        "Medians of {rounds}, {} threads on each side.{relative} rebuild: ms where all memory is reused. first: ms of \
         the first build of a new builder or device. cost: SAH cost. \
         All recorded rays of all views: native, Embree's kernel on its own tree; grafted, Embree's kernel on \
         any tree, all laid out alike; phr, our kernel.\n",
        row.threads
    )
}

/// The defects that rows have, each with how many rows have it, of how many.
pub fn warned(rows: &[Row]) -> Vec<(Warning, usize, usize)> {
    let totals: Vec<&Row> = rows.iter().filter(|row| row.is_total()).collect();
    let has = |row: &&&Row, warning| Warning::parse(&row.warnings).any(|found| found == warning);
    let count = |warning| totals.iter().filter(|row| has(row, warning)).count();
    let counted = Warning::ALL.into_iter().map(|warning| (warning, count(warning), totals.len()));
    counted.filter(|(_, count, _)| *count > 0).collect()
}

/// Errors and warnings, each with advice.
pub fn remarks(rows: &[Row]) -> String {
    let mut text = String::new();
    for row in rows.iter().filter(|row| !row.error.is_empty()) {
        let kernel = if row.kernel == NO_KERNEL { String::new() } else { format!(" under {}", row.kernel) };
        let kind = if row.verified == Some(false) { "WRONG HITS" } else { "no figures" };
        text += &format!("\n{kind}: {} {}/{}{kernel}: {}", row.scene, row.builder, row.width, row.error);
    }
    for (warning, count, of) in warned(rows) {
        text += &format!("\n{}: {count} of {of} rows; {}", warning.name(), warning.advice());
    }
    if text.is_empty() { text } else { text + "\n" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{NATIVE, PHR, trees};

    fn row(scene: &str, builder: &str, width: u32, kernel: &str, build: f64, trace: f64) -> Row {
        Row {
            scene: scene.into(),
            triangles: 1_234_567,
            sah: Some(build),
            rays: Some(1000),
            mrays_s: Some(1.0 / trace),
            ..Row::by_hand(builder, width, kernel, build, trace)
        }
    }

    fn rows() -> Vec<Row> {
        vec![
            row("a", "embree-sah", 4, NATIVE, 10.0, 20.0),
            row("a", "phr-hq", 4, PHR, 20.0, 10.0),
            row("b", "phr-hq", 4, PHR, 5.0, 40.0),
            row("b", "embree-sah", 4, NATIVE, 10.0, 20.0),
        ]
    }

    #[test]
    fn ratios_are_to_embree_sah() {
        let text = scene(&rows(), "a");
        assert!(text.starts_with("## a: 1 234 567 triangles, 1 000 rays\n"), "{text}");
        let line = text.lines().find(|line| line.contains("phr-hq / 4")).unwrap();
        assert!(line.contains("2.00 ±0.00") && line.contains("0.50 ±0.00"), "{text}");
    }

    #[test]
    fn means_stand_beside_the_papers_and_name_the_worst() {
        let text = means(&rows(), &Under::Own);
        let lines: Vec<Vec<&str>> = text
            .lines()
            .filter(|line| line.contains("phr-hq"))
            .map(|line| line.split('|').map(str::trim).collect())
            .collect();
        // Builds 2 and 0.5, costs alike, traces 0.5 and 2: of two scenes so far apart a mean tells nothing.
        let interval = "[0.002, 575.174]";
        assert_eq!(
            &lines[0][2..10],
            ["1.250", "1.821", "1.000", interval, "1.636", "2.00", "a", "2"],
            "{text}"
        );
        assert_eq!(
            &lines[2][2..10],
            ["1.250", "0.977", "1.000", interval, "0.975", "2.00", "b", "2"],
            "{text}"
        );
    }

    #[test]
    fn without_embree_there_are_figures_but_no_ratios() {
        let only: Vec<Row> = rows().into_iter().filter(|row| row.builder == "phr-hq").collect();
        let text = document(&only, true);
        assert!(text.contains("phr-hq / 4") && !text.contains("±0"), "{text}");
        assert!(text.contains("## Table 1") && !text.contains("/SAH"), "{text}");
        assert!(document(&rows(), true).contains(" /SAH: relative to embree-sah at width 4"));
    }

    #[test]
    fn a_table_without_rows_is_left_out() {
        let wide = [Row { width: 8, rounds: 1, ..row("a", "phr-hq", 4, PHR, 20.0, 10.0) }];
        let text = document(&wide, true);
        assert!(text.contains("phr-hq / 8") && !text.contains("Table 1"), "{text}");
        assert!(text.contains("Medians of 1 round, 2 threads on each side. rebuild: "), "{text}");
    }

    #[test]
    fn errors_and_warnings_are_told() {
        let mut rows = rows();
        rows[1] =
            Row { verified: Some(false), mrays_s: None, error: "ray 3 differs".into(), ..rows[1].clone() };
        rows[2].warnings = "HighSpread".into();
        let text = document(&rows, true);
        assert!(text.contains("WRONG HITS: a phr-hq/4 under phr: ray 3 differs"), "{text}");
        assert!(text.contains("HighSpread: 1 of 4 rows"), "{text}");
    }

    #[test]
    fn the_table_is_in_the_papers_order() {
        let rows = rows();
        let order: Vec<&str> = trees(&rows).into_iter().map(|tree| tree.0).collect();
        assert_eq!(order, ["embree-sah", "phr-hq"]);
    }
}
