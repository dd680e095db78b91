//! The cheap half of validation: links alone, without boxes and corners.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use super::validate::{ARRAYS, Invalid};
use super::{Child, LeafBlock, Link, MAX_DEPTH, MAX_LEAF_BLOCKS, WideBvh};
use crate::memory::{OutOfMemory, huge_pages};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Subtrees that are walked at the same time, where there are as many: some for each of many threads.
const SUBTREES: usize = 1 << 10;

/// Blocks, and places, that one task looks at.
const GRAIN: usize = 1 << 12;

impl<const N: usize, B: LeafBlock> WideBvh<N, B> {
    /// Proves that the links form a tree of bounded depth that uses every node and block once, and that the leaves name
    /// every one of so many primitives and no other, in blocks without gaps. A fraction of [`WideBvh::validate`]: for
    /// trees of which boxes and leaf data are trusted, as of a saved one whose checksum agrees. On the current rayon
    /// pool.
    ///
    /// # Errors
    /// One of the violations.
    pub fn validate_links(&self, primitives: usize) -> Result<(), Invalid> {
        self.validate_nodes()?;
        let named = Named::new(primitives)?;
        self.blocks.par_chunks(GRAIN).enumerate().try_for_each(|(chunk, blocks)| {
            blocks.iter().enumerate().try_for_each(|(i, block)| named.note(chunk * GRAIN + i, block))
        })?;
        named.validate()
    }

    /// Proves of the links what [`WideBvh::validate_links`] does, without a look into blocks.
    ///
    /// # Errors
    /// One of the violations.
    pub(super) fn validate_nodes(&self) -> Result<(), Invalid> {
        let walk = Walk {
            tree: self,
            nodes: Seen::new("node", self.nodes.len())?,
            blocks: Seen::new("block", self.blocks.len())?,
        };
        // From the root level by level, until there is enough to do for all threads.
        let mut level = vec![(self.root, 0)];
        while (1..SUBTREES).contains(&level.len()) {
            let mut below = Vec::new();
            level.into_iter().try_for_each(|item| walk.enter(item, &mut below))?;
            level = below;
        }
        level.into_par_iter().with_max_len(1).try_for_each(|item| {
            let mut pending = vec![item];
            while let Some(item) = pending.pop() {
                walk.enter(item, &mut pending)?;
            }
            Ok::<_, Invalid>(())
        })?;
        for seen in [&walk.nodes, &walk.blocks] {
            if let Some(index) = seen.first_unseen() {
                return Err(Invalid::Unreached { what: seen.what, index });
            }
        }
        Ok(())
    }
}

/// A tree and what of it was seen.
struct Walk<'a, const N: usize, B> {
    tree: &'a WideBvh<N, B>,
    nodes: Seen,
    blocks: Seen,
}

impl<const N: usize, B> Walk<'_, N, B> {
    /// Notes what `link` leads to, and adds the links there to `pending`, each with its depth.
    #[inline]
    fn enter(&self, (link, depth): (Link, usize), pending: &mut Vec<(Link, usize)>) -> Result<(), Invalid> {
        match link.get() {
            Child::Empty => Ok(()),
            Child::Inner(_) if depth >= MAX_DEPTH => Err(Invalid::TooDeep),
            Child::Inner(index) => {
                self.nodes.note(index)?;
                let node = self.tree.nodes.get(index).ok_or(Invalid::Link { what: "node", index })?;
                let links = node.links.iter();
                pending.extend(links.filter(|link| !link.is_empty()).map(|&child| (child, depth + 1)));
                Ok(())
            }
            Child::Leaf { first, count } if count > MAX_LEAF_BLOCKS => Err(Invalid::LongLeaf(first)),
            Child::Leaf { first, count } => {
                (first..first + count).try_for_each(|index| self.blocks.note(index))
            }
        }
    }
}

/// The primitives that blocks name.
pub(super) struct Named(Seen);

impl Named {
    /// None of so many.
    ///
    /// # Errors
    /// No memory.
    pub fn new(primitives: usize) -> Result<Self, OutOfMemory> {
        Seen::new("primitive", primitives).map(Self)
    }

    /// Notes those of a block.
    ///
    /// # Errors
    /// A gap, or a primitive that is not there.
    #[inline]
    pub fn note<B: LeafBlock>(&self, index: usize, block: &B) -> Result<(), Invalid> {
        if block.is_gapped() {
            return Err(Invalid::Block(index));
        }
        block.ids().try_for_each(|prim| {
            let place = self.0.places.get(prim as usize).ok_or(Invalid::Block(index))?;
            place.store(true, Relaxed);
            Ok(())
        })
    }

    /// Proves that every primitive is named.
    ///
    /// # Errors
    /// The first that is not.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.0.first_unseen().map_or(Ok(()), |prim| Err(Invalid::Missing(prim as u32)))
    }
}

/// Places that were reached.
struct Seen {
    what: &'static str,
    places: Vec<AtomicBool>,
}

impl Seen {
    fn new(what: &'static str, len: usize) -> Result<Self, OutOfMemory> {
        let mut places = Vec::new();
        huge_pages::try_reserve(&mut places, len, ARRAYS)?;
        places.resize_with(len, AtomicBool::default);
        Ok(Self { what, places })
    }

    /// Notes that a place is reached, the first time.
    #[inline]
    fn note(&self, index: usize) -> Result<(), Invalid> {
        match self.places.get(index) {
            Some(place) if !place.swap(true, Relaxed) => Ok(()),
            _ => Err(Invalid::Link { what: self.what, index }),
        }
    }

    fn first_unseen(&self) -> Option<usize> {
        self.places.par_chunks(GRAIN).enumerate().find_map_first(|(chunk, places)| {
            places.iter().position(|place| !place.load(Relaxed)).map(|i| chunk * GRAIN + i)
        })
    }
}
