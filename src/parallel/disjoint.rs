//! A slice that several threads write at the same time, each in places of its own.

#![allow(unsafe_code)]

use std::marker::PhantomData;

/// A mutable slice shared among threads. Who writes where is the callers' argument, made at each call.
pub(crate) struct DisjointSlice<'a, T> {
    first: *mut T,
    len: usize,
    slice: PhantomData<&'a mut [T]>,
}

// SAFETY: threads reach the elements through the unsafe methods only, whose callers give each element to one thread.
unsafe impl<T: Send> Sync for DisjointSlice<'_, T> {}

impl<'a, T> DisjointSlice<'a, T> {
    /// Shares `slice`.
    pub fn new(slice: &'a mut [T]) -> Self {
        Self { first: slice.as_mut_ptr(), len: slice.len(), slice: PhantomData }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// The elements `first..first + len`.
    ///
    /// # Safety
    /// The range lies within the slice, and nobody else reads or writes any of it while the result lives.
    #[allow(clippy::mut_from_ref)] // disjoint, by the caller's argument
    pub unsafe fn range(&self, first: usize, len: usize) -> &mut [T] {
        debug_assert!(first + len <= self.len);
        // SAFETY: within the slice, and exclusive, as the caller argues.
        unsafe { std::slice::from_raw_parts_mut(self.first.add(first), len) }
    }

    /// Writes element `index`.
    ///
    /// # Safety
    /// `index` lies within the slice, and nobody else reads or writes that element meanwhile.
    #[inline(always)]
    pub unsafe fn write(&self, index: usize, value: T) {
        debug_assert!(index < self.len);
        // SAFETY: within the slice, and exclusive, as the caller argues.
        unsafe { self.first.add(index).write(value) };
    }
}
