//! The targets: what each builder is to reach, as data.

/// A quantity measured for a builder in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Warm build time relative to that of another builder.
    Build(&'static str),
    /// Time of all recorded rays relative to that over another builder's tree.
    Trace(&'static str),
    /// Bytes held at the peak of the build, per triangle.
    Peak,
    /// Bytes of the finished tree, per triangle.
    Tree,
    /// Warm build time with one thread relative to that with two.
    Threads,
}

/// The limits that a builder is to keep over all scenes; without limits, a line for comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The builder.
    pub builder: &'static str,
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

use Measure::{Build, Peak, Threads, Trace, Tree};
const MORTON: &str = "embree-morton";
const SAH: &str = "embree-sah";
const SPATIAL: &str = "embree-fast-spatial";

const fn mean(builder: &'static str, measure: Measure, mean: f64) -> Target {
    Target { builder, measure, mean: Some(mean), worst: None }
}

const fn both(builder: &'static str, measure: Measure, mean: f64, worst: f64) -> Target {
    Target { builder, measure, mean: Some(mean), worst: Some(worst) }
}

const fn worst(builder: &'static str, measure: Measure, worst: f64) -> Target {
    Target { builder, measure, mean: None, worst: Some(worst) }
}

const fn beside(builder: &'static str, measure: Measure) -> Target {
    Target { builder, measure, mean: None, worst: None }
}

/// All targets, in the order of the report.
pub const TARGETS: [Target; 30] = [
    mean("lbvh", Build(MORTON), 0.6),
    mean("lbvh", Trace(MORTON), 1.10),
    both("phr-fast", Build(SAH), 0.45, 0.7),
    mean("phr-fast", Trace(SAH), 1.09),
    mean("phr-hq", Build(SAH), 0.8),
    mean("phr-hq", Build(SPATIAL), 0.33),
    mean("phr-hq", Trace(SAH), 0.97),
    mean("phr-speed", Build(MORTON), 1.0),
    both("phr-speed", Trace(SAH), 1.0, 1.05),
    mean("phr-quality", Build(SAH), 0.8),
    both("phr-quality", Trace(SPATIAL), 1.0, 1.05),
    mean("phr-best", Build(SPATIAL), 0.6),
    both("phr-best", Trace(SPATIAL), 0.92, 1.0),
    worst("phr-speed", Peak, 110.0),
    beside(MORTON, Peak),
    beside(SAH, Peak),
    beside(SPATIAL, Peak),
    worst("phr-speed", Tree, 64.0),
    beside(MORTON, Tree),
    beside(SAH, Tree),
    beside(SPATIAL, Tree),
    mean("lbvh", Threads, 1.85),
    mean("phr-fast", Threads, 1.85),
    mean("phr-hq", Threads, 1.85),
    mean("phr-speed", Threads, 1.85),
    mean("phr-quality", Threads, 1.85),
    mean("phr-best", Threads, 1.85),
    beside(MORTON, Threads),
    beside(SAH, Threads),
    beside(SPATIAL, Threads),
];

/// Growth of the build time per triangle from the first to the last of [`GROWTH_SIZES`], at most.
pub const GROWTH: f64 = 1.25;
/// Builders with that target.
pub const GROWTH_BUILDERS: [&str; 2] = ["phr-fast", "phr-speed"];
/// Triangles between which growth is judged.
pub const GROWTH_SIZES: (u64, u64) = (1_000_000, 32_000_000);
