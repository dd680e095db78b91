//! What our kernels are to reach, and what they reach in every scene.

use super::speed::{ALL, OURS, Speed};
use crate::bench::kernels::row::{KernelRow, PORTABLE, ROBUST, SINGLE, WATERTIGHT};
use crate::report::figures::interval::Interval;
use crate::report::means::Ratios;
use crate::report::targets::judge::{Verdict, of_each};
use std::collections::HashSet;

/// Our batches.
pub(super) const BATCH: &str = "phr-batch";
/// Whose trees all kernels trace.
const SAH: &str = "embree-sah";

/// A target: a speed of ours against one of another.
pub(super) struct Target {
    /// What the figure is of.
    pub what: &'static str,
    /// The builder and the kernel.
    pub ours: (&'static str, &'static str),
    /// Children per node, or the width at which we are fastest.
    pub width: Option<u32>,
    /// Kind of rays, or [`ALL`].
    pub kind: &'static str,
    /// The other.
    pub against: Against,
    /// The speed aimed at, in the geometric mean over scenes and in the worst scene.
    pub at_least: f64,
    /// See `at_least`.
    pub worst: Option<f64>,
}

/// What a speed is compared with: over the same tree but for the last.
#[derive(Clone, Copy)]
pub(super) enum Against {
    /// Embree's single rays.
    Single,
    /// The fastest of Embree's kernels.
    Fastest,
    /// Another kernel.
    Kernel(&'static str),
    /// Embree's single rays over the 8-wide tree of that builder of Embree's, which its users get.
    Tree(&'static str),
}

const fn single(what: &'static str, kind: &'static str, width: u32, at_least: f64) -> Target {
    let (ours, width, worst) = ((SAH, OURS), Some(width), Some(1.0));
    Target { what, ours, width, kind, against: Against::Single, at_least, worst }
}

const fn batch(what: &'static str, kind: &'static str, width: u32, at_least: f64) -> Target {
    let (ours, width) = ((SAH, BATCH), Some(width));
    Target { what, ours, width, kind, against: Against::Fastest, at_least, worst: None }
}

const fn kernel(
    what: &'static str,
    ours: &'static str,
    width: u32,
    against: &'static str,
    at_least: f64,
) -> Target {
    let (ours, width, against) = ((SAH, ours), Some(width), Against::Kernel(against));
    Target { what, ours, width, kind: ALL, against, at_least, worst: None }
}

const fn preset(builder: &'static str, against: &'static str, at_least: f64) -> Target {
    let (ours, against) = ((builder, OURS), Against::Tree(against));
    Target { what: "all rays, best width", ours, width: None, kind: ALL, against, at_least, worst: None }
}

/// Batches never lose more than that to single rays.
const fn batch_beside_single(what: &'static str, kind: &'static str, width: u32) -> Target {
    let (ours, width, against) = ((SAH, BATCH), Some(width), Against::Kernel(OURS));
    Target { what, ours, width, kind, against, at_least: 0.97, worst: Some(0.97) }
}

/// All of them, in the order of the report.
pub(super) const TARGETS: [Target; 23] = [
    single("closest hit of bounce rays", "bounce", 8, 1.2),
    single("any hit of shadow rays", "shadow", 8, 1.15),
    single("closest hit of bounce rays", "bounce", 4, 1.15),
    single("any hit of shadow rays", "shadow", 4, 1.1),
    preset("phr-speed", SAH, 1.15),
    preset("phr-quality", "embree-fast-spatial", 1.08),
    preset("phr-best", "embree-fast-spatial", 1.18),
    batch("batches of camera rays", "primary", 8, 1.0),
    batch("batches of bounce rays", "bounce", 8, 1.25),
    batch("batches of shadow rays", "shadow", 8, 1.25),
    batch("batches of camera rays", "primary", 4, 1.0),
    batch("batches of bounce rays", "bounce", 4, 1.25),
    batch("batches of shadow rays", "shadow", 4, 1.25),
    batch_beside_single("batches of camera rays", "primary", 8),
    batch_beside_single("batches of bounce rays", "bounce", 8),
    batch_beside_single("batches of shadow rays", "shadow", 8),
    batch_beside_single("batches of camera rays", "primary", 4),
    batch_beside_single("batches of bounce rays", "bounce", 4),
    batch_beside_single("batches of shadow rays", "shadow", 4),
    kernel("all rays, watertight", WATERTIGHT, 8, ROBUST, 1.0),
    kernel("all rays, watertight", WATERTIGHT, 4, ROBUST, 1.0),
    kernel("all rays, portable", PORTABLE, 8, OURS, 0.35),
    kernel("all rays, portable", PORTABLE, 4, OURS, 0.35),
];

impl Target {
    /// Whose tree and kernel the speed is compared with, as a cell.
    pub fn against(&self) -> String {
        match (self.against, self.kind) {
            (Against::Single, "shadow") => "rtcOccluded1".into(),
            (Against::Single, _) => "rtcIntersect1".into(),
            (Against::Fastest, _) => "Embree's fastest".into(),
            (Against::Kernel(kernel), _) => kernel.into(),
            (Against::Tree(builder), _) => format!("{builder} / 8"),
        }
    }

    /// The verdict on the mean in its interval and on every scene in its own, and how many scenes may be below the
    /// limit.
    pub fn verdict(&self, mean: Interval, scenes: &Ratios) -> (Verdict, usize) {
        let of_mean = Verdict::at_least(self.at_least, mean);
        let Some(limit) = self.worst else { return (of_mean, 0) };
        let (of_scenes, may_miss) = of_each(scenes, |interval| Verdict::at_least(limit, interval));
        (of_mean.and(of_scenes), may_miss)
    }

    /// Whether a row is of our kernel.
    fn has(&self, row: &KernelRow, threads: u32) -> bool {
        (row.builder.as_str(), row.kernel.as_str(), row.threads) == (self.ours.0, self.ours.1, threads)
            && self.width.is_none_or(|width| row.width == width)
            && (self.kind == ALL || row.ray_kind == self.kind)
    }
}

/// The first scene in which our kernel's hits are wrong.
pub(super) fn failed<'a>(rows: &'a [KernelRow], target: &Target, threads: u32) -> Option<&'a str> {
    let of_target = rows.iter().filter(|row| target.has(row, threads));
    of_target.filter(|row| !row.verified).map(|row| row.scene.as_str()).next()
}

/// Scenes that our kernel was measured in.
pub(super) fn scenes_of(rows: &[KernelRow], target: &Target, threads: u32) -> usize {
    let of_target = rows.iter().filter(|row| target.has(row, threads));
    of_target.map(|row| row.scene.as_str()).collect::<HashSet<_>>().len()
}

/// Our speed relative to the other by scene; without scenes where hits of one are wrong.
pub(super) fn ratios(rows: &[KernelRow], target: &Target, threads: u32) -> Ratios {
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    let ratio = |scene: &str| {
        let of_scene: Vec<&KernelRow> =
            rows.iter().filter(|row| row.scene == scene && row.threads == threads).collect();
        let speed = |builder, kernel, width| Speed::of(&of_scene, (builder, kernel, width), target.kind);
        let (builder, kernel) = target.ours;
        let widths = target.width.map_or(vec![4, 8], |width| vec![width]);
        let ours = |width: &u32| {
            let theirs = match target.against {
                Against::Single => speed(builder, SINGLE, *width),
                Against::Kernel(kernel) => speed(builder, kernel, *width),
                Against::Tree(builder) => speed(builder, SINGLE, 8),
                Against::Fastest => {
                    let all = of_scene.iter().map(|row| row.kernel.as_str());
                    let all = all.filter(|kernel| kernel.starts_with("embree-") && *kernel != ROBUST);
                    let speeds = all.filter_map(|kernel| speed(builder, kernel, *width));
                    speeds.max_by(|a, b| a.mrays_s.total_cmp(&b.mrays_s))
                }
            };
            Some(speed(builder, kernel, *width)?.relative_to(&theirs?, scene))
        };
        widths.iter().filter_map(ours).max_by(|a, b| a.value.total_cmp(&b.value))
    };
    Ratios(scenes.into_iter().filter_map(ratio).collect())
}
