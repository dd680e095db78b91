//! Batches as a [`Tracer`], and the choice between groups and interleaved rays.

#![allow(unsafe_code)]

use super::group::{Bounds, Packet, SIZE};
#[cfg(target_arch = "x86_64")]
use super::interleave;
use super::traverse::{Stack, Traversal};
use crate::bvh::{Link, TriangleBlock, WideBvh};
use crate::geometry::{Hit, Ray, Tracer};
use crate::simd::vector::Lanes;
use crate::simd::{Avx2, Isa};
#[cfg(target_arch = "x86_64")]
use crate::trace::kernel::avx2::FastAvx2;
use crate::trace::kernel::sound_tree::{ProvenTree, SoundTree};
use crate::trace::kernel::tracer::{BvhTracer, sound};
#[cfg(target_arch = "x86_64")]
use crate::trace::kernel::traverse::Kernel;
use std::slice::{from_mut, from_ref};

/// Traces many rays at once: see the module. Hits are those of [`BvhTracer`] but for rounding, rays that are not valid
/// miss. Rays that go alike should be neighbours, as a camera's are; others may be in any order. Without AVX2 all rays are
/// traced one by one.
#[derive(Clone, Copy, Debug)]
pub struct BatchTracer<'a, const N: usize> {
    tree: SoundTree<'a, N>,
    isa: Isa,
}

/// Up to so many rays of a group go on as single rays.
const FEW: u32 = 4;
/// Rays that are not tried as groups after one that scattered.
const PAUSE: usize = 31 * SIZE;

/// Where the answers go: hits, or whether there is one.
trait Answers {
    const ANY: bool;
    fn set(&mut self, index: usize, hit: Hit);
    /// Answers one ray.
    fn single(&mut self, index: usize, tracer: &impl Tracer, ray: &Ray);
}

impl Answers for &mut [Hit] {
    const ANY: bool = false;

    #[inline(always)]
    fn set(&mut self, index: usize, hit: Hit) {
        self[index] = hit;
    }

    fn single(&mut self, index: usize, tracer: &impl Tracer, ray: &Ray) {
        tracer.closest(from_ref(ray), from_mut(&mut self[index]));
    }
}

impl Answers for &mut [bool] {
    const ANY: bool = true;

    #[inline(always)]
    fn set(&mut self, index: usize, hit: Hit) {
        self[index] = hit.is_hit();
    }

    fn single(&mut self, index: usize, tracer: &impl Tracer, ray: &Ray) {
        tracer.any(from_ref(ray), from_mut(&mut self[index]));
    }
}

impl<'a, const N: usize> BatchTracer<'a, N> {
    /// A tracer over `tree`, 4-wide or 8-wide, with the best instructions of this machine.
    ///
    /// # Panics
    /// As [`BvhTracer::new`].
    pub fn new(tree: &'a WideBvh<N>) -> Self {
        Self::with_isa(tree, Isa::best())
    }

    /// As [`BatchTracer::new`] with instructions of choice.
    ///
    /// # Panics
    /// As [`BvhTracer::new`].
    pub fn with_isa(tree: &'a WideBvh<N>, isa: Isa) -> Self {
        Self { tree: sound(tree), isa }
    }

    /// The instructions in use.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Traces all of `rays` into `answers`, which hold misses.
    fn run<A: Answers>(&self, rays: &[Ray], mut answers: A) {
        match self.isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => self.batch::<FastAvx2<_>, _, _>(token, token, token, rays, answers),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(token) => {
                self.batch::<FastAvx2<_>, _, _>(token.avx2(), token, token, rays, answers);
            }
            _ => {
                let tracer = BvhTracer::of_sound(self.tree, self.isa);
                for (index, ray) in rays.iter().enumerate().filter(|(_, ray)| ray.is_valid()) {
                    answers.single(index, &tracer, ray);
                }
            }
        }
    }

    /// Chooses for each run of neighbours.
    #[cfg(target_arch = "x86_64")]
    fn batch<K: Kernel<Block = TriangleBlock>, L: Lanes, A: Answers>(
        &self,
        avx2: Avx2,
        setup: K::Setup,
        lanes: L,
        rays: &[Ray],
        mut answers: A,
    ) {
        // Up to here all rays are answered, and from here on they may be tried as groups.
        let (mut answered, mut from) = (0, 0);
        let mut groups = None;
        let mut at = 0;
        while at < rays.len() {
            let group = &rays[at..rays.len().min(at + SIZE)];
            if at >= from && group.len() == SIZE && is_of_one_octant(group) {
                self.interleaved::<K, A>(avx2, setup, &rays[answered..at], answered, &mut answers);
                let groups = groups.get_or_insert_with(Groups::new);
                let scattered = lanes.run(
                    #[inline(always)]
                    || self.group(lanes, groups, group, at, &mut answers),
                );
                answered = at + SIZE;
                if scattered > SIZE / 2 {
                    from = answered + PAUSE;
                }
            }
            at += group.len();
        }
        self.interleaved::<K, A>(avx2, setup, &rays[answered..], answered, &mut answers);
    }

    /// Traces rays of any kind; the first of them has place `first`. As with single rays, code for AVX2 is the fastest.
    #[cfg(target_arch = "x86_64")]
    fn interleaved<K: Kernel<Block = TriangleBlock>, A: Answers>(
        &self,
        avx2: Avx2,
        setup: K::Setup,
        rays: &[Ray],
        first: usize,
        answers: &mut A,
    ) {
        if rays.is_empty() {
            return;
        }
        avx2.run(
            #[inline(always)]
            || {
                let set = |index, hit| answers.set(first + index, hit);
                if A::ANY {
                    interleave::run::<K, N, true>(avx2, setup, self.tree, rays, set);
                } else {
                    interleave::run::<K, N, false>(avx2, setup, self.tree, rays, set);
                }
            },
        );
    }

    /// Traces a group; returns how often one of its rays went on as a single ray.
    #[inline(always)]
    fn group<L: Lanes, A: Answers>(
        &self,
        lanes: L,
        groups: &mut Groups,
        group: &[Ray],
        first: usize,
        answers: &mut A,
    ) -> usize {
        let mut bounds = Bounds::EMPTY;
        for (place, ray) in group.iter().enumerate() {
            let rdir = bounds.add(ray);
            groups.packets[place / L::N].set(place % L::N, ray, rdir);
        }
        let packets = &mut groups.packets[..SIZE / L::N];
        let tree = self.tree;
        let mut traversal = Traversal { lanes, tree, packets, bounds, few: FEW, stack: &mut groups.stack };
        let mut scattered = 0;
        let single = |packets: &mut [Packet], link: Link, met: u64| {
            scattered += met.count_ones() as usize;
            self.singles::<L, A>(packets, link, met)
        };
        let hit = if A::ANY {
            traversal.run::<true>(u64::MAX, single)
        } else {
            traversal.run::<false>(u64::MAX, single)
        };
        for place in 0..SIZE {
            let found = traversal.packets[place / L::N].hit(place % L::N);
            answers.set(first + place, if hit >> place & 1 == 1 { Hit { prim: 0, ..found } } else { found });
        }
        scattered
    }

    /// Goes on with the rays `met` of a group below `link`, one by one; returns those that hit.
    fn singles<L: Lanes, A: Answers>(&self, packets: &mut [Packet], link: Link, mut met: u64) -> u64 {
        // SAFETY: the traversal reached `link` from the root.
        let tracer = BvhTracer::of_sound(unsafe { self.tree.below(link) }, self.isa);
        let mut hit = 0;
        while met != 0 {
            let place = met.trailing_zeros() as usize;
            met &= met - 1;
            let (packet, lane) = (&mut packets[place / L::N], place % L::N);
            let rays = [packet.ray(lane)];
            if A::ANY {
                let mut occluded = [false];
                tracer.any(&rays, &mut occluded);
                hit |= u64::from(occluded[0]) << place;
            } else {
                let mut found = [Hit::MISS];
                tracer.closest(&rays, &mut found);
                if found[0].is_hit() {
                    packet.set_hit(lane, &found[0]);
                }
            }
        }
        hit
    }
}

/// Whether all are valid and the signs of their directions the same.
fn is_of_one_octant(rays: &[Ray]) -> bool {
    let octant = |ray: &Ray| ray.dir.to_array().map(|x| x < 0.0);
    let first = octant(&rays[0]);
    // Without short-circuits, so that this compiles to vector code.
    rays.iter().fold(true, |all, ray| all & ray.is_valid() & (octant(ray) == first))
}

/// Memory that groups share.
struct Groups {
    packets: [Packet; SIZE / 8],
    stack: Stack,
}

impl Groups {
    fn new() -> Self {
        Self { packets: [const { Packet::EMPTY }; SIZE / 8], stack: Stack::new() }
    }
}

impl<const N: usize> Tracer for BatchTracer<'_, N> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        hits.fill(Hit::MISS);
        self.run(rays, hits);
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        occluded.fill(false);
        self.run(rays, occluded);
    }
}

impl<const N: usize> ProvenTree<N> {
    /// A tracer of batches over the tree; it costs nothing to make.
    #[inline]
    pub fn batch_tracer(&self) -> BatchTracer<'_, N> {
        BatchTracer { tree: self.sound(), isa: Isa::best() }
    }
}
