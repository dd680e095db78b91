//! The traversal itself: depth first, nearest child first, farther ones on a stack and skipped when a closer
//! hit was found meanwhile (after Wald et al., "Embree: a kernel framework", 2014). Generic over the tests.

use super::Counter;
use super::soundness::SoundTree;
use crate::bvh::{Child, Link, MAX_DEPTH, TriangleBlock, WideNode};
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
    /// Prepares a ray. A negative `tnear` counts as 0.
    ///
    /// # Safety
    /// The machine has the instructions; likewise for all methods.
    unsafe fn new(ray: &Ray) -> Self;

    /// The children whose boxes meet the ray in `tnear..=tfar`, as a bit mask, and where it enters them.
    /// Unused slots are never met by a valid ray.
    ///
    /// # Safety
    /// As [`Kernel::new`].
    unsafe fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>);

    /// Replaces `hit` by the block's closest hit in `tnear < t <= hit.t`, if there is one.
    ///
    /// # Safety
    /// As [`Kernel::new`].
    unsafe fn closest(&self, block: &TriangleBlock, hit: &mut Hit);

    /// Whether the block has a hit in `tnear < t <= tfar`.
    ///
    /// # Safety
    /// As [`Kernel::new`].
    unsafe fn any(&self, block: &TriangleBlock, tfar: f32) -> bool;

    /// Hints that `bytes` from `address` will be read soon.
    fn prefetch(address: *const u8, bytes: usize);
}

/// Runs a batch. Instruction sets wrap it in a function that enables theirs, into which all is inlined.
#[inline(always)]
pub(super) fn run<K: Kernel, C: Counter, const N: usize>(
    tree: SoundTree<'_, N>,
    query: Query<'_>,
    counter: &mut C,
) {
    match query {
        Query::Closest(rays, hits) => {
            assert_eq!(rays.len(), hits.len(), "as many hits as rays");
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = closest::<K, C, N>(tree, ray, counter);
            }
        }
        Query::Any(rays, occluded) => {
            assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
            for (ray, occluded) in rays.iter().zip(occluded) {
                *occluded = any::<K, C, N>(tree, ray, counter);
            }
        }
    }
}

#[inline(always)]
fn closest<K: Kernel, C: Counter, const N: usize>(tree: SoundTree<'_, N>, ray: &Ray, counter: &mut C) -> Hit {
    // SAFETY: who calls `run` with `K` has its instructions; likewise below, and links come from the tree.
    let kernel = unsafe { K::new(ray) };
    let mut hit = Hit { t: ray.tfar, ..Hit::MISS };
    let mut items = Stack::room();
    let mut stack = Stack { items: &mut items, len: 0 };
    let mut link = tree.root();
    'visit: loop {
        // Descend to the nearest leaf.
        'descend: {
            while link.is_inner() {
                counter.node();
                // SAFETY: as above.
                let node = unsafe { tree.node(link.bits() as usize) };
                // SAFETY: as above.
                let (mut mask, entries) = unsafe { kernel.enter(node, hit.t) };
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
                    stack.push(far);
                    link = near.link();
                    continue;
                }
                let (c, last) = next();
                if last {
                    let (a, b) = ordered(a, b);
                    let (b, c) = ordered(b, c);
                    let (a, b) = ordered(a, b);
                    stack.push(c);
                    stack.push(b);
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
                    stack.push(d);
                    stack.push(c);
                    stack.push(b);
                    link = a.link();
                    continue;
                }
                let base = stack.len;
                for item in [d, c, b, a] {
                    stack.push(item);
                }
                loop {
                    let (item, last) = next();
                    stack.insert(base, item);
                    if last {
                        break;
                    }
                }
                link = stack.pop().map_or(Link::EMPTY, Item::link);
            }
            // Test the leaf.
            if let Child::Leaf { first, count } = link.get() {
                // SAFETY: as above.
                for block in unsafe { tree.leaf(first, count) } {
                    counter.block();
                    // SAFETY: as above.
                    unsafe { kernel.closest(block, &mut hit) };
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
fn any<K: Kernel, C: Counter, const N: usize>(tree: SoundTree<'_, N>, ray: &Ray, counter: &mut C) -> bool {
    // SAFETY: who calls `run` with `K` has its instructions; likewise below, and links come from the tree.
    let kernel = unsafe { K::new(ray) };
    let mut items = Stack::room();
    let mut stack = Stack { items: &mut items, len: 0 };
    let mut link = tree.root();
    loop {
        'descend: {
            while link.is_inner() {
                counter.node();
                // SAFETY: as above.
                let node = unsafe { tree.node(link.bits() as usize) };
                // SAFETY: as above.
                let (mut mask, _) = unsafe { kernel.enter(node, ray.tfar) };
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
                    stack.push(Item::new(0, link));
                }
            }
            if let Child::Leaf { first, count } = link.get() {
                // SAFETY: as above.
                for block in unsafe { tree.leaf(first, count) } {
                    counter.block();
                    // SAFETY: as above.
                    if unsafe { kernel.any(block, ray.tfar) } {
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

/// Each of the inner levels leaves at most seven children waiting, while its nearest is visited; the lowest
/// one has eight on the stack for a moment.
const CAPACITY: usize = 7 * MAX_DEPTH + 1;

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
struct Stack<'a> {
    items: &'a mut [MaybeUninit<Item>; CAPACITY],
    len: usize,
}

impl Stack<'_> {
    #[inline(always)]
    fn room() -> [MaybeUninit<Item>; CAPACITY] {
        [const { MaybeUninit::uninit() }; CAPACITY]
    }

    #[inline(always)]
    fn push(&mut self, item: Item) {
        debug_assert!(self.len < CAPACITY);
        // SAFETY: a `SoundTree` has at most eight children per node and `MAX_DEPTH` inner levels, each entered
        // from above, so that `CAPACITY` is never exceeded.
        unsafe { self.items.get_unchecked_mut(self.len) }.write(item);
        self.len += 1;
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

    /// Pushes `item` below those nearer than it, but not below `base`.
    #[inline(always)]
    fn insert(&mut self, base: usize, item: Item) {
        self.push(item);
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
