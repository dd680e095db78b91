//! Stores past the cache, for what is written once and not read soon: the lines it goes to need not be read before.

#![allow(unsafe_code)]

use glam::Vec4;
use std::mem::MaybeUninit;

/// An element that is so many vectors in memory.
///
/// # Safety
/// It is valid wherever [`Vectors::vectors`] of one lie in its place, at its alignment, which is at least theirs.
pub(crate) unsafe trait Vectors<const N: usize>: Sized {
    /// What lies in its memory, with zeros for padding.
    fn vectors(&self) -> [Vec4; N];
}

/// Writes `from` to `to`, as [`MaybeUninit::write`]; other threads see it only after [`fence`].
#[inline(always)]
pub(crate) fn write<T: Vectors<N>, const N: usize>(to: &mut MaybeUninit<T>, from: &T) {
    const { assert!(size_of::<T>() == N * size_of::<Vec4>() && align_of::<T>() >= align_of::<Vec4>()) };
    let to: *mut Vec4 = to.as_mut_ptr().cast();
    let vectors = from.vectors();
    for (i, &vector) in vectors.iter().enumerate() {
        // SAFETY: the element has as many vectors, as was just asserted, and is borrowed to be written; the
        // processor has these instructions, as every x86-64 has.
        unsafe {
            #[cfg(target_arch = "x86_64")]
            std::arch::x86_64::_mm_stream_ps(to.add(i).cast(), vector.into());
            #[cfg(not(target_arch = "x86_64"))]
            to.add(i).write(vector);
        }
    }
}

/// Lets others see what was written before: such stores wait for no others.
#[inline]
pub(crate) fn fence() {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 has this instruction, which touches no memory of ours.
    unsafe {
        std::arch::x86_64::_mm_sfence();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Link, TriangleBlock, WideNode};

    #[test]
    fn elements_are_written_as_they_are() {
        let mut node = WideNode::<4>::EMPTY;
        let mut block = TriangleBlock::EMPTY;
        for i in 0..12 {
            let x = i as f32 + 0.5;
            node.lower[i / 4][i % 4] = x;
            node.upper[i / 4][i % 4] = -x;
            block.v0[i / 4][i % 4] = x;
            block.e1[i / 4][i % 4] = -x;
            block.e2[i / 4][i % 4] = 2.0 * x;
        }
        node.links = [Link::inner(7), Link::leaf(9, 2), Link::leaf(1 << 20, 7), Link::EMPTY];
        block.prims = [3, 1 << 23 | 1, u32::MAX - 1, u32::MAX];
        let (mut to_node, mut to_block) = (MaybeUninit::uninit(), MaybeUninit::uninit());
        write(&mut to_node, &node);
        write(&mut to_block, &block);
        fence();
        // SAFETY: they were just written.
        let written = unsafe { (to_node.assume_init(), to_block.assume_init()) };
        assert_eq!(written, (node, block));
    }
}
