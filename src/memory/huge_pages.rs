//! Large arrays on huge pages: first touch of 4 KiB pages costs as much as building. Embree's memory is on
//! huge pages too.

#![allow(unsafe_code)]

use super::OutOfMemory;
use rayon::prelude::*;
use std::mem::MaybeUninit;

/// The size of a huge page. An array of twice this holds one, wherever it begins.
const HUGE_PAGE: usize = 2 << 20;

/// Makes room for `len` elements in all, on huge pages where the system has them and the array is large.
///
/// # Errors
/// No memory for `what`.
pub(crate) fn try_reserve<T>(array: &mut Vec<T>, len: usize, what: &'static str) -> Result<(), OutOfMemory> {
    if array.capacity() >= len {
        return Ok(());
    }
    if array.is_empty() {
        *array = Vec::new();
    }
    // Not by the allocator, which touches the new memory before huge pages are asked for, and copies what is empty.
    let mut longer: Vec<T> = Vec::new();
    longer
        .try_reserve_exact(len)
        .map_err(|_| OutOfMemory { what, bytes: len.saturating_mul(size_of::<T>()) })?;
    if size_of::<T>() * longer.capacity() >= 2 * HUGE_PAGE {
        advise(longer.as_mut_ptr().cast(), size_of::<T>() * longer.capacity());
    }
    longer.append(array);
    *array = longer;
    Ok(())
}

/// The same, which unwinds to [`super::catch_out_of_memory`] where there is no memory.
pub(crate) fn reserve<T>(array: &mut Vec<T>, len: usize, what: &'static str) {
    try_reserve(array, len, what).unwrap_or_else(|error| error.unwind());
}

/// As [`Vec::resize`], on huge pages and on all threads of the current rayon pool: whoever first writes to a page waits
/// until the system has cleared it. Unwinds likewise.
pub(crate) fn resize<T: Copy + Send + Sync>(array: &mut Vec<T>, len: usize, value: T, what: &'static str) {
    resize_with(array, len, || value, what);
}

/// As [`Vec::resize_with`], likewise.
pub(crate) fn resize_with<T: Send>(
    array: &mut Vec<T>,
    len: usize,
    value: impl Fn() -> T + Sync + Send,
    what: &'static str,
) {
    reserve(array, len, what);
    array.truncate(len);
    array.par_extend((array.len()..len).into_par_iter().map(|_| value()));
}

/// An array of `len` times `value`, on this thread; unwinds likewise.
pub(crate) fn filled<T: Clone>(len: usize, value: T, what: &'static str) -> Vec<T> {
    let mut array = Vec::new();
    reserve(&mut array, len, what);
    array.resize(len, value);
    array
}

/// Appends to an array of which nobody knows how long it gets: it doubles where it is full. Unwinds likewise.
#[inline]
pub(crate) fn push<T>(array: &mut Vec<T>, value: T, what: &'static str) {
    if array.len() == array.capacity() {
        make_room(array, 1, what);
    }
    array.push(value);
}

/// Room for `more` elements beyond those of the array, which at least doubles where there is none. Unwinds likewise.
#[cold]
pub(crate) fn make_room<T>(array: &mut Vec<T>, more: usize, what: &'static str) {
    if array.capacity() - array.len() < more {
        let len = array.len() + more.max(array.len());
        reserve(array, len, what);
    }
}

/// Room for `len` others in the memory of an empty array, until it is filled.
pub(crate) fn lend<'a, T, U: Copy>(
    array: &'a mut Vec<T>,
    len: usize,
    what: &'static str,
) -> &'a mut [MaybeUninit<U>] {
    array.clear();
    // One more, should the first be ill aligned.
    reserve(array, (size_of::<U>() * (len + 1)).div_ceil(size_of::<T>()), what);
    // SAFETY: memory that holds nothing may hold nothing of another type.
    let (_, others, _) = unsafe { array.spare_capacity_mut().align_to_mut::<MaybeUninit<U>>() };
    &mut others[..len]
}

#[cfg(target_os = "linux")]
fn advise(start: *mut u8, bytes: usize) {
    let skipped = start.align_offset(HUGE_PAGE);
    if skipped < bytes {
        // SAFETY: the range lies within one allocation, whose contents and validity the advice does not
        // change. Failure (no huge pages on this system) leaves all as it was.
        unsafe {
            libc::madvise(
                start.add(skipped).cast(),
                (bytes - skipped) & !(HUGE_PAGE - 1),
                libc::MADV_HUGEPAGE,
            )
        };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise(_: *mut u8, _: usize) {}

#[cfg(test)]
mod tests {
    #[test]
    fn arrays_behave_as_ever() {
        let mut array = vec![1u64, 2, 3];
        super::resize(&mut array, 1 << 20, 7, "numbers");
        assert_eq!(array[..4], [1, 2, 3, 7]);
        assert_eq!(array.len(), 1 << 20);
        super::resize(&mut array, 2, 0, "numbers");
        super::reserve(&mut array, 10, "numbers");
        assert_eq!(array, [1, 2]);
        (3..100).for_each(|i| super::push(&mut array, i, "numbers"));
        assert_eq!(array, (1..100).collect::<Vec<_>>());
        array.truncate(2);
        assert_eq!(super::filled(2, 5u8, "numbers"), [5, 5]);
        assert_eq!(super::lend::<u64, u16>(&mut array, 5, "numbers").len(), 5);
        assert_eq!(super::lend::<u64, [u64; 3]>(&mut array, 50, "numbers").len(), 50);
        assert!(array.is_empty());
    }
}
