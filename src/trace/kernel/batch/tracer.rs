//! Batches as a [`Tracer`], and the choice between streams and interleaved rays.

#[cfg(target_arch = "x86_64")]
use super::interleave;
#[cfg(target_arch = "x86_64")]
use super::stream::{self, Places};
use crate::bvh::WideBvh;
use crate::geometry::{Hit, Ray, Tracer};
#[cfg(target_arch = "x86_64")]
use crate::simd::Avx2;
use crate::simd::Isa;
#[cfg(target_arch = "x86_64")]
use crate::simd::vector::Lanes;
#[cfg(target_arch = "x86_64")]
use crate::trace::kernel::avx2::{FastAvx2, Reciprocal};
#[cfg(target_arch = "x86_64")]
use crate::trace::kernel::scalar::SMALLEST_DIRECTION;
use crate::trace::kernel::sound_tree::{ProvenTree, SoundTree};
use crate::trace::kernel::tracer::{BvhTracer, sound};
use std::slice::{from_mut, from_ref};

/// Traces many rays at once: see the module. Hits are those of [`BvhTracer`] but for the choice among those that
/// are equally close up to rounding; rays that are not valid miss. Rays that go alike should be neighbours, as a
/// camera's are; others may be in any order. Without AVX2 all rays are traced one by one.
#[derive(Clone, Copy, Debug)]
pub struct BatchTracer<'a, const N: usize> {
    tree: SoundTree<'a, N>,
    isa: Isa,
}

/// Rays whose places in a batch have 32 bits.
const AT_ONCE: usize = 1 << 31;
/// A stream is faster than interleaved rays if each of its nodes replaces at least so many visits of single rays, on
/// average: for the closest hit.
#[cfg(target_arch = "x86_64")]
const ENOUGH: u64 = 14;
/// The same for any hit, where children need not be sorted.
#[cfg(target_arch = "x86_64")]
const ENOUGH_FOR_ANY: u64 = 8;
/// Rays that are interleaved after a stream that fell apart, besides those that waited.
#[cfg(target_arch = "x86_64")]
const PAUSE: usize = 15 * 64;

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

    /// Traces the valid ones of `rays`, for any hit if `ANY`, else for the closest, and tells `answer` the place
    /// and the hit of each; false if this processor has no instructions for that, and nothing was done.
    fn run<const ANY: bool>(&self, rays: &[Ray], answer: impl FnMut(usize, Hit)) -> bool {
        match self.isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(token) => {
                self.batch::<_, ANY>(token, token, rays, answer);
                true
            }
            // As with single rays, code for AVX2 was the fastest (on a Zen 4), but for packets.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512(token) => {
                self.batch::<_, ANY>(token.avx2(), token, rays, answer);
                true
            }
            Isa::Scalar => {
                let _ = (rays, answer);
                false
            }
            #[cfg(not(target_arch = "x86_64"))]
            Isa::Avx2(_) | Isa::Avx512(_) => unreachable!("tokens of x86-64 are made there alone"),
        }
    }

    /// Traces streams of rays of one octant of directions, which wait for each other, and interleaves the rays after a
    /// stream that did not stay together.
    #[cfg(target_arch = "x86_64")]
    fn batch<R: Reciprocal + Lanes, const ANY: bool>(
        &self,
        avx2: Avx2,
        token: R,
        rays: &[Ray],
        mut answer: impl FnMut(usize, Hit),
    ) {
        let enough = if ANY { ENOUGH_FOR_ANY } else { ENOUGH };
        avx2.run(
            #[inline(always)]
            || {
                let mut octants = [const { Places::new_const() }; 8];
                let mut at = 0;
                loop {
                    let places = if let Some(ray) = rays.get(at) {
                        let places = &mut octants[octant(ray)];
                        places.push(at as u32);
                        at += 1;
                        if !places.is_full() {
                            continue;
                        }
                        places
                    } else if let Some(places) = octants.iter_mut().find(|places| !places.is_empty()) {
                        places
                    } else {
                        break;
                    };
                    let shared = stream::run::<R, N, ANY>(avx2, token, self.tree, rays, places, &mut answer);
                    places.clear();
                    if shared.is_at_least(enough) {
                        continue;
                    }
                    // The rays that wait are no better.
                    let waiting = octants.iter().flatten().map(|&place| place as usize);
                    let end = rays.len().min(at + PAUSE);
                    interleave::run::<FastAvx2<R>, N, ANY>(
                        avx2,
                        token,
                        self.tree,
                        rays,
                        waiting.chain(at..end),
                        &mut answer,
                    );
                    octants.iter_mut().for_each(Places::clear);
                    at = end;
                }
            },
        );
    }

    /// Finds the closest hits of `rays` and tells `answer` the place and the hit of each that hits, and maybe of
    /// others.
    pub(crate) fn closest_hits(&self, rays: &[Ray], mut answer: impl FnMut(usize, Hit)) {
        for (chunk, rays) in rays.chunks(AT_ONCE).enumerate() {
            let first = chunk * AT_ONCE;
            if !self.run::<false>(rays, |place, hit| answer(first + place, hit)) {
                let singles = self.singles();
                for (place, ray) in rays.iter().enumerate() {
                    let mut hit = Hit::MISS;
                    singles.closest(from_ref(ray), from_mut(&mut hit));
                    answer(first + place, hit);
                }
            }
        }
    }

    /// The tracer of single rays, for processors without AVX2.
    fn singles(&self) -> BvhTracer<'a, N> {
        BvhTracer::of_sound(self.tree, self.isa)
    }
}

/// The octant of its direction, by the signs that the kernels give to its components.
#[cfg(target_arch = "x86_64")]
fn octant(ray: &Ray) -> usize {
    let [x, y, z] = ray.dir.to_array().map(|x| usize::from(x <= -SMALLEST_DIRECTION));
    x | y << 1 | z << 2
}

impl<const N: usize> Tracer for BatchTracer<'_, N> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        hits.fill(Hit::MISS);
        self.closest_hits(rays, |place, hit| hits[place] = hit);
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        occluded.fill(false);
        for (rays, occluded) in rays.chunks(AT_ONCE).zip(occluded.chunks_mut(AT_ONCE)) {
            if !self.run::<true>(rays, |place, hit| occluded[place] = hit.is_hit()) {
                self.singles().any(rays, occluded);
            }
        }
    }
}

impl<const N: usize> ProvenTree<N> {
    /// A tracer of batches over the tree; it costs nothing to make.
    #[inline]
    pub fn batch_tracer(&self) -> BatchTracer<'_, N> {
        BatchTracer { tree: self.sound(), isa: Isa::best() }
    }
}
