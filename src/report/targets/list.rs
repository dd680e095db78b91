//! The targets: what each builder is to reach, as data.

/// A quantity measured for a builder in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Build time relative to that of another builder of the same width.
    Build(&'static str),
    /// Time of all recorded rays relative to that over another builder's tree of the same width.
    Trace(&'static str),
    /// Bytes held at the peak of the build, relative to those of another builder of the same width.
    PeakTo(&'static str),
    /// Bytes held at the peak of the build, per triangle.
    Peak,
    /// Bytes of the finished tree, per triangle.
    Tree,
    /// Build time with one thread relative to that with two.
    Threads,
}

/// The limits that a builder is to keep over all scenes; without limits, a line for comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The builder.
    pub builder: &'static str,
    /// Children per node of its trees.
    pub width: u32,
    /// The measured quantity.
    pub measure: Measure,
    /// Limit of the mean over scenes.
    pub mean: Option<f64>,
    /// Limit in the worst scene.
    pub worst: Option<f64>,
}

/// Scenes of no more triangles do not count: their builds are too short.
pub const MORE_THAN: u64 = 100_000;
/// Nor for the peak of memory, where the part that does not grow with the scene would count.
pub const MORE_THAN_FOR_PEAK: u64 = 1_000_000;

use Measure::{Build, Peak, PeakTo, Threads, Trace, Tree};
const MORTON: &str = "embree-morton";
const SAH: &str = "embree-sah";
const SPATIAL: &str = "embree-fast-spatial";

/// A target of 4-wide trees.
const fn target(builder: &'static str, measure: Measure, mean: Option<f64>, worst: Option<f64>) -> Target {
    Target { builder, width: 4, measure, mean, worst }
}

const fn mean(builder: &'static str, measure: Measure, mean: f64) -> Target {
    target(builder, measure, Some(mean), None)
}

const fn both(builder: &'static str, measure: Measure, mean: f64, worst: f64) -> Target {
    target(builder, measure, Some(mean), Some(worst))
}

const fn beside(builder: &'static str, measure: Measure) -> Target {
    target(builder, measure, None, None)
}

/// Of the builders that are faithful to the paper, but for the sort of the auxiliary tree (32 bits, not 12); their
/// trees are 4-wide.
const PAPER: [Target; 5] = [
    mean("phr-fast", Build(SAH), 0.48),
    mean("phr-fast", Trace(SAH), 1.09),
    mean("phr-hq", Build(SAH), 0.8),
    mean("phr-hq", Build(SPATIAL), 0.33),
    mean("phr-hq", Trace(SAH), 0.97),
];

/// Of ours, at either width.
const TIMES: [Target; 12] = [
    both("lbvh", Build(MORTON), 0.6, 0.8),
    beside("lbvh", Trace(MORTON)),
    beside("phr-draft", Build(MORTON)),
    beside("phr-draft", Trace(MORTON)),
    both("phr-turbo", Build(MORTON), 1.0, 1.25),
    both("phr-turbo", Trace(SAH), 0.95, 1.15),
    both("phr-speed", Build(SAH), 0.4, 0.7),
    both("phr-speed", Trace(SAH), 0.86, 1.0),
    both("phr-quality", Build(SAH), 0.7, 1.0),
    both("phr-quality", Trace(SPATIAL), 0.98, 1.05),
    mean("phr-best", Build(SPATIAL), 0.5),
    both("phr-best", Trace(SPATIAL), 0.92, 1.0),
];

/// Memory, at either width.
const BYTES: [Target; 30] = [
    mean("lbvh", PeakTo(MORTON), 0.8),
    beside("phr-fast", PeakTo(MORTON)),
    beside("phr-hq", PeakTo(MORTON)),
    mean("phr-draft", PeakTo(MORTON), 0.8),
    mean("phr-turbo", PeakTo(MORTON), 0.8),
    mean("phr-speed", PeakTo(MORTON), 0.8),
    mean("phr-quality", PeakTo(MORTON), 0.8),
    mean("phr-best", PeakTo(MORTON), 0.8),
    beside("lbvh", Peak),
    beside("phr-fast", Peak),
    beside("phr-hq", Peak),
    beside("phr-draft", Peak),
    beside("phr-turbo", Peak),
    beside("phr-speed", Peak),
    beside("phr-quality", Peak),
    beside("phr-best", Peak),
    beside(MORTON, Peak),
    beside(SAH, Peak),
    beside(SPATIAL, Peak),
    beside("lbvh", Tree),
    beside("phr-fast", Tree),
    beside("phr-hq", Tree),
    beside("phr-draft", Tree),
    beside("phr-turbo", Tree),
    beside("phr-speed", Tree),
    beside("phr-quality", Tree),
    beside("phr-best", Tree),
    beside(MORTON, Tree),
    beside(SAH, Tree),
    beside(SPATIAL, Tree),
];

/// A second thread, of 4-wide trees.
const THREADS: [Target; 11] = [
    mean("lbvh", Threads, 1.85),
    mean("phr-fast", Threads, 1.85),
    mean("phr-hq", Threads, 1.85),
    mean("phr-draft", Threads, 1.85),
    mean("phr-turbo", Threads, 1.85),
    mean("phr-speed", Threads, 1.85),
    mean("phr-quality", Threads, 1.85),
    mean("phr-best", Threads, 1.85),
    beside(MORTON, Threads),
    beside(SAH, Threads),
    beside(SPATIAL, Threads),
];

/// All targets, in the order of the report.
pub fn targets() -> Vec<Target> {
    let eight = |target: &Target| Target { width: 8, ..*target };
    let mut all = PAPER.to_vec();
    all.extend(TIMES);
    all.extend(TIMES.iter().map(eight));
    all.extend(BYTES);
    all.extend(BYTES.iter().map(eight));
    all.extend(THREADS);
    all
}

/// Growth of the build time per triangle from the first to the last of [`GROWTH_SIZES`], at most.
pub const GROWTH: f64 = 1.25;
/// Builders with that target.
pub const GROWTH_BUILDERS: [&str; 2] = ["phr-fast", "phr-speed"];
/// Triangles between which growth is judged.
pub const GROWTH_SIZES: (u64, u64) = (1_000_000, 32_000_000);
/// Scenes in which a tree of Embree's may be on the front of build and trace time, at most.
pub const MOST_ON_FRONT: usize = 2;
