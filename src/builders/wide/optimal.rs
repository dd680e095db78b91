//! The cheapest wide tree over a binary one, by dynamic programming (Wald, Benthin, Boulos 2008; Ylitie, Karras, Laine
//! 2017): which subtrees become leaves, and how the children of each wide node are distributed over the subtrees below.

use crate::bvh::limits::{BLOCK, WIDTH};
use arrayvec::ArrayVec;
use rayon::join;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// What a wide tree costs, per area.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CollapseCosts {
    /// A visit to a wide node.
    pub node: f32,
    /// A visit to a leaf of any size.
    pub leaf: f32,
    /// A test of a block of four triangles.
    pub block: f32,
    /// Most triangles of a leaf, 4 to 28.
    pub max_leaf: u32,
}

impl CollapseCosts {
    /// Those of Embree's kernel, roughly: it has to find out that a child is a leaf, which processors predict badly, and
    /// tests the blocks of one leaf in a row.
    pub const EMBREE: Self = Self { node: 1.0, leaf: 0.5, block: 0.35, max_leaf: 16 };

    /// A leaf of `blocks` blocks.
    #[inline]
    fn of_leaf(&self, blocks: u32) -> f32 {
        self.leaf + self.block * blocks as f32
    }

    /// A leaf of at most a block.
    #[inline]
    fn block(&self, area: f32, count: u32) -> Solved {
        Solved { cost: [area * self.of_leaf(1); WIDTH - 1], count }
    }

    /// A subtree of half area `area` over two others, and the choice for it.
    #[inline]
    fn over(&self, area: f32, l: &Solved, r: &Solved) -> (Solved, Choice) {
        let count = l.count + r.count;
        let shared = |slots: u32| {
            let of = |left: u32| (l.cost[left as usize - 1] + r.cost[(slots - left) as usize - 1], left);
            (2..slots).map(of).fold(of(1), |best, other| if other.0 < best.0 { other } else { best })
        };
        let [of2, of3, of4] = [2, 3, 4].map(shared);
        let leaf =
            if count <= self.max_leaf { area * self.of_leaf(count.div_ceil(BLOCK)) } else { f32::INFINITY };
        let inner = area * self.node + of4.0;
        // Costs of huge scenes overflow to infinity: a node always is possible, a leaf is not.
        let is_leaf = leaf <= inner && leaf < f32::INFINITY;
        let one = leaf.min(inner);
        let two = one.min(of2.0);
        let three = two.min(of3.0);
        let if_cheaper = |of: (f32, u32), fewer: f32| if of.0 < fewer { of.1 } else { 0 };
        let choice = Choice::new(count, is_leaf, [if_cheaper(of2, one), if_cheaper(of3, two), of4.1]);
        (Solved { cost: [one, two, three], count }, choice)
    }
}

/// Least costs of a subtree as up to 1, 2, 3 children of a wide node.
#[derive(Clone, Copy)]
struct Solved {
    cost: [f32; WIDTH - 1],
    count: u32,
}

/// What was chosen for an inner node of the binary tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice(u32);

impl Choice {
    const LEAF: u32 = 1;
    const COUNT_SHIFT: u32 = 6;
    const MOST: u32 = u32::MAX >> Self::COUNT_SHIFT;

    /// `left[k]`: of `k + 2` children those on the left side; 0 if fewer children cost no more.
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

    /// Of `slots` children, at least 2, those on the left side; 0 if fewer children cost no more.
    fn left(self, slots: usize) -> usize {
        let bits = match slots {
            2 => self.0 >> 1 & 1,
            3 => self.0 >> 2 & 3,
            _ => self.0 >> 4 & 3,
        };
        bits as usize
    }
}

/// A binary tree to be collapsed.
pub(crate) trait CollapseSource: Sync {
    /// Names a subtree.
    type At: Copy + Send + Sync;

    /// Half the surface area of a subtree's box.
    fn half_area(&self, at: Self::At) -> f32;

    /// The triangles of a leaf.
    fn count(&self, at: Self::At) -> u32;

    /// The index of a subtree's pair of children, and these; `None` for a leaf.
    fn pair(&self, at: Self::At) -> Option<(usize, [Self::At; 2])>;
}

/// Levels of the binary tree in which both children are solved in parallel.
const PARALLEL_LEVELS: u32 = 12;

/// A choice for the parent of each pair.
#[derive(Default)]
pub(crate) struct Choices(Vec<AtomicU32>);

impl Choices {
    /// Chooses for a tree of `pairs` pairs below `root`, on all threads if `in_parallel`; returns the wide tree's cost.
    pub fn solve<S: CollapseSource>(
        &mut self,
        source: &S,
        root: S::At,
        pairs: usize,
        costs: &CollapseCosts,
        in_parallel: bool,
    ) -> f32 {
        if self.0.len() < pairs {
            self.0.resize_with(pairs, AtomicU32::default);
        }
        self.solve_below(source, root, costs, if in_parallel { PARALLEL_LEVELS } else { 0 }).cost[0]
    }

    fn solve_below<S: CollapseSource>(
        &self,
        source: &S,
        at: S::At,
        costs: &CollapseCosts,
        levels: u32,
    ) -> Solved {
        let area = source.half_area(at);
        let Some((pair, [left, right])) = source.pair(at) else {
            return costs.block(area, source.count(at));
        };
        let solve = |at, levels| self.solve_below(source, at, costs, levels);
        let (left, right) = match levels.checked_sub(1) {
            Some(levels) => join(|| solve(left, levels), || solve(right, levels)),
            None => (solve(left, 0), solve(right, 0)),
        };
        let (solved, choice) = costs.over(area, &left, &right);
        self.0[pair].store(choice.0, Relaxed);
        solved
    }

    /// The choice for the parent of `pair`.
    pub fn of(&self, pair: usize) -> Choice {
        Choice(self.0[pair].load(Relaxed))
    }

    /// Opens a subtree into up to `slots` children.
    pub fn open<S: CollapseSource>(
        &self,
        source: &S,
        at: S::At,
        slots: usize,
        children: &mut ArrayVec<S::At, WIDTH>,
    ) {
        match source.pair(at) {
            Some((pair, [left, right])) if slots > 1 => match self.of(pair).left(slots) {
                0 => self.open(source, at, slots - 1, children),
                of_left => {
                    self.open(source, left, of_left, children);
                    self.open(source, right, slots - of_left, children);
                }
            },
            _ => children.push(at),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<AtomicU32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_round_trip() {
        let choice = Choice::new(77, true, [1, 2, 3]);
        assert_eq!((choice.count(), choice.is_leaf()), (77, true));
        assert_eq!([2, 3, 4].map(|slots| choice.left(slots)), [1, 2, 3]);
        assert_eq!(Choice::new(u32::MAX, false, [0, 0, 1]).count(), (1 << 26) - 1);
    }
}
