//! References to children, packed into 32 bits.

use super::limits::{MAX_BLOCKS, MAX_LEAF_BLOCKS};

/// A packed reference to a child: an inner node, a leaf of 1 to 7 consecutive blocks, or nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Link(u32);

/// A [`Link`], unpacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// An unused slot.
    Empty,
    /// Index into [`super::WideBvh::nodes`].
    Inner(usize),
    /// Consecutive blocks of [`super::WideBvh::blocks`].
    Leaf {
        /// First block.
        first: usize,
        /// Number of blocks, 1 to [`MAX_LEAF_BLOCKS`].
        count: usize,
    },
}

impl Link {
    /// Bit that tells a leaf (or nothing) from an inner node.
    pub const LEAF_BIT: u32 = 1 << 31;
    const COUNT_SHIFT: u32 = MAX_BLOCKS.trailing_zeros();
    const INDEX_MASK: u32 = MAX_BLOCKS as u32 - 1;

    /// Of a link that has its place; there are never as many nodes.
    const PLACED: u32 = 1 << 30;
    /// Of such a link to a leaf, in place of [`Link::LEAF_BIT`].
    const PLACED_LEAF: u32 = 1 << 29;

    /// The unused slot.
    pub const EMPTY: Self = Self(u32::MAX);

    /// Refers to inner node `index`.
    ///
    /// # Panics
    /// If `index` is 2^30 or more: no tree has as many nodes.
    #[inline]
    pub fn inner(index: usize) -> Self {
        assert!(index < Self::PLACED as usize, "node {index} of a tree of less than 2^30");
        Self::of_node(index)
    }

    /// Refers to `count` blocks from `first`.
    ///
    /// # Panics
    /// If `count` is not 1 to [`MAX_LEAF_BLOCKS`], or `first` is 2^28 or more: no tree has as many blocks.
    #[inline]
    pub fn leaf(first: usize, count: usize) -> Self {
        assert!(
            (1..=MAX_LEAF_BLOCKS).contains(&count),
            "a leaf of {count} blocks, not 1 to {MAX_LEAF_BLOCKS}"
        );
        assert!(first < MAX_BLOCKS, "block {first} of a tree of less than 2^28");
        Self::of_blocks(first, count)
    }

    /// As [`Link::inner`], of builders, whose trees are within the limits.
    #[inline]
    pub(crate) fn of_node(index: usize) -> Self {
        debug_assert!(index < Self::PLACED as usize);
        Self(index as u32)
    }

    /// As [`Link::leaf`], likewise.
    #[inline]
    pub(crate) fn of_blocks(first: usize, count: usize) -> Self {
        debug_assert!((1..=MAX_LEAF_BLOCKS).contains(&count) && first < MAX_BLOCKS);
        Self(Self::LEAF_BIT | ((count as u32 - 1) << Self::COUNT_SHIFT) | first as u32)
    }

    /// The packed bits: below [`Link::LEAF_BIT`] an inner node's index.
    #[inline]
    pub fn bits(self) -> u32 {
        self.0
    }

    /// The link packed in `bits`, as [`Link::bits`] gave them.
    #[inline]
    pub fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// True for an unused slot.
    #[inline]
    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    /// True for an inner node.
    #[inline]
    pub fn is_inner(self) -> bool {
        self.0 & Self::LEAF_BIT == 0
    }

    /// The same reference, of an inner node or of a leaf of one block, where it stays: [`Link::moved`] makes it a link
    /// like others, to the same place. Nothing else may be asked of it before.
    #[inline]
    #[must_use]
    pub(crate) fn placed(self) -> Self {
        debug_assert!(self.is_inner() || matches!(self.get(), Child::Leaf { count: 1, .. }));
        let leaf = if self.is_inner() { 0 } else { Self::PLACED_LEAF };
        Self(self.0 & !Self::LEAF_BIT | Self::PLACED | leaf)
    }

    /// The same reference after its node moved `nodes` or its blocks `blocks` places up.
    #[inline]
    #[must_use]
    pub fn moved(self, nodes: usize, blocks: usize) -> Self {
        // Without branches: which of them a link is, is hard to foresee.
        let places = if self.is_inner() { nodes } else { blocks };
        let moved = self.0.wrapping_add(if self.is_empty() { 0 } else { places as u32 });
        let placed = self.0 & (Self::PLACED_LEAF - 1) | (self.0 & Self::PLACED_LEAF) << 2;
        Self(if self.0 & (Self::LEAF_BIT | Self::PLACED) == Self::PLACED { placed } else { moved })
    }

    /// The reference, unpacked.
    #[inline]
    pub fn get(self) -> Child {
        if self.is_empty() {
            Child::Empty
        } else if self.is_inner() {
            Child::Inner(self.0 as usize)
        } else {
            Child::Leaf {
                first: (self.0 & Self::INDEX_MASK) as usize,
                count: ((self.0 >> Self::COUNT_SHIFT) & 7) as usize + 1,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_round_trip() {
        assert_eq!(Link::EMPTY.get(), Child::Empty);
        assert_eq!(Link::inner(0).get(), Child::Inner(0));
        assert_eq!(Link::inner(MAX_BLOCKS - 1).get(), Child::Inner(MAX_BLOCKS - 1));
        for count in 1..=MAX_LEAF_BLOCKS {
            for first in [0, 5, MAX_BLOCKS - 1] {
                assert_eq!(Link::leaf(first, count).get(), Child::Leaf { first, count });
            }
        }
    }

    #[test]
    fn links_beyond_a_tree_are_refused() {
        let panics = |link: fn() -> Link| std::panic::catch_unwind(link).is_err();
        assert!(panics(|| Link::inner(1 << 30)) && panics(|| Link::inner(usize::MAX)));
        assert!(panics(|| Link::leaf(0, 0)) && panics(|| Link::leaf(0, MAX_LEAF_BLOCKS + 1)));
        assert!(panics(|| Link::leaf(MAX_BLOCKS, 1)));
        assert_eq!(Link::inner((1 << 30) - 1).get(), Child::Inner((1 << 30) - 1));
    }

    #[test]
    fn links_that_have_their_place_stay() {
        assert_eq!(Link::EMPTY.moved(5, 7), Link::EMPTY);
        for index in [0, 5, MAX_BLOCKS - 8] {
            let [node, block] = [Link::inner(index), Link::leaf(index, 1)];
            assert_eq!(node.moved(5, 7), Link::inner(index + 5));
            assert_eq!(Link::leaf(index, 3).moved(5, 7), Link::leaf(index + 7, 3));
            assert_eq!([node, block].map(|link| link.placed().moved(5, 7)), [node, block]);
        }
    }
}
