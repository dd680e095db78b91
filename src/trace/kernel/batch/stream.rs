//! A stream of rays that go down the tree together: a node is visited once for all rays that reach it, each of which is
//! tested against all its children, so that a branch is taken for many rays at a time (Barringer and Akenine-Moeller,
//! "Dynamic Ray Stream Traversal", 2014; Embree's streams for shadow rays do the same).

#![allow(unsafe_code)]

use crate::bvh::limits::TRAVERSAL_STACK;
use crate::bvh::{Child, Link, WideNode};
use crate::geometry::{Hit, Ray};
use crate::trace::kernel::sound_tree::SoundTree;
use crate::trace::kernel::traverse::{self, Kernel};
use arrayvec::ArrayVec;

/// Most rays of a stream: a mask has a bit for each.
pub(super) const MOST: usize = 32;

/// The places of a stream's rays in the batch.
pub(super) type Places = ArrayVec<u32, MOST>;

/// What the rays of a stream had in common.
pub(super) struct Shared {
    /// Nodes visited by several rays at a time.
    nodes: u32,
    /// Their rays, added up.
    rays: u32,
}

impl Shared {
    /// Whether so many rays or more met at a node on average, or hardly any node was visited.
    #[inline(always)]
    pub(super) fn is_at_least(&self, rays: u32) -> bool {
        self.rays >= rays * self.nodes
    }
}

/// Traces the valid ones of `rays` at `places`, for any hit if `ANY`, else for the closest, and tells `answer` the place and
/// the hit of each; of an any hit it only tells whether there is one.
#[inline(always)]
pub(super) fn run<K: Kernel, const N: usize, const ANY: bool>(
    setup: K::Setup,
    tree: SoundTree<'_, N, K::Block>,
    rays: &[Ray],
    places: &Places,
    answer: impl FnMut(usize, Hit),
) -> Shared {
    let mut stream = Stream::<K>::new(setup, rays, places);
    let mut shared = Shared { nodes: 0, rays: 0 };
    // As for single rays, the depth of a tree bounds the children that wait.
    let mut stack = ArrayVec::<Waiting, TRAVERSAL_STACK>::new();
    stack.push(Waiting { link: tree.root(), entry: 0, rays: stream.all() });
    while let Some(Waiting { link, entry, rays }) = stack.pop() {
        let rays = rays & !stream.done;
        if rays == 0 || f32::from_bits(entry) > stream.farthest {
            continue;
        }
        if rays.is_power_of_two() {
            // SAFETY: `link` is the root or a child of a node reached from it.
            stream.alone::<N, ANY>(unsafe { tree.below(link) }, entry, rays.trailing_zeros() as usize);
        } else if link.is_inner() {
            shared.nodes += 1;
            shared.rays += rays.count_ones();
            // SAFETY: as above.
            let node = unsafe { tree.node(link.bits() as usize) };
            let base = stack.len();
            for child in stream.children::<N, ANY>(node, rays) {
                K::prefetch(tree.address(child.link), 64);
                let mut at = stack.len();
                stack.push(child);
                while !ANY && at > base && stack[at - 1].entry < child.entry {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = child;
            }
        } else if let Child::Leaf { first, count } = link.get() {
            // SAFETY: as above.
            stream.leaf::<ANY>(unsafe { tree.leaf(first, count) }, rays);
        }
    }
    stream.tell::<ANY>(answer);
    shared
}

/// A child that waits, with the rays that meet its box.
#[derive(Clone, Copy)]
struct Waiting {
    link: Link,
    /// Where the first of them enters it, as bits of a float that is not negative; 0 for any hits.
    entry: u32,
    rays: u32,
}

/// The valid rays.
struct Stream<K> {
    kernels: ArrayVec<K, MOST>,
    /// The closest hits so far; before the first `t` is the end of the interval.
    hits: [Hit; MOST],
    places: Places,
    /// Those that found any hit.
    done: u32,
    /// The greatest distance of a closest hit so far.
    farthest: f32,
}

impl<K: Kernel> Stream<K> {
    #[inline(always)]
    fn new(setup: K::Setup, rays: &[Ray], places: &Places) -> Self {
        let mut stream = Self {
            kernels: ArrayVec::new(),
            hits: [Hit { t: f32::NEG_INFINITY, ..Hit::MISS }; MOST],
            places: Places::new(),
            done: 0,
            farthest: f32::INFINITY,
        };
        for &place in places {
            let ray = &rays[place as usize];
            if ray.is_valid() {
                stream.hits[stream.kernels.len()].t = ray.tfar;
                stream.kernels.push(K::new(setup, ray));
                stream.places.push(place);
            }
        }
        stream
    }

    /// A bit for each ray.
    #[inline(always)]
    fn all(&self) -> u32 {
        ((1u64 << self.kernels.len()) - 1) as u32
    }

    /// Goes on with ray `i` by itself, from the root of `below`, which it enters at `entry` at the earliest.
    #[inline(always)]
    fn alone<const N: usize, const ANY: bool>(
        &mut self,
        below: SoundTree<'_, N, K::Block>,
        entry: u32,
        i: usize,
    ) {
        let (kernel, hit) = (self.kernels[i], &mut self.hits[i]);
        if ANY {
            self.done |= u32::from(traverse::any(kernel, below, hit.t, &mut ())) << i;
        } else if f32::from_bits(entry) <= hit.t {
            let found = traverse::closest(kernel, below, hit.t, &mut ());
            if found.is_hit() {
                *hit = found;
            }
        }
    }

    /// The children of `node` that any of `rays` meets.
    #[inline(always)]
    fn children<const N: usize, const ANY: bool>(
        &self,
        node: &WideNode<N>,
        rays: u32,
    ) -> impl Iterator<Item = Waiting> {
        let (mut slots, mut met, mut nearest) = (0, [0u32; N], [if ANY { 0 } else { u32::MAX }; N]);
        for i in ones(rays) {
            let (mask, entries) = self.kernels[i].enter(node, self.hits[i].t);
            slots |= mask;
            for slot in 0..N {
                let is_met = mask >> slot & 1;
                met[slot] |= is_met << i;
                if !ANY {
                    nearest[slot] = nearest[slot].min(entries.0[slot] | is_met.wrapping_sub(1));
                }
            }
        }
        ones(slots).map(move |slot| {
            let slot = slot % N;
            Waiting { link: node.links[slot], entry: nearest[slot], rays: met[slot] }
        })
    }

    /// Tests `rays` against the blocks of a leaf.
    #[inline(always)]
    fn leaf<const ANY: bool>(&mut self, blocks: &[K::Block], rays: u32) {
        for i in ones(rays) {
            let (kernel, hit) = (&self.kernels[i], &mut self.hits[i]);
            for block in blocks {
                if !ANY {
                    kernel.closest(block, hit);
                } else if kernel.any(block, hit.t) {
                    self.done |= 1 << i;
                    break;
                }
            }
        }
        if !ANY {
            self.farthest =
                self.hits.iter().fold(f32::NEG_INFINITY, |a, hit| if a > hit.t { a } else { hit.t });
        }
    }

    #[inline(always)]
    fn tell<const ANY: bool>(&self, mut answer: impl FnMut(usize, Hit)) {
        for (i, (&place, hit)) in self.places.iter().zip(&self.hits).enumerate() {
            let any = if self.done >> i & 1 == 1 { Hit { prim: 0, ..Hit::MISS } } else { Hit::MISS };
            answer(place as usize, if ANY { any } else { hit.measured() });
        }
    }
}

/// The places of the ones in `mask`, the lowest first.
#[inline(always)]
fn ones(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let i = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (i < MOST).then_some(i)
    })
}
