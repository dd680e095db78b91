//! A parallel radix sort of (code << 32 | reference) keys by code.
//!
//! Keys are first dealt to parts, each a range of codes of at most [`PART`] keys. Then each part is sorted by one
//! thread, digit by digit from the lowest, where its core has it in its cache: between cores a key moves once. Both
//! steps keep the order of keys of equal codes, so the result depends neither on parts nor on threads.

#![allow(unsafe_code)]

use super::disjoint::DisjointSlice;
use super::timeline;
use std::mem::MaybeUninit;

const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 1 << DIGIT_BITS;
/// Bits that the paper sorts by (4.7).
pub(crate) const BUCKET_BITS: u32 = 12;
/// Below this the standard library's sort wins.
const SMALL: usize = 1 << 12;
/// Most keys of a part, but for a digit that more of them share.
const PART: usize = 1 << 15;
/// Keys whose places are all found before the first is written. A store to a place that is not known yet holds up the
/// loads behind it.
const BATCH: usize = 8;

/// Sorts `keys` by their upper 32 bits, equal ones in their given order, in memory for as many that is lent.
pub(crate) fn sort(keys: &mut [u64], spare: &mut [MaybeUninit<u64>]) {
    if keys.len() < SMALL {
        keys.sort_by_key(|&key| key >> 32);
    } else {
        let most = (keys.len() / (4 * timeline::workers())).clamp(SMALL, PART);
        sort_lowest(keys, spare, u32::BITS, most);
    }
}

/// Sorts `keys` by the highest [`BUCKET_BITS`] of their codes alone, in one pass, likewise.
pub(crate) fn bucket_sort(keys: &mut [u64], spare: &mut [MaybeUninit<u64>]) {
    let (_, dealt) = deal_to_parts::<{ 1 << BUCKET_BITS }>(keys, spare, u32::BITS, 0);
    super::for_each(keys.chunks_mut(SMALL).zip(dealt.chunks(SMALL)), |(to, from)| to.copy_from_slice(from));
}

/// Sorts `keys` by the lowest `bits` of their codes, the others of which are alike, in parts of at most `most` keys.
fn sort_lowest(keys: &mut [u64], spare: &mut [MaybeUninit<u64>], bits: u32, most: usize) {
    let (parts, dealt) = deal_to_parts::<DIGITS>(keys, spare, bits, most);
    let (mut keys, mut dealt) = (keys, dealt);
    let slices = parts.into_iter().map(|part| {
        let (to, keys_behind) = std::mem::take(&mut keys).split_at_mut(part.keys);
        let (from, dealt_behind) = std::mem::take(&mut dealt).split_at_mut(part.keys);
        (keys, dealt) = (keys_behind, dealt_behind);
        (from, to, part.bits)
    });
    super::for_each(slices, |(from, to, bits)| {
        // Threads share what is much larger, as all that is in one place of a large scene.
        if from.len() > 4 * most && bits > DIGIT_BITS {
            // SAFETY: nothing but keys is written to it.
            let spare = unsafe { &mut *(std::ptr::from_mut(to) as *mut [MaybeUninit<u64>]) };
            sort_lowest(from, spare, bits, most);
            to.copy_from_slice(from);
        } else {
            sort_part(from, to, bits);
        }
    });
}

/// Keys that follow one another once they are sorted.
struct Part {
    keys: usize,
    /// Their codes differ in so many bits, the lowest, at most.
    bits: u32,
}

/// Copies `keys` part by part, by the highest digit of the lowest `bits`, in order, to memory for as many.
fn deal_to_parts<'a, const DIGITS: usize>(
    keys: &[u64],
    memory: &'a mut [MaybeUninit<u64>],
    bits: u32,
    most: usize,
) -> (Vec<Part>, &'a mut [u64]) {
    assert_eq!(keys.len(), memory.len());
    let chunk = keys.len().div_ceil(timeline::workers()).max(SMALL);
    let below = bits - DIGITS.ilog2();
    let digit = |key: u64| digit::<DIGITS>(key, 32 + below);
    let counts: Vec<[u32; DIGITS]> = super::map(keys.chunks(chunk), |keys| count(keys, digit));
    let mut totals = [0; DIGITS];
    for counts in &counts {
        totals.iter_mut().zip(counts).for_each(|(total, &count)| *total += count as usize);
    }
    let mut parts: Vec<Part> = Vec::new();
    let part_of_digit = totals.map(|more| {
        match parts.last_mut() {
            Some(_) if more == 0 => {}
            Some(part) if part.keys + more <= most => *part = Part { keys: part.keys + more, bits },
            _ => parts.push(Part { keys: more, bits: below }),
        }
        parts.len() - 1
    });
    let mut end = 0;
    let begin = |part: &Part| {
        end += part.keys as u32;
        end - part.keys as u32
    };
    let mut begins: Vec<u32> = parts.iter().map(begin).collect();
    let begin_chunk = |counts: &[u32; DIGITS]| {
        let own = begins.clone();
        part_of_digit.iter().zip(counts).for_each(|(&part, count)| begins[part] += count);
        own
    };
    let begins: Vec<Vec<u32>> = counts.iter().map(begin_chunk).collect();
    let dealt = DisjointSlice::new(&mut *memory);
    super::for_each(keys.chunks(chunk).zip(begins), |(keys, mut next)| {
        deal(
            keys,
            &mut next,
            |key| part_of_digit[digit(key)],
            |place, key| {
                // SAFETY: a chunk begins in each part behind the keys that the chunks before it have there, and has as
                // many places as keys: every key of every chunk has a place of its own below `keys.len()`, which is the
                // length of `memory`.
                unsafe { dealt.write(place, MaybeUninit::new(key)) }
            },
        );
    });
    // SAFETY: all keys were dealt, each to a place of its own.
    (parts, unsafe { &mut *(std::ptr::from_mut(memory) as *mut [u64]) })
}

/// Sorts the keys of `from` likewise into `to`, by one thread; `from` is lost.
fn sort_part(from: &mut [u64], to: &mut [u64], bits: u32) {
    let (mut from, mut to) = (from, to);
    let mut is_in_to = false;
    for shift in (32..32 + bits).step_by(DIGIT_BITS as usize) {
        let digit = |key| digit::<DIGITS>(key, shift);
        let mut next: [u32; DIGITS] = count(from, digit);
        if from.first().is_none_or(|&key| next[digit(key)] as usize == from.len()) {
            continue;
        }
        let mut sum = 0;
        next.iter_mut().for_each(|next| sum += std::mem::replace(next, sum));
        deal(from, &mut next, digit, |place, key| to[place] = key);
        std::mem::swap(&mut from, &mut to);
        is_in_to = !is_in_to;
    }
    if !is_in_to {
        to.copy_from_slice(from);
    }
}

#[inline]
fn digit<const DIGITS: usize>(key: u64, shift: u32) -> usize {
    (key >> shift) as usize & (DIGITS - 1)
}

/// How many keys have each digit.
fn count<const DIGITS: usize>(keys: &[u64], digit: impl Fn(u64) -> usize) -> [u32; DIGITS] {
    let mut counts = [0; DIGITS];
    keys.iter().for_each(|&key| counts[digit(key)] += 1);
    counts
}

/// Puts each key in the next place of its bucket.
#[inline(always)]
fn deal(keys: &[u64], next: &mut [u32], bucket: impl Fn(u64) -> usize, mut put: impl FnMut(usize, u64)) {
    let mut place = |key: u64| {
        let next = &mut next[bucket(key)];
        let place = *next as usize;
        *next += 1;
        place
    };
    let (batches, rest) = keys.as_chunks::<BATCH>();
    let mut places = [0; BATCH];
    for batch in batches {
        places.iter_mut().zip(batch).for_each(|(it, &key)| *it = place(key));
        places.iter().zip(batch).for_each(|(&place, &key)| put(place, key));
    }
    rest.iter().for_each(|&key| put(place(key), key));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    /// Keys of these codes, whose lower halves do not ascend: those are none of the sort's business.
    fn is_sorted_as_by_the_standard_library(n: usize, code: impl Fn(u64) -> u64) {
        let mut keys: Vec<u64> = (0..n as u64).map(|i| code(i) << 32 | i ^ 5).collect();
        let mut expected = keys.clone();
        expected.sort_by_key(|key| key >> 32);
        sort(&mut keys, &mut Box::new_uninit_slice(n));
        assert!(keys == expected, "{n} keys");

        let highest = |key: &u64| key >> (u64::BITS - BUCKET_BITS);
        keys.reverse();
        expected.reverse();
        expected.sort_by_key(highest);
        bucket_sort(&mut keys, &mut Box::new_uninit_slice(n));
        assert!(keys == expected, "{n} keys in buckets");
    }

    #[test]
    fn sorts_like_the_standard_library() {
        let mix = |i: u64| random::mix(i) >> 32;
        for n in [0, 1, 5, SMALL - 1, SMALL, 50_000, 300_000] {
            for mask in [u32::MAX, 0xff, 0, 0xffff_0000, 0xfff0_0000, 0x001f_ffff, 0x0000_0400] {
                is_sorted_as_by_the_standard_library(n, |i| mix(i) & u64::from(mask));
            }
            // Nearly all in one place of a large scene.
            is_sorted_as_by_the_standard_library(n, |i| if i % 100 == 0 { mix(i) } else { mix(i) >> 18 });
            is_sorted_as_by_the_standard_library(n, |i| if i % 100 == 0 { mix(i) } else { 7 << 25 });
        }
    }

    #[test]
    fn large_parts_are_dealt_once_more() {
        let keys: Vec<u64> = (0..50_000).map(|i| (5 << 21 | (i % 997) << 10) << 32 | i).collect();
        let mut dealt = Box::new_uninit_slice(keys.len());
        let mut parts = |bits| deal_to_parts::<DIGITS>(&keys, &mut dealt, bits, 1000).0;
        assert!(parts(u32::BITS).iter().any(|part| (part.keys, part.bits) == (keys.len(), 21)));
        let parts = parts(21);
        assert!(parts.len() > 50 && parts.iter().all(|part| part.keys <= 1000));
        assert_eq!(parts.iter().map(|part| part.keys).sum::<usize>(), keys.len());
    }
}
