//! The traversal itself: depth first, nearest child first, farther ones on a stack and skipped when a closer
//! hit was found meanwhile (after Wald et al., "Embree: a kernel framework", 2014). Generic over the tests.

use super::Counter;
use super::soundness::SoundTree;
use crate::bvh::limits::TRAVERSAL_STACK;
use crate::bvh::{Child, Link, TriangleBlock, WideNode};
use crate::geometry::{Hit, Ray};
use std::mem::MaybeUninit;

/// A batch and the place for its answers, equally long.
pub(super) enum Query<'a> {
    Closest(&'a [Ray], &'a mut [Hit]),
    Any(&'a [Ray], &'a mut [bool]),
}

/// Distances at which a ray enters the children, as bits of non-negative floats (which order like integers).
#[repr(C, align(32))]
pub(super) struct Entries<const N: usize>(pub [u32; N]);

/// One ray, prepared, and its two tests in some instruction set.
pub(super) trait Kernel: Copy {
    /// Proves that the machine has the instructions.
    type Token: Copy;

    /// Prepares a ray. A negative `tnear` counts as 0.
    fn new(token: Self::Token, ray: &Ray) -> Self;

    /// The children whose boxes meet the ray in `tnear..=tfar`, as a bit mask, and where it enters them.
    /// Unused slots are never met by a valid ray.
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>);

    /// Replaces `hit` by the block's closest hit in `tnear < t <= hit.t`, if there is one.
    fn closest(&self, block: &TriangleBlock, hit: &mut Hit);

    /// Whether the block has a hit in `tnear < t <= tfar`.
    fn any(&self, block: &TriangleBlock, tfar: f32) -> bool;

    /// Hints that `bytes` from `address` will be read soon.
    fn prefetch(address: *const u8, bytes: usize);
}

/// Runs a batch. Instruction sets wrap it in a function that enables theirs, into which all is inlined.
#[inline(always)]
pub(super) fn run<K: Kernel, C: Counter, const N: usize>(
    token: K::Token,
    tree: SoundTree<'_, N>,
    query: Query<'_>,
    counter: &mut C,
) {
    match query {
        Query::Closest(rays, hits) => {
            assert_eq!(rays.len(), hits.len(), "as many hits as rays");
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = closest::<K, C, N>(K::new(token, ray), tree, ray.tfar, counter);
            }
        }
        Query::Any(rays, occluded) => {
            assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
            for (ray, occluded) in rays.iter().zip(occluded) {
                *occluded = any::<K, C, N>(K::new(token, ray), tree, ray.tfar, counter);
            }
        }
    }
}

#[inline(always)]
fn closest<K: Kernel, C: Counter, const N: usize>(
    kernel: K,
    tree: SoundTree<'_, N>,
    tfar: f32,
    counter: &mut C,
) -> Hit {
    let mut hit = Hit { t: tfar, ..Hit::MISS };
    let mut items = Stack::room();
    let mut stack = Stack { items: &mut items, len: 0 };
    let mut link = tree.root();
    'visit: loop {
        // Descend to the nearest leaf.
        'descend: {
            while link.is_inner() {
                counter.node();
                // SAFETY: `link` is the root or a child of a node reached from it.
                let node = unsafe { tree.node(link.bits() as usize) };
                let (mut mask, entries) = kernel.enter(node, hit.t);
                if mask == 0 {
                    break 'descend;
                }
                let mut next = || {
                    let slot = mask.trailing_zeros() as usize % N;
                    mask &= mask - 1;
                    let item = Item::new(entries.0[slot], node.links[slot]);
                    K::prefetch(tree.address(item.link()), size_of::<WideNode<N>>());
                    (item, mask == 0)
                };
                let (a, last) = next();
                if last {
                    link = a.link();
                    continue;
                }
                let (b, last) = next();
                if last {
                    let (near, far) = if a.entry() < b.entry() { (a, b) } else { (b, a) };
                    // SAFETY: see `Stack`.
                    unsafe { stack.push(far) };
                    link = near.link();
                    continue;
                }
                let (c, last) = next();
                if last {
                    let (a, b) = ordered(a, b);
                    let (b, c) = ordered(b, c);
                    let (a, b) = ordered(a, b);
                    // SAFETY: see `Stack`.
                    unsafe { stack.push_all([c, b]) };
                    link = a.link();
                    continue;
                }
                let (d, last) = next();
                let (a, b) = ordered(a, b);
                let (c, d) = ordered(c, d);
                let (a, c) = ordered(a, c);
                let (b, d) = ordered(b, d);
                let (b, c) = ordered(b, c);
                if N == 4 || last {
                    // SAFETY: see `Stack`.
                    unsafe { stack.push_all([d, c, b]) };
                    link = a.link();
                    continue;
                }
                let base = stack.len;
                // SAFETY: see `Stack`.
                unsafe { stack.push_all([d, c, b, a]) };
                loop {
                    let (item, last) = next();
                    // SAFETY: see `Stack`.
                    unsafe { stack.insert(base, item) };
                    if last {
                        break;
                    }
                }
                link = stack.pop().map_or(Link::EMPTY, Item::link);
            }
            // Test the leaf.
            if let Child::Leaf { first, count } = link.get() {
                // SAFETY: as for the node.
                for block in unsafe { tree.leaf(first, count) } {
                    counter.block();
                    kernel.closest(block, &mut hit);
                }
            }
        }
        // Take the next child that is not behind the hit.
        loop {
            let Some(item) = stack.pop() else { break 'visit };
            if f32::from_bits(item.entry()) <= hit.t {
                link = item.link();
                break;
            }
        }
    }
    if hit.is_hit() { hit } else { Hit::MISS }
}

/// Without distances there is nothing to sort: the last child met comes first, the others wait.
#[inline(always)]
fn any<K: Kernel, C: Counter, const N: usize>(
    kernel: K,
    tree: SoundTree<'_, N>,
    tfar: f32,
    counter: &mut C,
) -> bool {
    let mut items = Stack::room();
    let mut stack = Stack { items: &mut items, len: 0 };
    let mut link = tree.root();
    loop {
        'descend: {
            while link.is_inner() {
                counter.node();
                // SAFETY: `link` is the root or a child of a node reached from it.
                let node = unsafe { tree.node(link.bits() as usize) };
                let (mut mask, _) = kernel.enter(node, tfar);
                if mask == 0 {
                    break 'descend;
                }
                loop {
                    link = node.links[mask.trailing_zeros() as usize % N];
                    K::prefetch(tree.address(link), size_of::<WideNode<N>>());
                    mask &= mask - 1;
                    if mask == 0 {
                        break;
                    }
                    // SAFETY: see `Stack`.
                    unsafe { stack.push(Item::new(0, link)) };
                }
            }
            if let Child::Leaf { first, count } = link.get() {
                // SAFETY: as for the node.
                for block in unsafe { tree.leaf(first, count) } {
                    counter.block();
                    if kernel.any(block, tfar) {
                        return true;
                    }
                }
            }
        }
        match stack.pop() {
            Some(item) => link = item.link(),
            None => return false,
        }
    }
}

/// A child and where the ray enters it, in one register: the order of items is that of entries.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Item(u64);

impl Item {
    #[inline(always)]
    fn new(entry: u32, link: Link) -> Self {
        Self(u64::from(entry) << 32 | u64::from(link.bits()))
    }

    #[inline(always)]
    fn entry(self) -> u32 {
        (self.0 >> 32) as u32
    }

    #[inline(always)]
    fn link(self) -> Link {
        Link::from_bits(self.0 as u32)
    }
}

#[inline(always)]
fn ordered(a: Item, b: Item) -> (Item, Item) {
    (a.min(b), a.max(b))
}

/// Children still to visit, nearest on top. Its room is never cleared (a ray would pay for 4 KB of zeros) and
/// only borrowed, so that the length stays in a register.
///
/// It never overflows: traversal descends a [`SoundTree`] of at most eight children per node and
/// [`MAX_DEPTH`](crate::bvh::MAX_DEPTH) inner levels, each entered from above, for which [`TRAVERSAL_STACK`]
/// items suffice.
struct Stack<'a> {
    items: &'a mut [MaybeUninit<Item>; TRAVERSAL_STACK],
    /// Items in use, all of them written.
    len: usize,
}

impl Stack<'_> {
    #[inline(always)]
    fn room() -> [MaybeUninit<Item>; TRAVERSAL_STACK] {
        [const { MaybeUninit::uninit() }; TRAVERSAL_STACK]
    }

    /// Puts `item` on top.
    ///
    /// # Safety
    /// Fewer than [`TRAVERSAL_STACK`] items are on the stack.
    #[inline(always)]
    unsafe fn push(&mut self, item: Item) {
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
    unsafe fn push_all<const COUNT: usize>(&mut self, items: [Item; COUNT]) {
        for item in items {
            // SAFETY: the caller's promise.
            unsafe { self.push(item) };
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Item> {
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
    unsafe fn insert(&mut self, base: usize, item: Item) {
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
