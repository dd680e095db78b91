//! The trees of a run side by side: scenes, trees, and the tree that all are relative to.

use crate::bench::cell::is_saved;
use crate::bench::row::Row;
use crate::report::figures::{BASELINE, Figure, SceneFigures, Tree, Under, trees};
use crate::report::means::Ratios;

/// A run's scenes and trees.
pub struct Field<'a> {
    /// The figures of every scene, in the order of the rows.
    pub scenes: Vec<SceneFigures<'a>>,
    /// The trees, in the table's order.
    pub trees: Vec<Tree<'a>>,
    /// What the others are relative to: Embree SAH at width 4, or the first tree with a build time where that has none;
    /// a saved tree only where there are no others.
    pub base: Tree<'a>,
}

impl<'a> Field<'a> {
    /// The field of `rows`; `None` where they are none.
    pub fn of(rows: &'a [Row]) -> Option<Self> {
        let trees = trees(rows);
        let scenes = SceneFigures::all(rows);
        let is_built = |tree| scenes.iter().any(|scene| scene.build(tree).value().is_some());
        let mut built = trees.iter().copied().filter(|&tree| !is_saved(tree.0) && is_built(tree));
        let base = if is_built(BASELINE) { Some(BASELINE) } else { built.next() };
        let base = base.or(trees.first().copied())?;
        Some(Self { scenes, trees, base })
    }

    /// The trees that were built. Saved ones were loaded: they compete with no builder.
    pub fn built(&self) -> impl Iterator<Item = Tree<'a>> {
        self.trees.iter().copied().filter(|tree| !is_saved(tree.0))
    }

    /// The ratios of a tree to the base.
    pub fn ratios(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Ratios {
        Ratios::among(&self.scenes, self.base, tree, figure, under)
    }

    /// The ratios of a tree that has them in as many scenes as the base: a mean over fewer is another mean.
    pub fn whole_ratios(&self, tree: Tree<'_>, figure: Figure, under: &Under) -> Option<Ratios> {
        let ratios = self.ratios(tree, figure, under);
        let of_base = self.ratios(self.base, figure, under).0.len();
        (ratios.0.len() == of_base && of_base > 0).then_some(ratios)
    }

    /// The trees built whose mean relative to that of `best` has an interval that reaches down to 1, the nearest first:
    /// none of them is told apart from it. `None` where no interval is known.
    pub fn rivals(&self, best: Tree<'_>, figure: Figure, under: &Under) -> Option<Vec<Tree<'a>>> {
        let to_best = |tree| {
            let ratios = Ratios::among(&self.scenes, best, tree, figure, under);
            Some((tree, ratios.geometric()?, ratios.interval(ratios.over())?))
        };
        let others = self.built().filter(|&tree| tree != best);
        let others = others.filter(|&tree| self.whole_ratios(tree, figure, under).is_some());
        let mut others: Vec<_> = others.filter_map(to_best).collect();
        if !others.is_empty() && others.iter().all(|(_, _, interval)| interval.high.is_infinite()) {
            return None;
        }
        others.retain(|(_, _, interval)| interval.low <= 1.0);
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        Some(others.into_iter().map(|(tree, _, _)| tree).collect())
    }

    /// The tree built of the least mean, with that.
    pub fn least(&self, figure: Figure, under: &Under) -> Option<(Tree<'a>, f64)> {
        let mean = |tree: Tree<'a>| Some((tree, self.whole_ratios(tree, figure, under)?.geometric()?));
        self.built().filter_map(mean).min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_base_is_a_tree_that_was_built() {
        let failed = Row {
            build_ms_median: None,
            error: "out of memory".into(),
            ..Row::by_hand("embree-sah", 4, "phr", 1.0, 1.0)
        };
        let rows = [failed, Row::by_hand("phr-hq", 4, "phr", 1.0, 1.0)];
        assert_eq!(Field::of(&rows).unwrap().base, ("phr-hq", 4));
        assert_eq!(Field::of(&rows[..1]).unwrap().base, BASELINE);
        let saved = Row::by_hand("saved:a", 4, "phr", 0.1, 1.0);
        assert_eq!(Field::of(&[rows[0].clone(), saved.clone()]).unwrap().base, BASELINE);
        assert_eq!(Field::of(&[saved]).unwrap().base, ("saved:a", 4));
    }
}
