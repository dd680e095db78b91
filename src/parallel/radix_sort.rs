//! A parallel least-significant-digit radix sort of (code << 32 | triangle) keys by code, and a bucket sort by the
//! highest bits of the codes, which is one pass of it.
//!
//! Each pass counts digits per chunk, gives every chunk its offset in every bucket, and scatters the chunks in
//! parallel. The sort is stable, so the result does not depend on the number of chunks.

#![allow(unsafe_code)]

use super::disjoint::DisjointSlice;
use super::timeline;
use rayon::prelude::*;

const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 1 << DIGIT_BITS;
const PASSES: u32 = 32u32.div_ceil(DIGIT_BITS);
const _: () = assert!(PASSES % 2 == 1);
/// Below this the standard library's sort wins.
const SMALL: usize = 1 << 12;

/// Sorts `keys` by their upper 32 bits, equal ones in their given order, into `sorted`, which is as long.
pub(crate) fn sort(keys: &mut [u64], sorted: &mut [u64]) {
    assert_eq!(keys.len(), sorted.len());
    if keys.len() < SMALL {
        sorted.copy_from_slice(keys);
        sorted.sort_by_key(|&key| key >> 32);
        return;
    }
    let chunk = keys.len().div_ceil(timeline::workers()).max(SMALL);
    let (mut from, mut to) = (keys, sorted);
    // An odd number of passes ends in `sorted`.
    for pass in 0..PASSES {
        scatter::<DIGITS>(from, to, chunk, 32 + pass * DIGIT_BITS);
        std::mem::swap(&mut from, &mut to);
    }
}

/// Bits of the codes that [`bucket_sort`] sorts by (paper 4.7).
pub(crate) const BUCKET_BITS: u32 = 12;

/// Sorts `keys` by the highest [`BUCKET_BITS`] bits of their upper halves alone, equal ones in their given order, into
/// `sorted`, which is as long.
pub(crate) fn bucket_sort(keys: &[u64], sorted: &mut [u64]) {
    assert_eq!(keys.len(), sorted.len());
    let chunk = keys.len().div_ceil(timeline::workers()).max(SMALL);
    scatter::<{ 1 << BUCKET_BITS }>(keys, sorted, chunk, u64::BITS - BUCKET_BITS);
}

#[inline]
fn digit<const BUCKETS: usize>(key: u64, shift: u32) -> usize {
    (key >> shift) as usize & (BUCKETS - 1)
}

/// One pass: moves `from` to `to`, ordered by the digit at `shift`.
fn scatter<const BUCKETS: usize>(from: &[u64], to: &mut [u64], chunk: usize, shift: u32) {
    let mut offsets: Vec<[u32; BUCKETS]> = super::map(from.par_chunks(chunk), |keys| {
        let mut counts = [0u32; BUCKETS];
        keys.iter().for_each(|&key| counts[digit::<BUCKETS>(key, shift)] += 1);
        counts
    });
    // Chunk by chunk, not bucket by bucket: rows of memory, and many chunks cost little.
    let mut starts = [0u32; BUCKETS];
    for counts in &offsets {
        starts.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }
    let mut next = 0;
    starts.iter_mut().for_each(|start| next += std::mem::replace(start, next));
    for counts in &mut offsets {
        for (start, count) in starts.iter_mut().zip(counts) {
            let end = *start + *count;
            *count = std::mem::replace(start, end);
        }
    }
    let to = DisjointSlice::new(to);
    super::for_each(from.par_chunks(chunk).zip(offsets), |(keys, mut offsets)| {
        for &key in keys {
            let place = &mut offsets[digit::<BUCKETS>(key, shift)];
            // SAFETY: the offsets are an exclusive prefix sum of the counts of exactly these keys, over all
            // buckets and chunks, so every key of every chunk has a place of its own below `from.len()`,
            // which is the length of `to`.
            unsafe { to.write(*place as usize, key) };
            *place += 1;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_like_the_standard_library() {
        for n in [0u64, 1, 5, SMALL as u64 - 1, SMALL as u64, 50_000] {
            for mask in [u64::MAX, 0xff, 0, 0xffff_0000] {
                let mix = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32 & mask;
                // Lower halves that do not ascend are none of its business.
                let mut keys: Vec<u64> = (0..n).map(|i| mix(i) << 32 | i ^ 5).collect();
                let mut expected = keys.clone();
                expected.sort_by_key(|key| key >> 32);
                let mut sorted = vec![0; keys.len()];
                let given = keys.clone();
                sort(&mut keys, &mut sorted);
                assert_eq!(sorted, expected);
                expected.clone_from(&given);
                expected.sort_by_key(|key| key >> (64 - BUCKET_BITS));
                bucket_sort(&given, &mut sorted);
                assert_eq!(sorted, expected);
            }
        }
    }
}
