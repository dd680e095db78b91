//! Memory for a tree that is laid out once and traced: fresh from the system, on huge pages where it has them, as
//! Embree's own memory is.
//!
//! An allocator would hand out what was freed before, on whatever pages that was, in the same order in every round of a
//! benchmark: one tree would trace several per cent faster than another for no merit of its own, round after round.

#![allow(unsafe_code)]

use super::layout::Unavailable;
use std::ops::{Deref, DerefMut};

/// Bytes of a huge page.
const HUGE: usize = 2 << 20;

/// An array that never moves, of a capacity given once.
pub(super) struct Pages<T> {
    map: memmap2::MmapMut,
    /// Bytes before the first element: it lies where a huge page begins.
    skipped: usize,
    len: usize,
    capacity: usize,
    elements: std::marker::PhantomData<T>,
}

impl<T: Copy> Pages<T> {
    /// Room for so many elements.
    ///
    /// # Errors
    /// No memory.
    pub fn with_capacity(capacity: usize) -> Result<Self, Unavailable> {
        const { assert!(align_of::<T>() <= HUGE) };
        let bytes = (capacity * size_of::<T>()).next_multiple_of(HUGE) + HUGE;
        let map = memmap2::MmapMut::map_anon(bytes)
            .or_else(|why| Unavailable::because(format_args!("there are no {bytes} bytes for it: {why}")))?;
        // Without huge pages it is slower, and no worse otherwise.
        #[cfg(target_os = "linux")]
        let _ = map.advise(memmap2::Advice::HugePage);
        let skipped = map.as_ptr().align_offset(HUGE);
        Ok(Self { map, skipped, len: 0, capacity, elements: std::marker::PhantomData })
    }

    /// Appends an element, for which there must be room.
    pub fn push(&mut self, element: T) {
        assert!(self.len < self.capacity, "more elements than there is room for");
        let place = self.start().wrapping_add(self.len).cast_mut();
        // SAFETY: the place lies within the map, as capacity elements and the bytes skipped do, and is aligned; nobody
        // else refers to it, as `self` is borrowed mutably.
        unsafe { place.write(element) };
        self.len += 1;
    }

    /// Address of the first element, which stays.
    pub fn start(&self) -> *const T {
        self.map.as_ptr().wrapping_add(self.skipped).cast()
    }
}

impl<T> Deref for Pages<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        let start = self.map.as_ptr().wrapping_add(self.skipped).cast();
        // SAFETY: `len` elements were written there.
        unsafe { std::slice::from_raw_parts(start, self.len) }
    }
}

impl<T> DerefMut for Pages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        let start = self.map.as_mut_ptr().wrapping_add(self.skipped).cast();
        // SAFETY: `len` elements were written there, and `self` is borrowed mutably.
        unsafe { std::slice::from_raw_parts_mut(start, self.len) }
    }
}
