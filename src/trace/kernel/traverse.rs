//! The traversal itself: depth first, nearest child first, farther ones on a stack and skipped when a closer
//! hit was found meanwhile (after Wald et al., "Embree: a kernel framework", 2014). Generic over the tests.

#![allow(unsafe_code)]

use super::counts::Counter;
use super::sound_tree::SoundTree;
use super::stack::{Item, Stack, ordered};
use crate::bvh::{Child, Link, WideNode};
use crate::geometry::{Hit, Ray};
use std::hint::black_box;

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
    /// What all rays share: the proof that the machine has the instructions.
    type Setup: Copy;
    /// The triangles of a leaf, four by four.
    type Block;

    /// The ray with its direction scaled, and the factor by which distances along it are to be multiplied.
    #[inline(always)]
    fn scaled(ray: &Ray) -> (Ray, f32) {
        (*ray, 1.0)
    }

    /// Prepares a ray that is valid and scaled.
    fn new(setup: Self::Setup, ray: &Ray) -> Self;

    /// The children whose boxes meet the ray in `tnear..=tfar`, as a bit mask, and where it enters them.
    /// Unused slots are never met by a valid ray.
    fn enter<const N: usize>(&self, node: &WideNode<N>, tfar: f32) -> (u32, Entries<N>);

    /// Replaces `hit` by the block's closest hit in `tnear < t <= hit.t`, if there is one.
    fn closest(&self, block: &Self::Block, hit: &mut Hit);

    /// Whether the block has a hit in `tnear < t <= tfar`.
    fn any(&self, block: &Self::Block, tfar: f32) -> bool;

    /// Hints that `bytes` from `address` will be read soon.
    fn prefetch(address: *const u8, bytes: usize);
}

/// Runs a batch. Instruction sets wrap it in a function that enables theirs, into which all is inlined. Rays that are
/// not valid hit nothing.
#[inline(always)]
pub(super) fn run<K: Kernel, C: Counter, const N: usize>(
    setup: K::Setup,
    tree: SoundTree<'_, N, K::Block>,
    query: Query<'_>,
    counter: &mut C,
) {
    match query {
        Query::Closest(rays, hits) => {
            assert_eq!(rays.len(), hits.len(), "as many hits as rays");
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = Hit::MISS;
                if ray.is_valid() {
                    let (ray, factor) = K::scaled(ray);
                    let found = closest::<K, C, N>(K::new(setup, &ray), tree, ray.tfar, counter);
                    *hit = Hit { t: found.t * factor, ..found }.measured();
                }
            }
        }
        Query::Any(rays, occluded) => {
            assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
            for (ray, occluded) in rays.iter().zip(occluded) {
                *occluded = ray.is_valid() && {
                    let (ray, _) = K::scaled(ray);
                    any::<K, C, N>(K::new(setup, &ray), tree, ray.tfar, counter)
                };
            }
        }
    }
}

/// The link of the only child in `mask`, found by branches: where these are foreseen, as with rays that follow each
/// other, the child is fetched while its box is still tested. A table would have to wait for the test.
#[inline(always)]
fn only<const N: usize>(node: &WideNode<N>, mask: u32) -> Link {
    // A black box for each child, or the compiler would make a table of them.
    let link = |slot: usize| Link::from_bits(black_box(node.links[slot].bits()));
    for slot in 0..N - 1 {
        if mask >> slot & 1 == 1 {
            return link(slot);
        }
    }
    link(N - 1)
}

/// Bytes of a node or of a leaf's first block, whichever is larger.
const fn bytes_ahead<K: Kernel, const N: usize>() -> usize {
    let (node, block) = (size_of::<WideNode<N>>(), size_of::<K::Block>());
    if node > block { node } else { block }
}

#[inline(always)]
pub(super) fn closest<K: Kernel, C: Counter, const N: usize>(
    kernel: K,
    tree: SoundTree<'_, N, K::Block>,
    tfar: f32,
    counter: &mut C,
) -> Hit {
    let mut hit = Hit { t: tfar, ..Hit::MISS };
    let mut room = Stack::room();
    let mut stack = Stack::new(&mut room);
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
                if mask.is_power_of_two() {
                    link = only(node, mask);
                    continue;
                }
                let mut next = || {
                    let slot = mask.trailing_zeros() as usize % N;
                    mask &= mask - 1;
                    let item = Item::new(entries.0[slot], node.links[slot]);
                    K::prefetch(tree.address(item.link()), bytes_ahead::<K, N>());
                    (item, mask == 0)
                };
                let (a, _) = next();
                let (b, last) = next();
                if last {
                    // A branch, not moves: where it is foreseen, the nearer child is fetched before the comparison.
                    if a.entry() < b.entry() {
                        // SAFETY: see `Stack`.
                        unsafe { stack.push(b) };
                        link = a.link();
                    } else {
                        // SAFETY: see `Stack`.
                        unsafe { stack.push(a) };
                        link = b.link();
                    }
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
                let base = stack.len();
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
pub(super) fn any<K: Kernel, C: Counter, const N: usize>(
    kernel: K,
    tree: SoundTree<'_, N, K::Block>,
    tfar: f32,
    counter: &mut C,
) -> bool {
    let mut room = Stack::room();
    let mut stack = Stack::new(&mut room);
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
                if mask.is_power_of_two() {
                    link = only(node, mask);
                    continue;
                }
                loop {
                    link = node.links[mask.trailing_zeros() as usize % N];
                    K::prefetch(tree.address(link), bytes_ahead::<K, N>());
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
