//! Children that wait while a nearer one is visited.

#![allow(unsafe_code)]

use crate::bvh::Link;
use crate::bvh::limits::TRAVERSAL_STACK;
use std::mem::MaybeUninit;

/// A child and where the ray enters it, in one register: the order of items is that of entries.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Item(u64);

impl Item {
    #[inline(always)]
    pub(super) fn new(entry: u32, link: Link) -> Self {
        Self(u64::from(entry) << 32 | u64::from(link.bits()))
    }

    #[inline(always)]
    pub(super) fn entry(self) -> u32 {
        (self.0 >> 32) as u32
    }

    #[inline(always)]
    pub(super) fn link(self) -> Link {
        Link::from_bits(self.0 as u32)
    }
}

/// The nearer first.
#[inline(always)]
pub(super) fn ordered(a: Item, b: Item) -> (Item, Item) {
    (a.min(b), a.max(b))
}

/// Memory for the items of a [`Stack`].
pub(super) type Room = [MaybeUninit<Item>; TRAVERSAL_STACK];

/// Children still to visit, nearest on top. Its room is never cleared (a ray would pay for 4 KB of zeros) and
/// only borrowed, so that the length stays in a register.
///
/// It never overflows: traversal descends a [`super::sound_tree::SoundTree`] of at most eight children per node and
/// [`MAX_DEPTH`](crate::bvh::MAX_DEPTH) inner levels, each entered from above, for which [`TRAVERSAL_STACK`]
/// items suffice.
pub(super) struct Stack<'a> {
    items: &'a mut Room,
    /// Items in use, all of them written.
    len: usize,
}

impl<'a> Stack<'a> {
    /// Memory for a stack.
    #[inline(always)]
    pub(super) fn room() -> Room {
        [const { MaybeUninit::uninit() }; TRAVERSAL_STACK]
    }

    /// A stack without items in `items`.
    #[inline(always)]
    pub(super) fn new(items: &'a mut Room) -> Self {
        Self { items, len: 0 }
    }

    /// Items in use.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Puts `item` on top.
    ///
    /// # Safety
    /// Fewer than [`TRAVERSAL_STACK`] items are on the stack.
    #[inline(always)]
    pub(super) unsafe fn push(&mut self, item: Item) {
        debug_assert!(self.len < TRAVERSAL_STACK);
        // SAFETY: the caller's promise.
        unsafe { self.items.get_unchecked_mut(self.len) }.write(item);
        self.len += 1;
    }

    /// Puts `items` on top, the last one uppermost.
    ///
    /// # Safety
    /// As [`Stack::push`], for each.
    #[inline(always)]
    pub(super) unsafe fn push_all<const COUNT: usize>(&mut self, items: [Item; COUNT]) {
        for item in items {
            // SAFETY: the caller's promise.
            unsafe { self.push(item) };
        }
    }

    /// Takes the item on top.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Item> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        // SAFETY: all items below `len` were written by `push` or `insert`.
        Some(unsafe { self.items.get_unchecked(self.len).assume_init() })
    }

    /// Puts `item` below those nearer than it, but not below `base`.
    ///
    /// # Safety
    /// As [`Stack::push`].
    #[inline(always)]
    pub(super) unsafe fn insert(&mut self, base: usize, item: Item) {
        // SAFETY: the caller's promise.
        unsafe { self.push(item) };
        let mut at = self.len - 1;
        while at > base {
            // SAFETY: `at - 1` and `at` are below `len`: written, and within the array.
            let below = unsafe { self.items.get_unchecked(at - 1).assume_init() };
            if item <= below {
                break;
            }
            // SAFETY: as above.
            unsafe { self.items.get_unchecked_mut(at) }.write(below);
            at -= 1;
        }
        // SAFETY: as above.
        unsafe { self.items.get_unchecked_mut(at) }.write(item);
    }
}
