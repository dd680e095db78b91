//! Counters of visited nodes and leaf blocks, which cost nothing where they are off.

use std::ops::Add;

/// Nodes and leaf blocks that a batch of rays visited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TraversalCounts {
    /// Rays traced.
    pub rays: u64,
    /// Inner nodes whose children's boxes were tested, all rays together.
    pub node_visits: u64,
    /// Blocks of four triangles tested.
    pub block_tests: u64,
    /// Rays that hit something.
    pub hits: u64,
}

impl Add for TraversalCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            node_visits: self.node_visits + other.node_visits,
            block_tests: self.block_tests + other.block_tests,
            hits: self.hits + other.hits,
        }
    }
}

/// Counts visits, or does not: `()` leaves nothing in the compiled kernel.
pub(super) trait Counter {
    fn node(&mut self);
    fn block(&mut self);
}

impl Counter for () {
    #[inline(always)]
    fn node(&mut self) {}
    #[inline(always)]
    fn block(&mut self) {}
}

impl Counter for TraversalCounts {
    #[inline(always)]
    fn node(&mut self) {
        self.node_visits += 1;
    }
    #[inline(always)]
    fn block(&mut self) {
        self.block_tests += 1;
    }
}
