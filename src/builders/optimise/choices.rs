//! The cheapest wide tree that a binary one collapses to, by dynamic programming (Wald, Benthin, Boulos 2008;
//! Ylitie, Karras, Laine 2017): which subtrees become leaves, and how the children of each wide node are shared
//! out among the subtrees below.

use super::tree::{ROOT, Tree};
use crate::builders::wide::top_down::{QUARTET, WIDTH};
use crate::bvh::MAX_LEAF_BLOCKS;
use rayon::join;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// What a wide tree costs, per area.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Costs {
    /// A visit to a wide node.
    pub node: f32,
    /// A visit to a leaf, however large it is.
    pub leaf: f32,
    /// A test of a block of four triangles.
    pub block: f32,
    /// Most triangles of a leaf, up to 28.
    pub max_leaf: u32,
}

impl Costs {
    /// Those of Embree's kernel, roughly: it has to find out that a child is a leaf, which processors foresee badly, and
    /// tests the blocks of one leaf in a row.
    pub const EMBREE: Self = Self { node: 1.0, leaf: 0.5, block: 0.35, max_leaf: 16 };

    /// The same with leaves that a link can tell of.
    pub(crate) fn possible(self) -> Self {
        Self { max_leaf: self.max_leaf.min(QUARTET * MAX_LEAF_BLOCKS as u32), ..self }
    }

    /// A leaf of so many blocks.
    #[inline]
    fn of_leaf(&self, blocks: u32) -> f32 {
        self.leaf + self.block * blocks as f32
    }

    /// A leaf of at most a block.
    #[inline]
    pub(crate) fn block(&self, area: f32, count: u32) -> Solved {
        Solved { cost: [area * self.of_leaf(1); WIDTH - 1], count }
    }

    /// A subtree of half area `area` over two others, and what to choose for it.
    #[inline]
    pub(crate) fn over(&self, area: f32, l: &Solved, r: &Solved) -> (Solved, Choice) {
        let count = l.count + r.count;
        let shared = |slots: u32| {
            let of = |left: u32| (l.cost[left as usize - 1] + r.cost[(slots - left) as usize - 1], left);
            (2..slots).map(of).fold(of(1), |best, other| if other.0 < best.0 { other } else { best })
        };
        let [of2, of3, of4] = [2, 3, 4].map(shared);
        let leaf =
            if count <= self.max_leaf { area * self.of_leaf(count.div_ceil(QUARTET)) } else { f32::INFINITY };
        let inner = area * self.node + of4.0;
        let is_leaf = leaf <= inner;
        let one = leaf.min(inner);
        let two = one.min(of2.0);
        let three = two.min(of3.0);
        let if_cheaper = |of: (f32, u32), fewer: f32| if of.0 < fewer { of.1 } else { 0 };
        let choice = Choice::new(count, is_leaf, [if_cheaper(of2, one), if_cheaper(of3, two), of4.1]);
        (Solved { cost: [one, two, three], count }, choice)
    }
}

/// Levels of the binary tree in which both children are solved in parallel.
const PARALLEL_LEVELS: u32 = 12;

/// What was chosen for an inner node of the binary tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice(u32);

impl Choice {
    /// Of a place where nothing was chosen.
    pub const NONE: Self = Self(0);
    const LEAF: u32 = 1;
    const COUNT_SHIFT: u32 = 6;
    const MOST: u32 = u32::MAX >> Self::COUNT_SHIFT;

    /// `left[k]`: of `k + 2` children those on the left side; 0 if fewer children are no dearer.
    fn new(count: u32, is_leaf: bool, left: [u32; WIDTH - 1]) -> Self {
        let [of2, of3, of4] = left;
        Self(count.min(Self::MOST) << Self::COUNT_SHIFT | u32::from(is_leaf) | of2 << 1 | of3 << 2 | of4 << 4)
    }

    /// References below, at most 2^26 - 1.
    pub fn count(self) -> u32 {
        self.0 >> Self::COUNT_SHIFT
    }

    /// To be a leaf rather than a wide node.
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// Of `slots` children, at least 2, those on the left side; 0 if fewer children are no dearer.
    pub fn left(self, slots: usize) -> usize {
        let bits = match slots {
            2 => self.0 >> 1 & 1,
            3 => self.0 >> 2 & 3,
            _ => self.0 >> 4 & 3,
        };
        bits as usize
    }
}

/// A choice for each pair's parent.
#[derive(Default)]
pub(crate) struct Choices(Vec<AtomicU32>);

impl Choices {
    /// Chooses for all of `tree`; returns the wide tree's cost.
    pub fn make(&mut self, tree: &Tree, costs: Costs) -> f32 {
        if self.0.len() < tree.pairs.len() {
            self.0.resize_with(tree.pairs.len(), AtomicU32::default);
        }
        Solver { tree, choices: &self.0, costs: costs.possible() }.solve(ROOT, 0).cost[0]
    }

    /// The choice for the parent of `pair`.
    pub fn of(&self, pair: usize) -> Choice {
        Choice(self.0[pair].load(Relaxed))
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<AtomicU32>()
    }
}

/// Least costs of a subtree as up to 1, 2, 3 children of a wide node.
#[derive(Clone, Copy)]
pub(crate) struct Solved {
    cost: [f32; WIDTH - 1],
    count: u32,
}

struct Solver<'a> {
    tree: &'a Tree,
    choices: &'a [AtomicU32],
    costs: Costs,
}

impl Solver<'_> {
    fn solve(&self, index: u32, level: u32) -> Solved {
        let node = self.tree.node(index);
        let area = node.half_area();
        let Some(pair) = node.pair() else { return self.costs.block(area, node.count()) };
        let left = 2 * pair as u32;
        let (l, r) = if level < PARALLEL_LEVELS {
            join(|| self.solve(left, level + 1), || self.solve(left + 1, level + 1))
        } else {
            (self.solve(left, level + 1), self.solve(left + 1, level + 1))
        };
        let (solved, choice) = self.costs.over(area, &l, &r);
        self.choices[pair].store(choice.0, Relaxed);
        solved
    }
}

#[cfg(test)]
mod tests {
    use super::super::emit::Collapse;
    use super::super::samples::{drawn, soup};
    use super::*;
    use crate::bvh::{Bvh4, Child, Link};

    const COSTS: Costs = Costs { node: 1.0, leaf: 0.3, block: 0.7, max_leaf: 8 };

    /// The least cost of node `index` as at most `slots` children, by trying everything.
    fn least(tree: &Tree, index: u32, slots: usize) -> (f32, u32) {
        let node = tree.node(index);
        let Some(pair) = node.pair() else { return (node.half_area() * COSTS.of_leaf(1), node.count()) };
        let [l, r] = [2 * pair as u32, 2 * pair as u32 + 1];
        let count = least(tree, l, 1).1 + least(tree, r, 1).1;
        let opened = |slots: usize| {
            (1..slots)
                .map(|left| least(tree, l, left).0 + least(tree, r, slots - left).0)
                .fold(f32::MAX, f32::min)
        };
        let leaf = if count <= COSTS.max_leaf { COSTS.of_leaf(count.div_ceil(4)) } else { f32::INFINITY };
        let closed = (node.half_area() * leaf).min(node.half_area() * COSTS.node + opened(WIDTH));
        ((2..=slots).map(opened).fold(closed, f32::min), count)
    }

    fn cost_of(tree: &Bvh4, link: Link, area: f32) -> f32 {
        match link.get() {
            Child::Empty => 0.0,
            Child::Leaf { count, .. } => area * COSTS.of_leaf(count as u32),
            Child::Inner(index) => {
                let below = tree.nodes[index].children().map(|(b, link)| cost_of(tree, link, b.half_area()));
                area * COSTS.node + below.sum::<f32>()
            }
        }
    }

    #[test]
    fn no_other_choice_is_cheaper_and_the_tree_costs_what_was_promised() {
        for triangles in [5, 9, 13, 21, 30, 60] {
            let mesh = soup(triangles);
            let (tree, mut choices) = (drawn(&mesh), Choices::default());
            let promised = choices.make(&tree, COSTS);
            let expected = least(&tree, ROOT, 1).0;
            assert!((promised - expected).abs() <= 1e-5 * expected, "{promised} for {expected}");
            let wide = Collapse { tree: &tree, choices: &choices }.emit(&mesh, &mut Default::default());
            assert_eq!(wide.validate(&mesh), Ok(()));
            let cost = cost_of(&wide, wide.root, wide.bounds.half_area());
            assert!((cost - expected).abs() <= 1e-5 * expected, "{cost} for {expected}");
        }
    }

    #[test]
    fn choices_round_trip() {
        let choice = Choice::new(77, true, [1, 2, 3]);
        assert_eq!((choice.count(), choice.is_leaf()), (77, true));
        assert_eq!([2, 3, 4].map(|slots| choice.left(slots)), [1, 2, 3]);
        assert_eq!(Choice::new(u32::MAX, false, [0, 0, 1]).count(), (1 << 26) - 1);
    }
}
