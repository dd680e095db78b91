//! Nodes and leaf blocks as vectors in memory, for stores past the cache.

#![allow(unsafe_code)]

use super::{IdBlock, TriangleBlock, WideNode};
use crate::memory::stream::Vectors;
use glam::Vec4;

// SAFETY: a node is three lower planes, three upper ones, the links and padding, in this order, each of `N` numbers of
// four bytes, as is asserted; any bits are floats and links.
unsafe impl<const N: usize> Vectors for WideNode<N> {
    #[inline(always)]
    fn for_each(&self, mut write: impl FnMut(usize, Vec4)) {
        const { assert!(N.is_multiple_of(4) && size_of::<Self>() == 8 * N * size_of::<f32>()) };
        for i in 0..N / 4 {
            let four = |plane: &[f32; N]| Vec4::from_slice(&plane[4 * i..]);
            let link = |lane: usize| f32::from_bits(self.links[4 * i + lane].bits());
            for axis in 0..3 {
                write(axis * N / 4 + i, four(&self.lower[axis]));
                write((3 + axis) * N / 4 + i, four(&self.upper[axis]));
            }
            write(6 * N / 4 + i, Vec4::new(link(0), link(1), link(2), link(3)));
            write(7 * N / 4 + i, Vec4::ZERO);
        }
    }
}

// SAFETY: a block is three rows of corners, three of either edge and four numbers, in this order; any bits are floats
// and numbers.
unsafe impl Vectors for TriangleBlock {
    #[inline(always)]
    fn for_each(&self, mut write: impl FnMut(usize, Vec4)) {
        for axis in 0..3 {
            write(axis, self.v0[axis].into());
            write(3 + axis, self.e1[axis].into());
            write(6 + axis, self.e2[axis].into());
        }
        let prim = |lane: usize| f32::from_bits(self.prims[lane]);
        write(9, Vec4::new(prim(0), prim(1), prim(2), prim(3)));
    }
}

// SAFETY: a block is four numbers; any bits are numbers.
unsafe impl Vectors for IdBlock {
    #[inline(always)]
    fn for_each(&self, mut write: impl FnMut(usize, Vec4)) {
        write(0, Vec4::from_array(self.prims.map(f32::from_bits)));
    }
}
