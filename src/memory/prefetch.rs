//! A prefetch hint for one array element.

#![allow(unsafe_code)]

/// Prefetches the cache line of `array[index]`; does nothing beyond the end of the array.
#[inline]
pub(crate) fn line<T>(array: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if index < array.len() {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: the address lies within the array; a prefetch reads nothing and cannot fault.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(array.as_ptr().add(index).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (array, index);
}
