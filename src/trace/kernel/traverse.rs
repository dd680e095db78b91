//! The traversal itself: depth first, nearest child first, farther ones on a stack and skipped when a closer
//! hit was found meanwhile (after Wald et al., "Embree: a kernel framework", 2014). Generic over the tests.

#![allow(unsafe_code)]

use super::children::{nearest, only};
use super::counts::Counter;
use super::sound_tree::SoundTree;
use super::stack::{Item, Stack};
use crate::bvh::{Child, WideNode};
use crate::geometry::{Hit, Ray};
use crate::simd::foresees_branches;

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
    if foresees_branches() {
        run_by::<K, C, N, true>(setup, tree, query, counter);
    } else {
        run_by::<K, C, N, false>(setup, tree, query, counter);
    }
}

/// Whether the processor `FORESEES` branches decides how the next child is found, not which one it is.
#[inline(always)]
fn run_by<K: Kernel, C: Counter, const N: usize, const FORESEES: bool>(
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
                    let found = closest_by::<K, C, N, FORESEES>(K::new(setup, &ray), tree, ray.tfar, counter);
                    *hit = Hit { t: found.t * factor, ..found }.measured();
                }
            }
        }
        Query::Any(rays, occluded) => {
            assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
            for (ray, occluded) in rays.iter().zip(occluded) {
                *occluded = ray.is_valid() && {
                    let (ray, _) = K::scaled(ray);
                    any_by::<K, C, N, FORESEES>(K::new(setup, &ray), tree, ray.tfar, counter)
                };
            }
        }
    }
}

/// Bytes of a node or of a leaf's first block, whichever is larger.
const fn bytes_ahead<K: Kernel, const N: usize>() -> usize {
    let (node, block) = (size_of::<WideNode<N>>(), size_of::<K::Block>());
    if node > block { node } else { block }
}

/// The closest hit of one ray up to `tfar`.
#[inline(always)]
pub(super) fn closest<K: Kernel, C: Counter, const N: usize>(
    kernel: K,
    tree: SoundTree<'_, N, K::Block>,
    tfar: f32,
    counter: &mut C,
) -> Hit {
    if foresees_branches() {
        closest_by::<K, C, N, true>(kernel, tree, tfar, counter)
    } else {
        closest_by::<K, C, N, false>(kernel, tree, tfar, counter)
    }
}

/// Whether one ray hits anything up to `tfar`.
#[inline(always)]
pub(super) fn any<K: Kernel, C: Counter, const N: usize>(
    kernel: K,
    tree: SoundTree<'_, N, K::Block>,
    tfar: f32,
    counter: &mut C,
) -> bool {
    if foresees_branches() {
        any_by::<K, C, N, true>(kernel, tree, tfar, counter)
    } else {
        any_by::<K, C, N, false>(kernel, tree, tfar, counter)
    }
}

#[inline(always)]
fn closest_by<K: Kernel, C: Counter, const N: usize, const FORESEES: bool>(
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
                let (mask, entries) = kernel.enter(node, hit.t);
                if mask == 0 {
                    break 'descend;
                }
                link = if FORESEES && mask.is_power_of_two() {
                    only(node, mask)
                } else {
                    // SAFETY: see `Stack`.
                    unsafe {
                        nearest::<N, FORESEES>(
                            node,
                            mask,
                            &entries.0,
                            #[inline(always)]
                            |child| K::prefetch(tree.address(child), bytes_ahead::<K, N>()),
                            &mut stack,
                        )
                    }
                };
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
fn any_by<K: Kernel, C: Counter, const N: usize, const FORESEES: bool>(
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
                if FORESEES && mask.is_power_of_two() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders;
    use crate::geometry::Mesh;
    use crate::random::SplitMix64;
    use crate::scene;
    use crate::trace::kernel::counts::TraversalCounts;
    use crate::trace::kernel::scalar::FastScalar;
    use glam::Vec3;

    /// Both ways to find the next child visit the same nodes and leaf blocks and find the same hits, also where
    /// children are entered at the same distance: every triangle is there twice.
    fn agree<const N: usize>() {
        let mesh = scene::scalable(1000, 1).mesh;
        let twice = [mesh.triangles(), mesh.triangles()].concat();
        let (mesh, _) = Mesh::new(mesh.vertices().to_vec(), twice).unwrap();
        let tree = builders::by_name::<N>("phr-fast").unwrap().build(&mesh).tree;
        let sound = SoundTree::new(&tree).unwrap();
        let mut random = SplitMix64::new(N as u64);
        let mut next = || random.next_u64() as f32 / u64::MAX as f32;
        let size = tree.bounds.max - tree.bounds.min;
        let mut point = || Vec3::from(tree.bounds.min + size * glam::Vec3A::new(next(), next(), next()));
        let rays: Vec<Ray> = (0..2000)
            .map(|_| {
                let org = point();
                Ray { org, dir: point() - org, tnear: 0.0, tfar: f32::INFINITY }
            })
            .collect();
        let mut hits = 0;
        let (mut branches, mut moves) = (TraversalCounts::default(), TraversalCounts::default());
        for ray in &rays {
            let kernel = <FastScalar as Kernel>::new((), ray);
            let by_branches = closest_by::<_, _, N, true>(kernel, sound, ray.tfar, &mut branches);
            let by_moves = closest_by::<_, _, N, false>(kernel, sound, ray.tfar, &mut moves);
            assert_eq!(by_branches, by_moves, "{ray:?}");
            let any = any_by::<_, _, N, true>(kernel, sound, ray.tfar, &mut branches);
            assert_eq!(any, any_by::<_, _, N, false>(kernel, sound, ray.tfar, &mut moves), "{ray:?}");
            assert_eq!(any, by_moves.is_hit(), "{ray:?}");
            hits += usize::from(any);
        }
        assert_eq!(branches, moves);
        assert!((200..1800).contains(&hits), "{hits} hits");
    }

    #[test]
    fn branches_and_moves_find_the_same() {
        agree::<4>();
        agree::<8>();
    }
}
