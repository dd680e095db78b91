//! Leaves of anything: four numbers of primitives, which the caller's own test takes up.

use super::TriangleBlock;
use super::block::first_of;
use std::fmt::Debug;

/// Up to four primitives of a leaf, used lanes first.
pub trait LeafBlock: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// The primitives in use.
    fn ids(&self) -> impl Iterator<Item = u32> + '_;

    /// The lanes; unused ones hold `u32::MAX`.
    fn lanes(&self) -> [u32; 4];

    /// Whether an unused lane stands before a used one.
    fn is_gapped(&self) -> bool {
        !self.lanes().is_sorted_by_key(|&prim| prim == u32::MAX)
    }
}

impl LeafBlock for TriangleBlock {
    #[inline]
    fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        self.ids()
    }

    #[inline]
    fn lanes(&self) -> [u32; 4] {
        self.prims
    }
}

/// Four primitives by their numbers; unused lanes hold `u32::MAX`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(16))]
pub struct IdBlock {
    /// The numbers.
    pub prims: [u32; 4],
}

impl IdBlock {
    /// The first `count` of `prims`.
    #[inline]
    pub fn of_first(count: usize, prims: [u32; 4]) -> Self {
        Self { prims: first_of(count, prims) }
    }
}

impl LeafBlock for IdBlock {
    #[inline(always)]
    fn ids(&self) -> impl Iterator<Item = u32> + '_ {
        self.prims.iter().copied().take_while(|&prim| prim != u32::MAX)
    }

    #[inline(always)]
    fn lanes(&self) -> [u32; 4] {
        self.prims
    }
}
