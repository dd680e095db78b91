//! Morton codes (paper 4.7) of 32 bits.
//!
//! The cells are those of a Morton code over the scene's bounding cube, whose leading bits are constant when
//! the scene is flat or long: each bit halves the longest edge of the cell, so that no bit is spent on an axis
//! along which nothing lies apart.

#![allow(unsafe_code)]

use crate::geometry::Aabb;
use glam::Vec3A;

/// Bits of a code.
pub(super) const BITS: u32 = 32;
/// Most bits that one axis may take.
const AXIS_BITS: u32 = 16;

/// Maps points to codes.
pub(super) struct Quantizer {
    origin: Vec3A,
    /// Cells per unit, by axis.
    scale: Vec3A,
    last_cell: Vec3A,
    /// `spread[axis][half][byte]`: the code bits of the low and the high byte of a cell number.
    spread: Box<[[[u32; 256]; 2]; 3]>,
}

impl Quantizer {
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
        let cells = Vec3A::from_array(bits.map(|b| (1u32 << b) as f32));
        // A subnormal or zero extent would give an infinite scale, and infinity times zero is no cell.
        let scale = Vec3A::select(extent.cmpgt(Vec3A::splat(1e-30)), cells / extent, Vec3A::ZERO);
        Self { origin: centers.min, scale, last_cell: cells - 1.0, spread }
    }

    /// The code of a point; points outside get the nearest cell's.
    #[inline]
    pub fn code(&self, point: Vec3A) -> u32 {
        let cell = ((point - self.origin) * self.scale).max(Vec3A::ZERO).min(self.last_cell);
        // SAFETY: the cell lies between zero and `last_cell`, below 2^16; a NaN, which a finite point cannot give,
        // would have become zero.
        let [x, y, z] = cell.to_array().map(|c| unsafe { c.to_int_unchecked::<i32>() } as usize);
        let [sx, sy, sz] = &*self.spread;
        (sx[0][x & 255] | sx[1][x >> 8]) | (sy[0][y & 255] | sy[1][y >> 8]) | (sz[0][z & 255] | sz[1][z >> 8])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_interleaves_x_y_z() {
        let quantizer = Quantizer::new(Aabb::new(Vec3A::ZERO, Vec3A::ONE));
        assert_eq!(quantizer.code(Vec3A::ZERO), 0);
        assert_eq!(quantizer.code(Vec3A::ONE), u32::MAX);
        assert_eq!(quantizer.code(Vec3A::new(0.6, 0.0, 0.0)) >> 29, 0b100);
        assert_eq!(quantizer.code(Vec3A::new(0.0, 0.6, 0.0)) >> 29, 0b010);
        assert_eq!(quantizer.code(Vec3A::new(0.0, 0.0, 0.6)) >> 29, 0b001);
    }

    #[test]
    fn a_flat_scene_spends_no_bit_on_its_height() {
        let quantizer = Quantizer::new(Aabb::new(Vec3A::ZERO, Vec3A::new(8.0, 4.0, 0.0)));
        assert_eq!(quantizer.code(Vec3A::new(8.0, 4.0, 0.0)), u32::MAX);
        assert_eq!(quantizer.code(Vec3A::new(4.1, 0.0, 0.0)) >> 30, 0b10);
        assert_eq!(quantizer.code(Vec3A::new(2.1, 2.1, 0.0)) >> 29, 0b011);
    }

    #[test]
    fn codes_are_monotone_along_each_axis_and_total_on_a_point() {
        let quantizer = Quantizer::new(Aabb::new(Vec3A::splat(-3.0), Vec3A::new(5.0, 1.0, 100.0)));
        for axis in 0..3 {
            let code = |i: i32| {
                let mut p = Vec3A::splat(-3.0);
                p[axis] += i as f32 * 0.37;
                quantizer.code(p)
            };
            assert!((0..400).all(|i| code(i) <= code(i + 1)));
        }
        let point = Quantizer::new(Aabb::new(Vec3A::ONE, Vec3A::ONE));
        assert_eq!(point.code(Vec3A::ONE), 0);
    }
}
