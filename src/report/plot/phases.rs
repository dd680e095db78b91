//! The figure of phases: a bar per tree, stacked from the phases of its build; Embree's, which tells none, as a whole.

use super::chart::{INK, SMALL, sheet};
use super::key::in_lines;
use super::raster::text_width;
use super::svg::Anchor;
use super::ticks::linear_ticks;
use crate::bench::phases::PhaseRow;
use crate::bench::row::Row;
use crate::report::figures::{Figure, SceneFigures, Tree, Under, scenes, tree_name, trees};

const LINE: f64 = 26.0;
const BAR: f64 = 17.0;
const LENGTH: f64 = 620.0;
const TOP: f64 = 128.0;
/// How many times as long as the longest bar of phases another may be.
const BREAK: f64 = 1.5;

/// Phases in the order of a build, with their colours: neighbours differ in lightness, for those who tell no
/// colours apart.
const COLOURS: [(&str, &str); 11] = [
    ("bounds", "#000000"),
    ("presplit", "#f0e442"),
    ("codes", "#0072b2"),
    ("sort", "#56b4e9"),
    ("auxiliary tree", "#009e73"),
    ("clusters", "#cc79a7"),
    ("tree", "#882255"),
    ("cuts and nodes", "#e69f00"),
    ("nodes", "#7a4a00"),
    ("reinsertion", "#d55e00"),
    ("collapse", "#332288"),
];
const OTHER: &str = "#555555";
const WHOLE: &str = "#c9c9c9";

/// A bar: the phases of a tree's build, ns per triangle.
struct Bar<'a> {
    tree: Tree<'a>,
    parts: Vec<(String, f64)>,
    scenes: usize,
}

/// The figure; `None` unless the phases of some tree are known in every scene.
pub fn phases(rows: &[Row], phases: &[PhaseRow]) -> Option<String> {
    let all = scenes(rows);
    let mut bars: Vec<Bar<'_>> =
        trees(rows).into_iter().filter_map(|tree| Bar::of(tree, rows, phases, &all)).collect();
    // A mean over fewer scenes is another mean.
    bars.retain(|bar| bar.scenes == all.len());
    if !bars.iter().any(Bar::tells) {
        return None;
    }
    // Builds that tell no phases may take many times as long: their bars are broken off, lest the others' be hair
    // lines.
    let told = bars.iter().filter(|bar| bar.tells()).map(Bar::sum).fold(0.0, f64::max);
    let most = bars.iter().map(Bar::sum).fold(0.0, f64::max).min(BREAK * told);
    let left = 34.0 + bars.iter().map(|bar| text_width(&tree_name(bar.tree), SMALL)).fold(0.0, f64::max);
    let bottom = TOP + bars.len() as f64 * LINE;
    let threads = rows.iter().map(|row| row.threads).max().unwrap_or(0);
    let count = all.len();
    let noun = if count == 1 { "scene" } else { "scenes" };
    let mut widths: Vec<u32> = bars.iter().map(|bar| bar.tree.1).collect();
    widths.sort_unstable();
    widths.dedup();
    let widths: Vec<String> = widths.iter().map(|width| format!("{width}-wide")).collect();
    let about = format!(
        "fresh builds of {} trees, ns per triangle, arithmetic means of {count} {noun}, {threads} threads",
        widths.join(" and ")
    );
    let mut svg = sheet((left + LENGTH + 80.0, bottom + 62.0), "Phases of each build", &[&about]);
    let x = |ns: f64| left + LENGTH * ns / (1.04 * most);
    for (tick, text) in linear_ticks((0.0, 1.04 * most), 9) {
        svg.line(&[(x(tick), TOP - 6.0), (x(tick), bottom)], "#e6e6e6", 1.0, "");
        svg.text((x(tick), bottom + 18.0), Anchor::Middle, SMALL, INK, &text, "");
    }
    svg.text((left + 0.5 * LENGTH, bottom + 40.0), Anchor::Middle, SMALL, INK, "ns per triangle", "");
    for (line, bar) in bars.iter().enumerate() {
        let y = TOP + line as f64 * LINE;
        svg.text((left - 10.0, y + 0.75 * BAR), Anchor::End, SMALL, INK, &tree_name(bar.tree), "");
        let mut sum = 0.0;
        for (phase, ns) in &bar.parts {
            let end = (sum + ns).min(1.04 * most);
            svg.fill(
                (x(sum), y),
                (x(end) - x(sum), BAR),
                colour(phase),
                " stroke=\"#ffffff\" stroke-width=\"0.8\"",
            );
            sum += ns;
        }
        let end = x(sum.min(1.04 * most));
        if sum > 1.04 * most {
            for slit in [end - 22.0, end - 14.0] {
                svg.line(&[(slit - 3.0, y + BAR + 2.0), (slit + 3.0, y - 2.0)], "#ffffff", 3.0, "");
            }
        }
        svg.text((end + 6.0, y + 0.75 * BAR), Anchor::Start, SMALL, INK, &format!("{sum:.0}"), "");
    }
    let used = |phase: &str| bars.iter().any(|bar| bar.parts.iter().any(|(known, _)| known == phase));
    let mut entries: Vec<&str> =
        COLOURS.iter().map(|(phase, _)| *phase).filter(|phase| used(phase)).collect();
    let others = bars.iter().flat_map(|bar| &bar.parts).map(|(phase, _)| phase.as_str());
    for phase in others {
        if !entries.contains(&phase) {
            entries.push(phase);
        }
    }
    let name = |phase: &&str| {
        if phase.is_empty() { "whole build, phases not told".to_owned() } else { phase.to_string() }
    };
    let names: Vec<String> = entries.iter().map(name).collect();
    let widths = names.iter().map(|name| 40.0 + text_width(name, SMALL));
    let places = in_lines(widths, (26.0, 70.0), left + LENGTH + 60.0, 22.0);
    for ((phase, name), (x, y)) in entries.iter().zip(&names).zip(places) {
        svg.fill((x, y), (14.0, 14.0), colour(phase), "");
        svg.text((x + 20.0, y + 11.5), Anchor::Start, SMALL, INK, name, "");
    }
    Some(svg.finish())
}

fn colour(phase: &str) -> &'static str {
    if phase.is_empty() {
        return WHOLE;
    }
    COLOURS.iter().find(|(known, _)| *known == phase).map_or(OTHER, |(_, colour)| colour)
}

impl<'a> Bar<'a> {
    /// The means over the scenes in which the tree was built; its whole builds, without a name, where it tells no
    /// phases.
    fn of(tree: Tree<'a>, rows: &[Row], phases: &[PhaseRow], scenes: &[String]) -> Option<Self> {
        let mut parts: Vec<(String, f64)> = Vec::new();
        let mut built = 0;
        for scene in scenes {
            let figures = SceneFigures::of(rows, scene);
            let Some(whole) = figures.figure(tree, Figure::Build, &Under::Own).value() else { continue };
            let per_triangle = 1e6 / figures.triangles() as f64;
            built += 1;
            let mut add = |phase: &str, ms: f64| match parts.iter_mut().find(|(known, _)| known == phase) {
                Some((_, sum)) => *sum += ms * per_triangle,
                None => parts.push((phase.to_owned(), ms * per_triangle)),
            };
            let of_tree =
                phases.iter().filter(|row| row.scene == *scene && (row.builder.as_str(), row.width) == tree);
            let mut told = of_tree.peekable();
            if told.peek().is_none() {
                add("", whole.median);
            }
            told.for_each(|row| add(&row.phase, row.ms));
        }
        parts.iter_mut().for_each(|(_, sum)| *sum /= built as f64);
        (built > 0).then_some(Self { tree, parts, scenes: built })
    }

    /// Whether its builder tells phases.
    fn tells(&self) -> bool {
        self.parts.iter().any(|(phase, _)| !phase.is_empty())
    }

    fn sum(&self) -> f64 {
        self.parts.iter().map(|(_, ns)| ns).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_build_that_takes_many_times_as_long_is_broken_off() {
        let build =
            |builder: &str, ms| Row { triangles: 1_000_000, ..Row::by_hand(builder, 4, "phr", ms, 1.0) };
        let phase = |phase: &str, ms| PhaseRow {
            scene: "a".into(),
            builder: "lbvh".into(),
            width: 4,
            phase: phase.into(),
            ms,
            ..PhaseRow::default()
        };
        let told = [phase("codes", 4.0), phase("nodes", 6.0)];
        let svg = phases(&[build("lbvh", 10.0), build("embree-fast-spatial", 400.0)], &told).unwrap();
        let slits = |svg: &str| svg.matches("stroke=\"#ffffff\" stroke-width=\"3\"").count();
        assert!(svg.contains(">400<") && svg.contains("4-wide trees") && slits(&svg) == 2, "{svg}");
        let short = phases(&[build("lbvh", 10.0), build("embree-fast-spatial", 14.0)], &told).unwrap();
        assert_eq!(slits(&short), 0, "{short}");
        assert!(phases(&[build("lbvh", 10.0)], &[]).is_none());
    }
}
