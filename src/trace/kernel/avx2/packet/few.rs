//! Few rays of a packet: a vector of eight lanes holds all children of a node, or all triangles of a block, for one ray
//! or for two.

#![allow(unsafe_code)]

use super::boxes::Met;
use super::triangles::{Planes, cross, test};
use super::{MOST, Mask, Packet, Row};
use crate::bvh::limits::check_width;
use crate::bvh::{TriangleBlock, WideNode};
use crate::geometry::Hit;
use crate::simd::Avx2;
use crate::trace::kernel::avx2::crossing::{Crossing, Reciprocal, reciprocal};
use std::arch::x86_64::*;

impl Packet {
    /// As [`Packet::meet`].
    #[inline(always)]
    pub(in crate::trace::kernel) fn meet_few<const N: usize, const ANY: bool>(
        &self,
        _: Avx2,
        node: &WideNode<N>,
        rays: Mask,
    ) -> Met<N> {
        // SAFETY: the token proves the features.
        unsafe { self.meet_few_enabled::<N, ANY>(node, rays) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn meet_few_enabled<const N: usize, const ANY: bool>(&self, node: &WideNode<N>, rays: Mask) -> Met<N> {
        const { check_width::<N>() };
        let sides = [&node.lower, &node.upper];
        let plane = |axis: usize, upper: bool| eight(&sides[usize::from(upper)][axis]);
        let [x, y, z] = self.near;
        let first = [plane(0, x), plane(1, y), plane(2, z)];
        let last = [plane(0, !x), plane(1, !y), plane(2, !z)];
        // For each child a bit for each ray that meets it, of the first 32 rays and of the others.
        let mut met = [_mm256_setzero_si256(); 2];
        let mut least = _mm256_set1_epi32(-1);
        for (half, met) in met.iter_mut().enumerate() {
            let mut left = (rays >> (32 * half)) as u32;
            while left != 0 {
                let pair = Pair::take(&mut left, 8 / N);
                let [i, j] = pair.places(32 * half);
                let of = |row: &Row| pair.lanes(row, i, j);
                let slab = |planes: &[__m256; 3], axis: usize| {
                    let (rdir, org_rdir) = (of(&self.rdir[axis]), of(&self.org_rdir[axis]));
                    _mm256_castps_si256(_mm256_fmsub_ps(planes[axis], rdir, org_rdir))
                };
                // As for single rays, floats are compared as integers.
                let (tnear, tfar) =
                    (_mm256_castps_si256(of(&self.tnear)), _mm256_castps_si256(of(&self.tfar)));
                let enter = _mm256_max_epi32(
                    _mm256_max_epi32(slab(&first, 0), slab(&first, 1)),
                    _mm256_max_epi32(slab(&first, 2), tnear),
                );
                let leave = _mm256_min_epi32(
                    _mm256_min_epi32(slab(&last, 0), slab(&last, 1)),
                    _mm256_min_epi32(slab(&last, 2), tfar),
                );
                let missed = _mm256_cmpgt_epi32(enter, leave);
                *met = _mm256_or_si256(*met, _mm256_andnot_si256(missed, pair.bits()));
                if !ANY {
                    least = _mm256_min_epu32(least, _mm256_or_si256(enter, missed));
                }
            }
        }
        if N == 4 {
            // Both halves have bits for the same children.
            let swapped = |x: __m256i| _mm256_permute2x128_si256::<1>(x, x);
            met = [_mm256_or_si256(met[0], swapped(met[0])), _mm256_or_si256(met[1], swapped(met[1]))];
            least = _mm256_min_epu32(least, swapped(least));
        }
        let nobody = _mm256_cmpeq_epi32(_mm256_or_si256(met[0], met[1]), _mm256_setzero_si256());
        let children = !_mm256_movemask_ps(_mm256_castsi256_ps(nobody)) as u32 & ((1 << N) - 1);
        let (low, high, least) = (array(met[0]), array(met[1]), array(least));
        Met {
            children,
            rays: std::array::from_fn(|slot| Mask::from(low[slot]) | Mask::from(high[slot]) << 32),
            entry: std::array::from_fn(|slot| if ANY { 0 } else { least[slot] }),
        }
    }

    /// As [`Packet::hit`].
    #[inline(always)]
    pub(in crate::trace::kernel) fn hit_few<R: Reciprocal, const ANY: bool>(
        &mut self,
        avx2: Avx2,
        token: R,
        block: &TriangleBlock,
        rays: Mask,
        hits: &mut [Hit; MOST],
    ) -> Mask {
        // SAFETY: the token proves the features.
        unsafe { self.hit_few_enabled::<R, ANY>(avx2, token, block, rays, hits) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn hit_few_enabled<R: Reciprocal, const ANY: bool>(
        &mut self,
        avx2: Avx2,
        token: R,
        block: &TriangleBlock,
        rays: Mask,
        hits: &mut [Hit; MOST],
    ) -> Mask {
        let three = |rows: &[[f32; 4]; 3]| [eight(&rows[0]), eight(&rows[1]), eight(&rows[2])];
        let (v0, e1, e2) = (three(&block.v0), three(&block.e1), three(&block.e2));
        let planes = Planes { v0, e1, e2, normal: cross(avx2, e2, e1) };
        let mut hit = 0;
        for half in 0..2 {
            let mut left = (rays >> (32 * half)) as u32;
            while left != 0 {
                let pair = Pair::take(&mut left, 2);
                let [i, j] = pair.places(32 * half);
                let of = |row: &Row| pair.lanes(row, i, j);
                let of3 = |rows: &[Row; 3]| [of(&rows[0]), of(&rows[1]), of(&rows[2])];
                let crossing =
                    test(avx2, &planes, of3(&self.org), of3(&self.dir), of(&self.tnear), of(&self.tfar));
                let valid = _mm256_movemask_ps(crossing.valid);
                if valid == 0 {
                    continue;
                }
                for (upper, i) in [i, j].into_iter().enumerate() {
                    if valid >> (4 * upper) & 0xf == 0 {
                        continue;
                    }
                    hit |= 1 << i;
                    if !ANY {
                        let four = |x: __m256| {
                            if upper == 0 { _mm256_castps256_ps128(x) } else { _mm256_extractf128_ps::<1>(x) }
                        };
                        let crossing = Crossing {
                            t: four(crossing.t),
                            u: four(crossing.u),
                            v: four(crossing.v),
                            den: four(crossing.den),
                            valid: four(crossing.valid),
                        };
                        crossing.closest(reciprocal(token, crossing.den), &block.prims, &mut hits[i]);
                        self.tfar[i] = hits[i].t;
                    }
                }
            }
        }
        hit
    }
}

/// One or two of 32 rays, as bits.
#[derive(Clone, Copy)]
struct Pair([u32; 2]);

impl Pair {
    /// Takes the first `count` of those `left`, of which there is one at least: a single one twice.
    #[inline(always)]
    fn take(left: &mut u32, count: usize) -> Self {
        let mut next = || {
            let one = *left & left.wrapping_neg();
            *left ^= one;
            one
        };
        let one = next();
        let other = if count == 2 { next() } else { one };
        Self([one, if other == 0 { one } else { other }])
    }

    /// Their places in a packet in which the first of the 32 is at `first`.
    #[inline(always)]
    fn places(self, first: usize) -> [usize; 2] {
        self.0.map(|bit| (first + bit.trailing_zeros() as usize) % MOST)
    }

    /// The value of the ray at `i` in the lower half, of that at `j` in the upper one.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn lanes(self, row: &Row, i: usize, j: usize) -> __m256 {
        _mm256_blend_ps::<0xf0>(_mm256_set1_ps(row[i]), _mm256_set1_ps(row[j]))
    }

    /// Their bits, likewise.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn bits(self) -> __m256i {
        let [i, j] = self.0;
        _mm256_blend_epi32::<0xf0>(_mm256_set1_epi32(i as i32), _mm256_set1_epi32(j as i32))
    }
}

/// Eight floats, or four of them twice.
#[inline]
#[target_feature(enable = "avx2")]
fn eight<const N: usize>(row: &[f32; N]) -> __m256 {
    const { check_width::<N>() };
    // SAFETY: eight floats or four, as is asserted; neither load needs an alignment.
    unsafe {
        if N == 8 {
            _mm256_loadu_ps(row.as_ptr())
        } else {
            let four = _mm_loadu_ps(row.as_ptr());
            _mm256_set_m128(four, four)
        }
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn array(x: __m256i) -> [u32; 8] {
    let mut out = [0; 8];
    // SAFETY: `out` has room for eight integers.
    unsafe { _mm256_storeu_si256(out.as_mut_ptr().cast(), x) };
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders;
    use crate::geometry::Ray;
    use crate::random::SplitMix64;
    use crate::scene;
    use crate::simd::Isa;

    /// Few rays find what many find, whichever are left.
    fn agree<const N: usize>(avx2: Avx2) {
        let mesh = scene::scalable(2000, 1).mesh;
        let tree = builders::by_name::<N>("lbvh").unwrap().build(&mesh).tree;
        let (low, high) = (tree.bounds.min, tree.bounds.max);
        let mut random = SplitMix64::new(N as u64);
        let mut next = || random.next_u64() as f32 / u64::MAX as f32;
        let mut point = || low + (high - low) * glam::Vec3A::new(next(), next(), next());
        let mut packet = Packet::new();
        for i in 0..MOST {
            // All directions have the same signs.
            let (from, to) = (point(), point());
            let (org, dir) = (from.min(to), (to - from).abs());
            let tfar = if i % 3 == 0 { 0.5 } else { f32::INFINITY };
            packet.push(&Ray { org: org.into(), dir: dir.into(), tnear: 0.0, tfar });
        }
        packet.prepare(avx2);
        let mut random = SplitMix64::new(1);
        let mut masks = vec![1, 1 << 31, 1 << 63, 3 << 31, Mask::MAX];
        masks.extend((0..100).map(|_| random.next_u64() & random.next_u64() & random.next_u64()));
        let (mut met, mut hits) = (0, 0);
        for &rays in masks.iter().filter(|&&rays| rays != 0) {
            for node in &tree.nodes {
                let few = packet.meet_few::<N, false>(avx2, node, rays);
                let many = packet.meet::<_, N, false>(avx2, node, rays);
                assert_eq!((few.rays, few.children), (many.rays, many.children), "{rays:x}");
                assert!((0..N).all(|slot| many.entry[slot] <= few.entry[slot]), "{rays:x}");
                let any = packet.meet_few::<N, true>(avx2, node, rays);
                assert_eq!(any, packet.meet::<_, N, true>(avx2, node, rays), "{rays:x}");
                assert_eq!(any.rays, few.rays);
                met += any.children.count_ones();
            }
            for block in &tree.blocks {
                let mut none = [Hit::MISS; MOST];
                let few = packet.hit_few::<_, true>(avx2, avx2, block, rays, &mut none);
                assert_eq!(few, packet.hit::<_, true>(avx2, block, rays, &mut none), "{rays:x}");
                hits += few.count_ones();
                // The closest, which shorten their rays.
                let (mut few, mut many) = (packet.clone(), packet.clone());
                let [mut of_few, mut of_many] = [none; 2];
                few.hit_few::<_, false>(avx2, avx2, block, rays, &mut of_few);
                many.hit::<_, false>(avx2, block, rays, &mut of_many);
                assert_eq!(of_few, of_many, "{rays:x}");
                assert_eq!(few.farthest(), many.farthest(), "{rays:x}");
            }
        }
        assert!(met > 1000 && hits > 100, "{met} children met and {hits} triangles hit");
    }

    #[test]
    fn few_rays_find_what_many_find() {
        let Some(avx2) = Isa::best().avx2() else { return };
        agree::<4>(avx2);
        agree::<8>(avx2);
    }
}
