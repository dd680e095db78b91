//! Stores past the cache, for what is written once and not read soon: the lines it goes to need not be read before.

#![allow(unsafe_code)]

use glam::Vec4;
use std::mem::MaybeUninit;

/// An element that is a number of vectors in memory.
///
/// # Safety
/// [`Vectors::for_each`] writes each of the element's vectors, and no others; where they lie in its place, at its
/// alignment, it is valid.
pub unsafe trait Vectors: Sized {
    /// Hands each vector of its memory to `write`, with its index and with zeros for padding.
    fn for_each(&self, write: impl FnMut(usize, Vec4));
}

/// Writes `from` to `to`, as [`MaybeUninit::write`]; other threads see it only after [`fence`].
#[inline(always)]
pub(crate) fn write<T: Vectors>(to: &mut MaybeUninit<T>, from: &T) {
    const { assert!(size_of::<T>().is_multiple_of(size_of::<Vec4>()) && align_of::<T>() >= align_of::<Vec4>()) };
    let to: *mut Vec4 = to.as_mut_ptr().cast();
    from.for_each(
        #[inline(always)]
        |i, vector| {
            // SAFETY: the element has a vector `i`, as the trait promises, and is borrowed to be written; the
            // processor has these instructions, as every x86-64 has.
            unsafe {
                #[cfg(all(target_arch = "x86_64", not(miri)))]
                std::arch::x86_64::_mm_stream_ps(to.add(i).cast(), vector.into());
                // Miri has no such stores.
                #[cfg(any(not(target_arch = "x86_64"), miri))]
                to.add(i).write(vector);
            }
        },
    );
}

/// Lets others see what was written before: such stores wait for no others.
#[inline]
pub(crate) fn fence() {
    #[cfg(all(target_arch = "x86_64", not(miri)))]
    // SAFETY: every x86-64 has this instruction, which touches no memory of ours.
    unsafe {
        std::arch::x86_64::_mm_sfence();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Link, TriangleBlock, WideNode};

    fn written<T: Vectors>(from: &T) -> T {
        let mut to = MaybeUninit::uninit();
        write(&mut to, from);
        fence();
        // SAFETY: it was just written.
        unsafe { to.assume_init() }
    }

    fn node<const N: usize>() -> WideNode<N> {
        let mut node = WideNode::EMPTY;
        for slot in 0..N {
            for axis in 0..3 {
                node.lower[axis][slot] = (axis * N + slot) as f32 + 0.5;
                node.upper[axis][slot] = -node.lower[axis][slot];
            }
            node.links[slot] = [Link::inner(7 + slot), Link::leaf(9, 2), Link::EMPTY][slot % 3];
        }
        node
    }

    #[test]
    fn elements_are_written_as_they_are() {
        let mut block = TriangleBlock::EMPTY;
        for i in 0..12 {
            let x = i as f32 + 0.5;
            block.v0[i / 4][i % 4] = x;
            block.e1[i / 4][i % 4] = -x;
            block.e2[i / 4][i % 4] = 2.0 * x;
        }
        block.prims = [3, 1 << 23 | 1, u32::MAX - 1, u32::MAX];
        assert_eq!(written(&block), block);
        assert_eq!(written(&node::<4>()), node::<4>());
        assert_eq!(written(&node::<8>()), node::<8>());
    }
}
