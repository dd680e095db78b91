//! Tables of kernels: each scene in full, and the targets over scenes.

mod leaks;
mod speed;
mod targets;

pub use leaks::leaks_table;

use super::grid::{Grid, short};
use crate::bench::kernels::row::KernelRow;
use crate::report::means::beside_mean;
use crate::report::targets::judge::Verdict;
use targets::{TARGETS, failed, ratios, scenes_of};

/// The figures of one scene: million rays per second, and relative to Embree's single rays over the same tree.
pub fn scene_table(rows: &[KernelRow], scene: &str) -> String {
    let rows: Vec<&KernelRow> = rows.iter().filter(|row| row.scene == scene).collect();
    let kinds = ["primary", "bounce", "shadow"];
    let mut grid = Grid::new([scene, "width", "threads", "kernel", kinds[0], kinds[1], kinds[2]]);
    let mut seen = Vec::new();
    for row in &rows {
        let key = (&row.builder, row.width, row.threads, &row.kernel);
        if seen.contains(&key) {
            continue;
        }
        seen.push(key);
        let figure = |kind: &str| {
            let same = |other: &&&KernelRow| {
                other.ray_kind == kind && (&other.builder, other.width, other.threads, &other.kernel) == key
            };
            rows.iter().find(same).map_or_else(String::new, |row| {
                let ratio = row.ratio.map_or_else(String::new, |ratio| format!(" ({ratio:.2})"));
                let wrong = if row.verified { "" } else { " WRONG" };
                format!("{}{ratio}{wrong}", short(row.mrays_s))
            })
        };
        let mut cells =
            vec![row.builder.clone(), row.width.to_string(), row.threads.to_string(), row.kernel.clone()];
        cells.extend(kinds.map(figure));
        grid.push(cells);
    }
    grid.markdown()
}

/// The targets over all scenes: geometric mean with its 95 % interval, the worst scene, the verdict.
pub fn summary(rows: &[KernelRow]) -> String {
    let mut threads: Vec<u32> = rows.iter().map(|row| row.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let header = [
        "tree", "what", "width", "threads", "against", "at least", "mean", "95 %", "limit", "may miss",
        "worst", "in", "scenes", "verdict",
    ];
    let mut grid = Grid::new(header);
    for target in &TARGETS {
        for &threads in &threads {
            let ratios = ratios(rows, target, threads);
            let (Some(mean), Some(least)) = (ratios.geometric(), ratios.least()) else { continue };
            let Some(interval) = ratios.interval(ratios.over()) else { continue };
            let [worst, worst_in] = beside_mean(least, ratios.0.len(), mean, 2);
            let (has, of) = (ratios.0.len(), scenes_of(rows, target, threads));
            let (verdict, may_miss) = target.verdict(interval, &ratios);
            grid.push(vec![
                target.ours.0.into(),
                target.what.into(),
                target.width.map_or_else(String::new, |width| width.to_string()),
                threads.to_string(),
                target.against(),
                format!("{:.2}", target.at_least),
                format!("{mean:.2}"),
                interval.shown(2),
                target.worst.map_or_else(String::new, |limit| format!("{limit:.2}")),
                target.worst.map_or_else(String::new, |_| may_miss.to_string()),
                worst,
                worst_in,
                if has == of { has.to_string() } else { format!("{has} of {of}") },
                match failed(rows, target, threads) {
                    Some(scene) => Verdict::Failed(scene.into()).cell(),
                    // The scenes that are missing may be the slow ones.
                    None if has < of => verdict.and(Verdict::Undecided).cell(),
                    None => verdict.cell(),
                },
            ]);
        }
    }
    let about = rows.first().map_or_else(String::new, |row| {
        let isa = |ours: bool| rows.iter().find(|row| row.is_ours() == ours).map_or("-", |row| &row.isa);
        let unverified = rows.iter().filter(|row| !row.verified).count();
        let verified = if unverified == 0 {
            "all hits verified".to_owned()
        } else {
            format!("{unverified} rows of wrong hits")
        };
        format!(
            "\n{}, revision {}, {}; our kernels {}, Embree's {}; {verified}.\n",
            row.utc,
            row.git_rev,
            row.cpu,
            isa(true),
            isa(false)
        )
    });
    if grid.is_empty() {
        return about;
    }
    format!("{}\n{LEGEND}\n{about}", grid.markdown())
}

const LEGEND: &str = "mean: geometric, over scenes; 95 %: its interval over scenes and passes, paired within a round. worst: the least of all scenes, \
    with its own 95 % interval over passes; not told apart: from the mean, which that interval holds. met: the whole interval of the mean, \
    and where it has a limit that of every scene, is beyond what is aimed at, and no scene lacks; not met: one is wholly below; else \
    undecided. may miss: scenes whose intervals reach below the limit, or are below it.";

/// For a page: the targets, with every scene folded away.
pub fn page(rows: &[KernelRow]) -> String {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let each: String = scenes.iter().map(|scene| scene_table(rows, scene) + "\n").collect();
    let legend = "Million rays per second, in brackets relative to Embree's single rays over the same tree.";
    format!("{}\n<details><summary>Every scene</summary>\n\n{legend}\n\n{each}</details>\n", summary(rows))
}

#[cfg(test)]
mod tests {
    use super::speed::OURS;
    use super::targets::BATCH;
    use super::*;
    use crate::bench::kernels::row::SINGLE;

    fn row(scene: &str, kernel: &str, mrays_s: f64) -> KernelRow {
        let text = |text: &str| text.to_owned();
        KernelRow {
            scene: text(scene),
            builder: text("embree-sah"),
            width: 8,
            threads: 1,
            kernel: text(kernel),
            ray_kind: text("shadow"),
            rays: 1000,
            mrays_s,
            ratio: Some(mrays_s / 2.0),
            pass_ms: [1, 1, 1].map(|pass| (f64::from(pass) / mrays_s).to_string()).join(" "),
            verified: true,
            ..KernelRow::default()
        }
    }

    #[test]
    fn batches_are_judged_by_the_fastest_of_the_same_scene() {
        let rows: Vec<KernelRow> = ["a", "b"]
            .iter()
            .flat_map(|scene| {
                [
                    row(scene, SINGLE, 2.0),
                    row(scene, "embree-stream", 4.0),
                    row(scene, OURS, 2.5),
                    row(scene, BATCH, 6.0),
                ]
            })
            .chain([row("c", BATCH, 1.0)])
            .collect();
        let summary = summary(&rows);
        let line = |what: &str| summary.lines().find(|line| line.contains(what)).unwrap().replace(' ', "");
        assert!(
            line("batches of shadow rays")
                .contains("|1.25|1.50|[1.50,1.50]|||1.50[1.50,1.50]|a,nottoldapart|2of3|undecided|"),
            "{summary}"
        );
        assert!(
            line("any hit of shadow")
                .contains("|1.15|1.25|[1.25,1.25]|1.00|0|1.25[1.25,1.25]|a,nottoldapart|2|met|"),
            "{summary}"
        );
        assert!(!summary.contains("bounce") && summary.contains("all hits verified"), "{summary}");
        let beside =
            |line: &&str| line.contains("shadow") && line.contains(" phr |") && line.contains("0.97");
        assert!(summary.lines().any(|line| beside(&line) && line.contains("2.40")), "{summary}");
    }

    #[test]
    fn wrong_hits_meet_no_target() {
        let rows = ["a", "b"].iter().flat_map(|scene| {
            [row(scene, SINGLE, 2.0), KernelRow { verified: *scene == "b", ..row(scene, OURS, 6.0) }]
        });
        let summary = summary(&rows.collect::<Vec<_>>());
        let line = summary.lines().find(|line| line.contains("any hit of shadow")).unwrap().replace(' ', "");
        assert!(line.contains("|b|1of2|notmet:failedina|"), "{summary}");
    }

    #[test]
    fn a_worst_scene_in_noise_decides_nothing() {
        let noisy = |scene: &str, kernel: &str, speed: f64, passes: &str| KernelRow {
            pass_ms: passes.into(),
            ..row(scene, kernel, speed)
        };
        let rows: Vec<KernelRow> = ["a", "b", "c"]
            .iter()
            .flat_map(|scene| [noisy(scene, SINGLE, 2.0, "1 1 1"), noisy(scene, OURS, 2.6, "0.77 0.77 0.77")])
            .chain([noisy("d", SINGLE, 2.0, "1 1 1"), noisy("d", OURS, 1.9, "1.05 0.7 1.3")])
            .collect();
        let line = |text: &str| text.lines().find(|line| line.contains("any hit of")).unwrap().to_owned();
        let told = line(&summary(&rows));
        assert!(told.contains("d, not told apart") && told.contains("undecided"), "{told}");
        let sure = rows
            .into_iter()
            .map(|row| KernelRow { pass_ms: row.pass_ms.replace("0.7 1.3", "1.05 1.05"), ..row });
        let told = line(&summary(&sure.collect::<Vec<_>>()));
        assert!(told.contains(" d |") && told.contains("not met"), "{told}");
    }

    #[test]
    fn presets_are_judged_at_their_best_width_over_all_rays() {
        let of = |builder: &str, width, kind: &str, kernel: &str, speed| KernelRow {
            builder: builder.into(),
            width,
            ray_kind: kind.into(),
            ..row("a", kernel, speed)
        };
        // As many rays of either kind: 2 / (1 / 2 + 1 / 6) = 3 against 2 / (1 / 1 + 1 / 3) = 1.5.
        let rows = [
            of("embree-sah", 8, "bounce", SINGLE, 1.0),
            of("embree-sah", 8, "shadow", SINGLE, 3.0),
            of("phr-speed", 4, "bounce", OURS, 1.0),
            of("phr-speed", 4, "shadow", OURS, 1.0),
            of("phr-speed", 8, "bounce", OURS, 2.0),
            of("phr-speed", 8, "shadow", OURS, 6.0),
        ];
        let summary = summary(&rows);
        let line = summary.lines().find(|line| line.contains("phr-speed")).unwrap().replace(' ', "");
        assert!(line.contains("|embree-sah/8|1.15|2.00|[2.00,2.00]|2.00[2.00,2.00]|a|1|met|"), "{summary}");
    }

    #[test]
    fn a_scene_is_shown_with_its_ratios_and_its_faults() {
        let wrong = KernelRow { verified: false, ..row("a", OURS, 3.0) };
        let table = scene_table(&[row("a", SINGLE, 2.0), wrong, row("b", OURS, 9.0)], "a");
        assert!(table.contains("2.00 (1.00)") && table.contains("3.00 (1.50) WRONG"), "{table}");
        assert!(!table.contains("9.00"), "{table}");
    }
}
