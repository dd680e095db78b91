//! Total time: one build and a number of rays, relative to the base's, and the tree that takes least.

use super::field::Field;
use crate::bench::statistics::geometric_mean;
use crate::report::figures::{Figure, SceneFigures, Tree, Under};

/// Powers of ten of rays between which totals are told: fewer hardly count beside a build, more hardly feel it.
const POWERS: (i32, i32) = (4, 10);

/// Numbers of rays, from least to most, `per_power` of them for each power of ten.
pub fn budgets(per_power: i32) -> Vec<f64> {
    let (least, most) = POWERS;
    (least * per_power..=most * per_power)
        .map(|step| 10f64.powf(f64::from(step) / f64::from(per_power)))
        .collect()
}

/// What a tree takes in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    build_ms: f64,
    ms_per_ray: f64,
}

impl Line {
    /// With builds in the regime of `build`.
    fn of(scene: &SceneFigures<'_>, tree: Tree<'_>, build: Figure, under: &Under) -> Option<Self> {
        let build_ms = scene.figure(tree, build, under).value()?.median;
        let row = scene.trace(tree, under.kernel_of(tree.0)).value()?;
        let ms_per_ray = row.trace_ms_median? / row.rays.filter(|&rays| rays > 0)? as f64;
        (build_ms > 0.0 && ms_per_ray > 0.0).then_some(Self { build_ms, ms_per_ray })
    }

    fn at(&self, rays: f64) -> f64 {
        self.build_ms + rays * self.ms_per_ray
    }
}

/// Total times of a tree and of the base, by scene.
pub struct Totals<'a> {
    /// The tree.
    pub tree: Tree<'a>,
    lines: Vec<[Line; 2]>,
}

impl Totals<'_> {
    /// Total time relative to the base's, geometric mean over scenes.
    pub fn at(&self, rays: f64) -> f64 {
        let ratios: Vec<f64> = self.lines.iter().map(|[own, base]| own.at(rays) / base.at(rays)).collect();
        geometric_mean(&ratios).unwrap_or(f64::NAN)
    }
}

/// The totals of the trees built that have them in as many scenes as the base, builds in the regime of `build`.
pub fn totals<'a>(field: &Field<'a>, build: Figure, under: &Under) -> Vec<Totals<'a>> {
    let lines = |tree| {
        let pair =
            |scene| Some([Line::of(scene, tree, build, under)?, Line::of(scene, field.base, build, under)?]);
        field.scenes.iter().filter_map(pair).collect::<Vec<_>>()
    };
    let of_base = lines(field.base).len();
    let of_trees = field.built().map(|tree| Totals { tree, lines: lines(tree) });
    of_trees.filter(|totals| !totals.lines.is_empty() && totals.lines.len() == of_base).collect()
}

/// A tree and the number of rays from which on it takes least time, until the next does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch<'a> {
    /// The tree.
    pub tree: Tree<'a>,
    /// Rays; 0 for the first.
    pub from: f64,
}

/// Which tree takes least time, by growing number of rays; crossings are found to a hundredth.
pub fn stretches<'a>(totals: &[Totals<'a>]) -> Vec<Stretch<'a>> {
    let least =
        |rays: f64| (0..totals.len()).min_by(|&i, &j| totals[i].at(rays).total_cmp(&totals[j].at(rays)));
    let mut found: Vec<Stretch<'a>> = Vec::new();
    let (mut before, mut last) = (0.0, None);
    // From a ray on: a quick build may be worth it for few.
    for rays in std::iter::once(1.0).chain(budgets(24)) {
        let best = least(rays);
        if let Some(best) = best.filter(|_| best != last) {
            let from = last.map_or(0.0, |last: usize| crossing(&totals[last], &totals[best], (before, rays)));
            found.push(Stretch { tree: totals[best].tree, from });
        }
        (before, last) = (rays, best);
    }
    found
}

/// Where `next` overtakes `last`, between two numbers of rays.
fn crossing(last: &Totals<'_>, next: &Totals<'_>, (mut low, mut high): (f64, f64)) -> f64 {
    while high > 1.01 * low {
        let middle = (low * high).sqrt();
        if next.at(middle) < last.at(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::row::Row;

    /// Build ms and ms for a million rays.
    fn row(scene: &str, builder: &str, build: f64, trace: f64) -> Row {
        Row { scene: scene.into(), rays: Some(1_000_000), ..Row::by_hand(builder, 4, "phr", build, trace) }
    }

    #[test]
    fn the_quick_build_wins_until_the_better_tree_has_paid() {
        // 10 + n = 30 + n / 2 at 40 million rays; the third is never best.
        let rows = [row("a", "lbvh", 10.0, 1.0), row("a", "phr-hq", 30.0, 0.5), row("a", "aac", 40.0, 0.9)];
        let field = Field::of(&rows).unwrap();
        assert_eq!(field.base, ("lbvh", 4));
        let totals = totals(&field, Figure::Build, &Under::One("phr".into()));
        assert_eq!(totals.len(), 3);
        assert!((totals.iter().find(|t| t.tree.0 == "phr-hq").unwrap().at(2e6) - 31.0 / 12.0).abs() < 1e-12);
        let found = stretches(&totals);
        assert_eq!(found.iter().map(|stretch| stretch.tree.0).collect::<Vec<_>>(), ["lbvh", "phr-hq"]);
        assert!(found[0].from == 0.0 && (found[1].from / 4e7 - 1.0).abs() < 0.02, "{found:?}");
    }

    #[test]
    fn few_rays_are_for_the_quick_build() {
        let rows = [row("a", "lbvh", 0.1, 100.0), row("a", "phr-hq", 0.5, 10.0)];
        let totals = totals(&Field::of(&rows).unwrap(), Figure::Build, &Under::One("phr".into()));
        let found = stretches(&totals);
        assert_eq!(found.iter().map(|stretch| stretch.tree.0).collect::<Vec<_>>(), ["lbvh", "phr-hq"]);
        assert!((found[1].from / 4444.0 - 1.0).abs() < 0.02, "{found:?}");
    }

    #[test]
    fn a_tree_that_lacks_a_scene_is_left_out() {
        let rows = [row("a", "lbvh", 10.0, 1.0), row("b", "lbvh", 10.0, 1.0), row("a", "phr-hq", 1.0, 0.1)];
        let totals = totals(&Field::of(&rows).unwrap(), Figure::Build, &Under::One("phr".into()));
        assert_eq!(totals.iter().map(|totals| totals.tree.0).collect::<Vec<_>>(), ["lbvh"]);
        assert!(stretches(&[]).is_empty());
    }

    #[test]
    fn a_saved_tree_has_no_build_to_pay_off() {
        let rows = [row("a", "lbvh", 10.0, 1.0), row("a", "saved:x", 1.0, 0.1)];
        let totals = totals(&Field::of(&rows).unwrap(), Figure::Build, &Under::One("phr".into()));
        assert_eq!(totals.iter().map(|totals| totals.tree.0).collect::<Vec<_>>(), ["lbvh"]);
    }
}
