//! The figures of a scene and their ratios to Embree SAH at width 4, from the rows alone.

use crate::bench::contender::{Kernel, place};
use crate::bench::records::{COLD, Row, WARM};
use crate::bench::statistics::{Ratio, Summary};

/// What all figures are relative to.
pub const BASELINE: (&str, u32) = ("embree-sah", 4);

/// A tree of the table: builder and width.
pub type Tree = (String, u32);

/// The trees of `rows`, in the table's order.
pub fn trees(rows: &[Row]) -> Vec<Tree> {
    let mut trees: Vec<Tree> = rows.iter().map(|row| (row.builder.clone(), row.width)).collect();
    trees.sort_by(|a, b| (place(&a.0), a).cmp(&(place(&b.0), b)));
    trees.dedup();
    trees
}

/// Kernels with figures, in the table's order.
pub fn kernels(rows: &[Row]) -> Vec<Kernel> {
    let mut kernels: Vec<Kernel> = rows
        .iter()
        .filter(|row| row.is_good() && row.mrays_s.is_some())
        .filter_map(|row| Kernel::by_name(&row.kernel))
        .collect();
    kernels.sort_unstable();
    kernels.dedup();
    kernels
}

/// The figures of one scene.
pub struct SceneRows<'a>(pub Vec<&'a Row>);

impl<'a> SceneRows<'a> {
    /// Those of `scene`: rows that sum over views and kinds of rays.
    pub fn of(rows: &'a [Row], scene: &str) -> Self {
        Self(rows.iter().filter(|row| row.scene == scene && row.is_total()).collect())
    }

    /// A row that tells of a tree's warm builds; any of its rows does.
    pub fn build(&self, (builder, width): (&str, u32)) -> Option<&'a Row> {
        let of_tree = |row: &&&Row| row.builder == builder && row.width == width && row.regime == WARM;
        self.0.iter().filter(of_tree).find(|row| row.build_ms_median.is_some()).copied()
    }

    /// The row of a tree's cold builds.
    pub fn cold(&self, (builder, width): (&str, u32)) -> Option<&'a Row> {
        self.0.iter().find(|r| r.builder == builder && r.width == width && r.regime == COLD).copied()
    }

    /// The row of a tree under a kernel.
    pub fn trace(&self, (builder, width): (&str, u32), kernel: Kernel) -> Option<&'a Row> {
        let found = |row: &&&Row| {
            row.builder == builder && row.width == width && row.kernel == kernel.name() && row.is_good()
        };
        self.0.iter().find(found).copied()
    }

    /// Embree SAH under the same kernel, or under its own where it cannot be had under that.
    pub fn trace_baseline(&self, kernel: Kernel) -> Option<&'a Row> {
        self.trace(BASELINE, kernel).or_else(|| self.trace(BASELINE, Kernel::EmbreeNative))
    }

    /// Build time relative to Embree SAH.
    pub fn build_ratio(&self, tree: (&str, u32)) -> Option<Ratio> {
        Some(ratio(self.build(tree)?.build_ms()?, self.build(BASELINE)?.build_ms()?))
    }

    /// SAH cost relative to Embree SAH.
    pub fn sah_ratio(&self, tree: (&str, u32)) -> Option<f64> {
        Some(self.build(tree)?.sah? / self.build(BASELINE)?.sah?)
    }

    /// Trace time relative to Embree SAH.
    pub fn trace_ratio(&self, tree: (&str, u32), kernel: Kernel) -> Option<Ratio> {
        Some(ratio(self.trace(tree, kernel)?.trace_ms()?, self.trace_baseline(kernel)?.trace_ms()?))
    }
}

fn ratio(a: Summary, b: Summary) -> Ratio {
    Ratio::propagated(&a, &b)
}
