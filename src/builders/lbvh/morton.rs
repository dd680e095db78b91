//! Morton codes (paper 4.7) of 32 bits.
//!
//! Each bit halves the longest edge of the cell, the scene's box at first, so that no bit is spent on an axis along
//! which nothing lies apart. An axis gets at most 16 bits, as its table has two bytes.

#![allow(unsafe_code)]

use crate::bvh::limits::MORTON_BITS as BITS;
use crate::geometry::Aabb;
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Isa};
use glam::Vec3A;

/// Most bits that one axis may take.
const AXIS_BITS: u32 = 16;

/// Maps points to codes.
pub(crate) struct MortonEncoder {
    origin: Vec3A,
    /// Cells per unit, by axis.
    scale: Vec3A,
    last_cell: Vec3A,
    /// `spread[axis][half][byte]`: the code bits of the low and the high byte of a cell number.
    spread: Box<[[[u32; 256]; 2]; 3]>,
    /// The code bits of each axis.
    #[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
    bits: [u32; 3],
}

impl MortonEncoder {
    /// Codes for points inside `centers`.
    pub fn new(centers: Aabb) -> Self {
        let extent = centers.extent().max(Vec3A::ZERO);
        let mut cell = extent;
        let mut bits = [0u32; 3];
        // axis_of_bit[k]: the axis that code bit BITS - 1 - k halves.
        let mut axis_of_bit = Vec::with_capacity(BITS as usize);
        for _ in 0..BITS {
            let longest = (0..3)
                .filter(|&axis| bits[axis] < AXIS_BITS && cell[axis] > 0.0)
                .max_by(|&a, &b| cell[a].total_cmp(&cell[b]).then(b.cmp(&a)));
            let Some(axis) = longest else { break };
            axis_of_bit.push(axis);
            bits[axis] += 1;
            cell[axis] *= 0.5;
        }
        let mut spread = Box::new([[[0u32; 256]; 2]; 3]);
        let mut left = bits;
        for (k, &axis) in axis_of_bit.iter().enumerate() {
            left[axis] -= 1;
            let (half, bit) = (left[axis] / 8, left[axis] % 8);
            for (byte, code) in spread[axis][half as usize].iter_mut().enumerate() {
                if byte >> bit & 1 == 1 {
                    *code |= 1 << (BITS - 1 - k as u32);
                }
            }
        }
        let bits_of = |axis: &[[u32; 256]; 2]| axis[0][255] | axis[1][255];
        let all = [bits_of(&spread[0]), bits_of(&spread[1]), bits_of(&spread[2])];
        let cells = Vec3A::from_array(bits.map(|b| (1u32 << b) as f32));
        // An extent whose square underflows gets one cell: areas are zero there, too. A subnormal one would give an
        // infinite scale, and infinity times zero is no cell.
        let scale = Vec3A::select(extent.cmpgt(Vec3A::splat(1e-30)), cells / extent, Vec3A::ZERO);
        Self { origin: centers.min, scale, last_cell: cells - 1.0, spread, bits: all }
    }

    /// The cell of a point; points outside get the nearest.
    #[inline(always)]
    fn cell(&self, point: Vec3A) -> [u32; 3] {
        let cell = ((point - self.origin) * self.scale).max(Vec3A::ZERO).min(self.last_cell);
        // SAFETY: the cell lies between zero and `last_cell`, below 2^16; a finite point gives no NaN.
        cell.to_array().map(|c| unsafe { c.to_int_unchecked::<i32>() } as u32)
    }

    /// The code of a point; points outside get the nearest cell's.
    #[inline]
    pub fn code(&self, point: Vec3A) -> u32 {
        let [x, y, z] = self.cell(point).map(|c| c as usize);
        let [sx, sy, sz] = &*self.spread;
        (sx[0][x & 255] | sx[1][x >> 8]) | (sy[0][y & 255] | sy[1][y >> 8]) | (sz[0][z & 255] | sz[1][z >> 8])
    }

    /// Calls `write` with the code of each point, once and in turn.
    #[inline]
    pub fn codes(&self, points: impl Iterator<Item = Vec3A>, write: impl FnMut(u32)) {
        // Some processors that have AVX2 but no AVX-512 take long to deposit bits; those with AVX-512 do not. Codes
        // are the same either way, so this is not left to the instructions that a builder was given.
        #[cfg(target_arch = "x86_64")]
        if let Isa::Avx512(token) = Isa::best() {
            return self.codes_deposited(token.avx2(), points, write);
        }
        points.map(|point| self.code(point)).for_each(write);
    }

    #[cfg(target_arch = "x86_64")]
    fn codes_deposited(&self, token: Avx2, points: impl Iterator<Item = Vec3A>, mut write: impl FnMut(u32)) {
        token.run(
            #[inline(always)]
            move || {
                for point in points {
                    let [x, y, z] = self.cell(point);
                    let [bx, by, bz] = self.bits;
                    write(token.deposit(x, bx) | token.deposit(y, by) | token.deposit(z, bz));
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn a_cube_interleaves_x_y_z() {
        let encoder = MortonEncoder::new(Aabb::new(Vec3A::ZERO, Vec3A::ONE));
        assert_eq!(encoder.code(Vec3A::ZERO), 0);
        assert_eq!(encoder.code(Vec3A::ONE), u32::MAX);
        assert_eq!(encoder.code(Vec3A::new(0.6, 0.0, 0.0)) >> 29, 0b100);
        assert_eq!(encoder.code(Vec3A::new(0.0, 0.6, 0.0)) >> 29, 0b010);
        assert_eq!(encoder.code(Vec3A::new(0.0, 0.0, 0.6)) >> 29, 0b001);
    }

    #[test]
    fn a_flat_scene_spends_no_bit_on_its_height() {
        let encoder = MortonEncoder::new(Aabb::new(Vec3A::ZERO, Vec3A::new(8.0, 4.0, 0.0)));
        assert_eq!(encoder.code(Vec3A::new(8.0, 4.0, 0.0)), u32::MAX);
        assert_eq!(encoder.code(Vec3A::new(4.1, 0.0, 0.0)) >> 30, 0b10);
        assert_eq!(encoder.code(Vec3A::new(2.1, 2.1, 0.0)) >> 29, 0b011);
    }

    #[test]
    fn codes_are_monotone_along_each_axis_and_total_on_a_point() {
        let encoder = MortonEncoder::new(Aabb::new(Vec3A::splat(-3.0), Vec3A::new(5.0, 1.0, 100.0)));
        for axis in 0..3 {
            let code = |i: i32| {
                let mut p = Vec3A::splat(-3.0);
                p[axis] += i as f32 * 0.37;
                encoder.code(p)
            };
            assert!((0..400).all(|i| code(i) <= code(i + 1)));
        }
        let point = MortonEncoder::new(Aabb::new(Vec3A::ONE, Vec3A::ONE));
        assert_eq!(point.code(Vec3A::ONE), 0);
    }

    #[test]
    fn codes_are_the_same_one_at_a_time_and_in_a_row() {
        let (low, high) = (Vec3A::new(-3.0, 0.5, 0.0), Vec3A::new(1.0, 700.0, 9.0));
        let encoder = MortonEncoder::new(Aabb::new(low, high));
        let point = |i: u32| low + (high - low) * Vec3A::from(SplitMix64::new(i.into()).point(0.0, 1.0));
        let (mut codes, expected) = (Vec::new(), (0..1000).map(|i| encoder.code(point(i))));
        encoder.codes((0..1000).map(point), |code| codes.push(code));
        assert!(codes.iter().copied().eq(expected));
    }
}
