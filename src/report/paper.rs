//! The paper's own Table 1 (Hendrich, Meister, Bittner 2017), as printed, to stand beside ours.

use super::figures::{BASELINE, Figure};
use crate::scene::PaperScene;
use serde::Deserialize;

/// One cell of the paper's table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct PaperRow {
    /// Scene, as the paper writes it.
    pub scene: String,
    /// Triangles, thousands.
    pub kilotriangles: u64,
    /// Builder, as the paper writes it.
    pub builder: String,
    /// Build time with 16 threads, ms.
    pub build_ms: f64,
    /// SAH cost.
    pub sah_cost: f64,
    /// Time of a frame of the path tracer, mean of three views, ms.
    pub frame_ms: f64,
    /// Million rays per second.
    pub trace_mrays_s: f64,
}

impl PaperRow {
    /// A figure, if the table has it. Its only trace time is that of frames.
    fn figure(&self, figure: Figure) -> Option<f64> {
        match figure {
            Figure::Build => Some(self.build_ms),
            Figure::Cost => Some(self.sah_cost),
            Figure::Frame | Figure::Trace => Some(self.frame_ms),
            Figure::BuildCpu
            | Figure::BuildInstructions
            | Figure::First
            | Figure::Overlap
            | Figure::Rebuild
            | Figure::Steps => None,
        }
    }
}

/// Our names of the paper's methods.
const NAMES: [(&str, &str); 8] = [
    ("embree-morton", "Embree Morton"),
    ("hunt-50", "Hunt-50"),
    ("aac", "AAC"),
    ("embree-sah", "Embree SAH"),
    ("hunt-500", "Hunt-500"),
    ("embree-fast-spatial", "Embree Fast-Spatial"),
    ("phr-fast", "PHR-Fast"),
    ("phr-hq", "PHR-HQ"),
];

/// All cells, in the paper's order.
pub fn rows() -> Vec<PaperRow> {
    let text = include_str!("../../results/paper/table1.csv");
    csv::Reader::from_reader(text.as_bytes()).deserialize().filter_map(Result::ok).collect()
}

/// Builders that the paper has, by our names.
pub fn builders() -> impl Iterator<Item = &'static str> {
    NAMES.iter().map(|(ours, _)| *ours)
}

/// A figure of `builder` relative to Embree SAH, by scene; empty if the paper lacks the builder.
pub fn ratios(builder: &str, figure: Figure) -> Vec<(String, f64)> {
    let scene = |(row, ratio): (PaperRow, f64)| (row.scene, ratio);
    ratios_to(BASELINE.0, builder, figure).into_iter().map(scene).collect()
}

/// A figure of `builder` relative to that of `base`, with the builder's row, by scene; empty if the paper lacks either.
pub fn ratios_to(base: &str, builder: &str, figure: Figure) -> Vec<(PaperRow, f64)> {
    let name = |wanted: &str| NAMES.iter().find(|(ours, _)| *ours == wanted).map(|(_, name)| *name);
    let (Some(name), Some(base)) = (name(builder), name(base)) else { return Vec::new() };
    let rows = rows();
    let of_base = |scene: &str| rows.iter().find(|row| row.builder == base && row.scene == scene);
    let own = rows.iter().filter(|row| row.builder == name);
    own.filter_map(|row| Some((row.clone(), row.figure(figure)? / of_base(&row.scene)?.figure(figure)?)))
        .collect()
}

/// The paper's scene for which a scene of ours stands: the original under one of its usual names, or its
/// stand-in.
pub fn scene_of(name: &str) -> Option<String> {
    let lower = name.to_ascii_lowercase();
    let is_it = |scene: &&PaperScene| scene.stand_in == lower || scene.file_names.contains(&lower.as_str());
    let found = crate::scene::paper().iter().find(is_it)?;
    // The table prints "Powerplant", the text "Power Plant".
    let plain = |text: &str| text.replace(' ', "").to_ascii_lowercase();
    rows().into_iter().map(|row| row.scene).find(|scene| plain(scene) == plain(found.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::statistics::{arithmetic_mean, geometric_mean};

    #[test]
    fn the_table_is_whole() {
        let rows = rows();
        assert_eq!(rows.len(), 9 * 8);
        for builder in builders() {
            assert_eq!(ratios(builder, Figure::Build).len(), 9, "{builder}");
        }
        assert!(ratios("lbvh", Figure::Build).is_empty());
        assert!(ratios_to("lbvh", "phr-hq", Figure::Build).is_empty());
        let (conference, ratio) = &ratios_to("phr-fast", "phr-hq", Figure::Build)[0];
        assert_eq!((&*conference.scene, *ratio), ("Conference", 39.0 / 23.0));
    }

    /// Figure 6 shows PHR-HQ at 1.82 and 0.98, Embree Morton at 0.63 and 1.41.
    #[test]
    fn means_are_those_of_figure_6() {
        let mean = |builder, figure| {
            let values: Vec<f64> = ratios(builder, figure).into_iter().map(|r| r.1).collect();
            (arithmetic_mean(&values).unwrap(), geometric_mean(&values).unwrap())
        };
        let near = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() < 5e-4 && (b - d).abs() < 5e-4;
        assert!(near(mean("phr-hq", Figure::Build), (1.821, 1.636)));
        assert!(near(mean("phr-hq", Figure::Trace), (0.977, 0.975)));
        assert!(near(mean("embree-morton", Figure::Build), (0.627, 0.623)));
        assert!(near(mean("embree-morton", Figure::Trace), (1.413, 1.400)));
        assert!(near(mean("embree-sah", Figure::Cost), (1.0, 1.0)));
    }

    #[test]
    fn all_nine_are_known_and_no_others() {
        for scene in crate::scene::paper() {
            assert!(scene_of(scene.stand_in).is_some(), "{}", scene.stand_in);
            assert!(scene.file_names.iter().all(|name| scene_of(name).is_some()), "{}", scene.name);
        }
        assert_eq!(scene_of("Happy_Vrip").as_deref(), Some("Happy Buddha"));
        assert_eq!(scene_of("powerplant-like").as_deref(), Some("Powerplant"));
        assert_eq!(["hall", "sanmiguel_partial", "hair", ""].map(scene_of), [None, None, None, None]);
    }
}
