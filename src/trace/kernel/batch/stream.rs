//! A stream of rays that go down the tree together: a node is visited once for all rays that reach it, so that a
//! branch is taken for many rays at a time (Barringer and Akenine-Moeller, "Dynamic Ray Stream Traversal", 2014;
//! Embree's streams for shadow rays do the same). Where many rays are left, each child is tested against all of
//! them at once; where few are, each of them against all children; a last one goes on by itself.

#![allow(unsafe_code)]

use crate::bvh::limits::TRAVERSAL_STACK;
use crate::bvh::{Child, Link, TriangleBlock, WideNode};
use crate::geometry::{Hit, Ray};
use crate::simd::Avx2;
use crate::simd::vector::Lanes;
use crate::trace::kernel::avx2::packet::{MOST, Mask, Met, Packet};
use crate::trace::kernel::avx2::{FastAvx2, Reciprocal};
use crate::trace::kernel::sound_tree::SoundTree;
use crate::trace::kernel::traverse::{self, Kernel};
use arrayvec::ArrayVec;

/// The places of a stream's rays in the batch.
pub(super) type Places = ArrayVec<u32, MOST>;

/// Visits of a node or a leaf that take as long as to begin and to answer a ray by itself.
const BEGUN: u64 = 4;

/// What the rays of a stream had in common.
pub(super) struct Shared {
    /// Nodes visited by several rays at a time.
    nodes: u64,
    /// Their rays, added up, and [`BEGUN`] for each ray.
    rays: u64,
}

impl Shared {
    /// Whether a node of the stream replaced so many visits of single rays or more, on average.
    #[inline(always)]
    pub(super) fn is_at_least(&self, visits: u64) -> bool {
        self.rays >= visits * self.nodes
    }
}

/// Traces the valid ones of `rays` at `places`, for any hit if `ANY`, else for the closest, and tells `answer` the
/// place and the hit of each; of an any hit it only tells whether there is one.
#[inline(always)]
pub(super) fn run<R: Reciprocal + Lanes, const N: usize, const ANY: bool>(
    avx2: Avx2,
    token: R,
    tree: SoundTree<'_, N>,
    rays: &[Ray],
    places: &Places,
    answer: impl FnMut(usize, Hit),
) -> Shared {
    let mut stream = Stream::new(avx2, token, rays, places);
    let mut shared = Shared { nodes: 0, rays: BEGUN * stream.packet.len() as u64 };
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
            shared.rays += u64::from(rays.count_ones());
            // SAFETY: as above.
            let node = unsafe { tree.node(link.bits() as usize) };
            let base = stack.len();
            let met = stream.meet::<N, ANY>(node, rays);
            let mut children = met.children;
            while children != 0 {
                let slot = children.trailing_zeros() as usize % N;
                children &= children - 1;
                let child = Waiting { link: node.links[slot], entry: met.entry[slot], rays: met.rays[slot] };
                FastAvx2::<R>::prefetch(tree.address(child.link), size_of::<WideNode<N>>());
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
    rays: Mask,
}

/// The valid rays.
struct Stream<R> {
    avx2: Avx2,
    token: R,
    packet: Packet,
    /// The closest hits so far; before the first `t` is the end of the interval.
    hits: [Hit; MOST],
    places: Places,
    /// Those that found any hit.
    done: Mask,
    /// The last end of a ray's interval, which its closest hit so far is; infinite before the first leaf.
    farthest: f32,
}

impl<R: Reciprocal + Lanes> Stream<R> {
    #[inline(always)]
    fn new(avx2: Avx2, token: R, rays: &[Ray], places: &Places) -> Self {
        let mut stream = Self {
            avx2,
            token,
            packet: Packet::new(),
            hits: [Hit { t: f32::NEG_INFINITY, ..Hit::MISS }; MOST],
            places: Places::new(),
            done: 0,
            farthest: f32::INFINITY,
        };
        for &place in places {
            let ray = &rays[place as usize];
            if ray.is_valid() {
                stream.hits[stream.packet.len()].t = ray.tfar;
                stream.packet.push(ray);
                stream.places.push(place);
            }
        }
        Lanes::run(
            token,
            #[inline(always)]
            || stream.packet.prepare(token),
        );
        stream
    }

    /// A bit for each ray.
    #[inline(always)]
    fn all(&self) -> Mask {
        ((1u128 << self.packet.len()) - 1) as Mask
    }

    /// Goes on with ray `i` by itself, from the root of `below`, which it enters at `entry` at the earliest.
    #[inline(always)]
    fn alone<const N: usize, const ANY: bool>(&mut self, below: SoundTree<'_, N>, entry: u32, i: usize) {
        let (kernel, hit) = (self.packet.ray(self.token, i), &mut self.hits[i]);
        if ANY {
            self.done |= Mask::from(traverse::any(kernel, below, hit.t, &mut ())) << i;
        } else if f32::from_bits(entry) <= hit.t {
            let found = traverse::closest(kernel, below, hit.t, &mut ());
            if found.is_hit() {
                *hit = found;
                self.packet.shorten(i, found.t);
            }
        }
    }

    /// The children of `node` that any of `rays` meets.
    #[inline(always)]
    fn meet<const N: usize, const ANY: bool>(&self, node: &WideNode<N>, rays: Mask) -> Met<N> {
        if Packet::is_worth::<R>(rays) {
            Lanes::run(
                self.token,
                #[inline(always)]
                || self.packet.meet::<R, N, ANY>(self.token, node, rays),
            )
        } else {
            self.packet.meet_few::<N, ANY>(self.avx2, node, rays)
        }
    }

    /// Tests `rays` against the blocks of a leaf.
    #[inline(always)]
    fn leaf<const ANY: bool>(&mut self, blocks: &[TriangleBlock], mut rays: Mask) {
        for block in blocks {
            if rays == 0 {
                break;
            }
            let (avx2, token, packet, hits) = (self.avx2, self.token, &mut self.packet, &mut self.hits);
            let hit = if Packet::is_worth::<R>(rays) {
                Lanes::run(
                    token,
                    #[inline(always)]
                    || packet.hit::<R, ANY>(token, block, rays, hits),
                )
            } else {
                packet.hit_few::<R, ANY>(avx2, token, block, rays, hits)
            };
            if ANY {
                self.done |= hit;
            }
            rays &= !self.done;
        }
        if !ANY {
            self.farthest = self.packet.farthest();
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
