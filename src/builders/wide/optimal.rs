//! The cheapest wide tree over a binary one, by dynamic programming (Wald, Benthin, Boulos 2008; Ylitie, Karras, Laine
//! 2017): which subtrees become leaves, and how the children of each wide node are distributed over the subtrees below.

use crate::builders::api::config_error::{ConfigError, check};
use crate::bvh::limits::{BLOCK, MAX_LEAF, MAX_WIDTH};
use crate::geometry::ordered::smaller;
use crate::memory::huge_pages;
use crate::parallel::join;
use arrayvec::ArrayVec;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// What a wide tree costs, per area.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Those of Embree's kernel, roughly: it has to find out that a child is a leaf, which processors predict
    /// badly, and tests the blocks of one leaf in a row.
    pub const EMBREE: Self = Self { node: 1.0, leaf: 0.5, block: 0.35, max_leaf: 16 };

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let Self { node, leaf, block, max_leaf } = *self;
        for (field, cost) in [("node", node), ("leaf", leaf), ("block", block)] {
            check(field, cost, 0.0..=1e6)?;
        }
        check("max_leaf", max_leaf, BLOCK..=MAX_LEAF)
    }

    /// A leaf of `blocks` blocks.
    #[inline]
    fn of_leaf(&self, blocks: u32) -> f32 {
        self.leaf + self.block * blocks as f32
    }

    /// A leaf of at most a block.
    #[inline]
    fn block<const N: usize>(&self, area: f32, count: u32) -> Solved<N> {
        Solved { cost: [area * self.of_leaf(1); N], count }
    }

    /// A subtree of half area `area` over two others, and the choice for it.
    #[inline]
    fn over<const N: usize>(&self, area: f32, l: &Solved<N>, r: &Solved<N>) -> (Solved<N>, Choice) {
        let count = l.count + r.count;
        let shared = |slots: usize| {
            let of = |left: usize| (l.cost[left - 1] + r.cost[slots - left - 1], left);
            (2..slots).map(of).fold(of(1), |best, other| if other.0 < best.0 { other } else { best })
        };
        let leaf =
            if count <= self.max_leaf { area * self.of_leaf(count.div_ceil(BLOCK)) } else { f32::INFINITY };
        let all = shared(N);
        let inner = area * self.node + all.0;
        // Costs of huge scenes overflow to infinity: a node always is possible, a leaf is not.
        let is_leaf = leaf <= inner && leaf < f32::INFINITY;
        let mut choice = Choice::new(count, is_leaf);
        let mut cost = [smaller(leaf, inner); N];
        for slots in 2..N {
            let (shared, left) = shared(slots);
            let fewer = cost[slots - 2];
            cost[slots - 1] = smaller(shared, fewer);
            choice.set_left(slots, if shared < fewer { left } else { 0 });
        }
        choice.set_left(N, all.1);
        (Solved { cost, count }, choice)
    }
}

/// The least cost of a subtree as up to 1, 2, ... `N - 1` children of a wide node; the last place is not used.
#[derive(Clone, Copy)]
struct Solved<const N: usize> {
    cost: [f32; N],
    count: u32,
}

/// What was chosen for an inner node of the binary tree. From the lowest bit on: whether it is a leaf; of 2, 3, ...
/// children those on the left side; references below, as far as they have room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice(u32);

impl Choice {
    const LEAF: u32 = 1;
    /// Where the number of those on the left side begins, of `slots` children; at the index after the last, the count.
    const LEFT: [u32; MAX_WIDTH + 2] = {
        let mut shifts = [1; MAX_WIDTH + 2];
        let mut slots = 2;
        while slots <= MAX_WIDTH {
            shifts[slots + 1] = shifts[slots] + (slots as u32 - 1).ilog2() + 1;
            slots += 1;
        }
        shifts
    };
    const COUNT: u32 = Self::LEFT[MAX_WIDTH + 1];
    /// The largest count that is told; larger ones are told as this. No task is as large ([`super::parallel`]).
    pub const MOST: u32 = u32::MAX >> Self::COUNT;

    fn new(count: u32, is_leaf: bool) -> Self {
        Self(count.min(Self::MOST) << Self::COUNT | u32::from(is_leaf))
    }

    /// Of `slots` children, those on the left side; 0 if fewer children cost no more.
    #[inline(always)]
    fn set_left(&mut self, slots: usize, left: usize) {
        self.0 |= (left as u32) << Self::LEFT[slots];
    }

    /// References below, or 2^14 - 1 of more.
    pub fn count(self) -> u32 {
        self.0 >> Self::COUNT
    }

    /// To be a leaf rather than a wide node.
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// Of `slots` children, at least 2, those on the left side; 0 if fewer children cost no more.
    fn left(self, slots: usize) -> usize {
        let bits = Self::LEFT[slots + 1] - Self::LEFT[slots];
        (self.0 >> Self::LEFT[slots] & ((1 << bits) - 1)) as usize
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
    /// Chooses for a tree of `pairs` pairs below `root`, on all threads if `in_parallel`; returns the cost of the
    /// tree of nodes of up to `N` children.
    pub fn solve<S: CollapseSource, const N: usize>(
        &mut self,
        source: &S,
        root: S::At,
        pairs: usize,
        costs: &CollapseCosts,
        in_parallel: bool,
    ) -> f32 {
        if self.0.len() < pairs {
            huge_pages::reserve(&mut self.0, pairs, "choices of collapsing");
            self.0.resize_with(pairs, AtomicU32::default);
        }
        self.solve_below::<S, N>(source, root, costs, if in_parallel { PARALLEL_LEVELS } else { 0 }).cost[0]
    }

    fn solve_below<S: CollapseSource, const N: usize>(
        &self,
        source: &S,
        at: S::At,
        costs: &CollapseCosts,
        levels: u32,
    ) -> Solved<N> {
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
    pub fn open<S: CollapseSource, const N: usize>(
        &self,
        source: &S,
        at: S::At,
        slots: usize,
        children: &mut ArrayVec<S::At, N>,
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_round_trip() {
        let mut choice = Choice::new(77, true);
        for slots in 2..=MAX_WIDTH {
            choice.set_left(slots, slots - 1);
        }
        assert_eq!((choice.count(), choice.is_leaf()), (77, true));
        (2..=MAX_WIDTH).for_each(|slots| assert_eq!(choice.left(slots), slots - 1));
        let choice = Choice::new(u32::MAX, false);
        assert_eq!((choice.count(), choice.is_leaf(), choice.left(5)), ((1 << 14) - 1, false, 0));
    }
}
