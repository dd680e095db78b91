//! The level at which an LBVH separates two neighbours in a run of sorted keys (the deltas of Karras 2012): all that
//! its topology depends on, with full leaves too.
//!
//! A delta is a byte, so that a vector holds many. Below a common ancestor two neighbours are separated once, where
//! their codes differ in the highest bit, or, below that, where references of one code are partitioned by the
//! middle.

use super::key::{MortonKey, code};

/// Before the first reference and after the last.
const END: u8 = u8::MAX;
/// Of neighbours of one code that the radix tree does not separate; full leaves may.
const EQUAL: u8 = 0;
/// Neighbours that are partitioned by the middle have lower deltas than this.
const MIDDLE: u8 = 126;
/// Deltas beyond either end, so that windows may reach over it.
const PAD: usize = MOST - 1;
/// Most references of a subtree that is looked for.
const MOST: usize = 16;
/// Deltas that are compared at a time.
const ABREAST: usize = 32;

/// The deltas of a run.
#[derive(Default)]
pub(crate) struct Deltas {
    /// `padded[PAD + i]`: of references i - 1 and i.
    padded: Vec<u8>,
    /// Whether reference i is the first of a subtree, or all end before it.
    is_first: Vec<bool>,
    /// The number of deltas, those at both ends included.
    count: usize,
}

impl Deltas {
    /// Computes the deltas of sorted keys.
    pub fn of_codes(&mut self, keys: &[MortonKey]) {
        self.count = keys.len() + 1;
        self.padded.clear();
        self.padded.resize(self.count.next_multiple_of(ABREAST) + 2 * PAD, END);
        let deltas = &mut self.padded[PAD + 1..];
        for ((delta, &before), &after) in deltas.iter_mut().zip(keys).zip(&keys[1..]) {
            *delta = delta_of(code(before) ^ code(after));
        }
    }

    /// The first references of one code, of which there are three or more, from `begin` on.
    pub fn equal_codes(&self, begin: usize) -> Option<std::ops::Range<usize>> {
        const MANY: usize = 64;
        let deltas = &self.padded[PAD + begin..];
        // Few codes are that common: many deltas are passed over at once.
        let pairs = deltas.chunks(MANY).zip(deltas[1..].chunks(MANY));
        let least = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).fold(END, |least, (a, b)| least.min(a | b));
        let passed = MANY * pairs.take_while(|pairs| least(pairs) != EQUAL).count();
        let second =
            passed + deltas[passed.min(deltas.len())..].windows(2).position(|pair| pair == [EQUAL; 2])?;
        let others = deltas[second..].iter().take_while(|&&delta| delta == EQUAL).count();
        Some(begin + second - 1..begin + second + others)
    }

    /// Separates references of one code, partitioned by the middle `depth` times before, in front of `split`.
    pub fn separate_by_middle(&mut self, split: usize, depth: u32) {
        self.padded[PAD + split] = MIDDLE - depth as u8;
    }

    /// The delta of `reference` and the one before.
    pub fn before(&self, reference: usize) -> u8 {
        self.padded[PAD + reference]
    }

    /// The deltas before `reference` and before the references after it.
    pub fn from(&self, reference: usize) -> &[u8; MOST] {
        self.padded[PAD + reference..].first_chunk().expect("there are more beyond the end")
    }

    /// Finds the largest subtrees of at most `most` references, which are no more than `WINDOW`.
    ///
    /// On either side of a delta, its subtree has one reference more than there are lower deltas in a row. No branch
    /// depends on a delta.
    #[inline(always)]
    pub fn find_subtrees<const WINDOW: usize>(&mut self, most: u32) {
        const { assert!(WINDOW <= MOST) };
        debug_assert!((1..=WINDOW as u32).contains(&most));
        self.is_first.resize(self.count.next_multiple_of(ABREAST), true);
        let (chunks, _) = self.is_first.as_chunks_mut::<ABREAST>();
        for (chunk, is_first) in chunks.iter_mut().enumerate() {
            let padded = self.padded[chunk * ABREAST..].first_chunk();
            let window: &[u8; ABREAST + 2 * PAD] = padded.expect("there are more beyond the end");
            let mut count = [2; ABREAST];
            for side in [-1, 1] {
                let mut is_below = [1; ABREAST];
                for distance in 1..WINDOW {
                    let other = PAD.wrapping_add_signed(side * distance as isize);
                    for i in 0..ABREAST {
                        is_below[i] &= u8::from(window[other + i] < window[PAD + i]);
                        count[i] += is_below[i];
                    }
                }
            }
            // Not by `map`, which is not always inlined.
            for (is_first, count) in is_first.iter_mut().zip(count) {
                *is_first = count > most as u8;
            }
        }
        self.is_first.truncate(self.count);
        // Both ends, whatever lies between.
        self.is_first[0] = true;
        *self.is_first.last_mut().expect("an end") = true;
    }

    /// Makes `reference` the first of a subtree: that which was found ends before it.
    pub fn begin_at(&mut self, reference: u32) {
        self.is_first[reference as usize] = true;
    }

    /// Lists where subtrees begin, and where the last one ends.
    #[inline(always)]
    pub fn list_subtrees(&self, subtrees: &mut Vec<u32>) {
        subtrees.resize(self.is_first.len(), 0);
        let mut found = 0;
        for (i, &is_first) in self.is_first.iter().enumerate() {
            subtrees[found] = i as u32;
            found += usize::from(is_first);
        }
        subtrees.truncate(found);
    }
}

/// The number of the highest bit in which codes differ, from one below the exponent of 1 on. It is the exponent of
/// that bit alone: vectors convert to floats, but do not find bits.
#[inline]
fn delta_of(difference: u32) -> u8 {
    // The next bit is cleared so that nothing is rounded up.
    let float = (difference & !(difference >> 1)) as f32;
    (float.to_bits() >> 23) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deltas_are_those_of_highest_bits() {
        assert_eq!(delta_of(0), EQUAL);
        for bit in 0..32 {
            for below in [0, 1, u32::MAX, 0x5555_5555] {
                assert_eq!(delta_of(1 << bit | below & ((1 << bit) - 1)), MIDDLE + 1 + bit);
            }
        }
    }
}
