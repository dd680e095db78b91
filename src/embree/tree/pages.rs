//! Memory for a tree that is laid out once and traced: fresh from the system, on huge pages where it has them, as
//! Embree's own memory is.
//!
//! An allocator would reuse freed memory, on huge pages or not; the difference costs traversal several per cent.

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
    elements: std::marker::PhantomData<T>,
}

impl<T: Copy> Pages<T> {
    /// Memory for `capacity` elements.
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
        Ok(Self { map, skipped, len: 0, elements: std::marker::PhantomData })
    }

    /// Appends an element, for which there must be room.
    pub fn push(&mut self, element: T) {
        let first = self.skipped + self.len * size_of::<T>();
        let place = &mut self.map[first..first + size_of::<T>()];
        // SAFETY: as many bytes as an element has, which nobody else refers to; they are aligned, as the first
        // element's are.
        unsafe { place.as_mut_ptr().cast::<T>().write(element) };
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_stay_where_they_are_put() {
        let mut pages = Pages::<[u32; 3]>::with_capacity(300_000).unwrap();
        let start = pages.start();
        assert_eq!(start.addr() % HUGE, 0);
        assert!(pages.is_empty());
        (0..300_000).for_each(|i| pages.push([i, i + 1, i + 2]));
        pages[7][1] = 0;
        assert_eq!((pages.start(), pages.as_ptr(), pages.len()), (start, start, 300_000));
        assert!(pages.iter().enumerate().all(|(i, element)| element[0] == i as u32));
        assert_eq!((pages[7], pages[299_999]), ([7, 0, 9], [299_999, 300_000, 300_001]));
        assert!(Pages::<u64>::with_capacity(0).unwrap().is_empty());
    }
}
