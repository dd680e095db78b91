//! The level at which an LBVH separates two neighbours in a run of sorted keys: all that its topology depends on (the
//! deltas of Karras 2012).
//!
//! A delta is a byte, so that a vector holds many. Below a common ancestor two neighbours are separated once, where
//! their codes differ in the highest bit, or, below that, where references of one code are partitioned by the
//! middle.

use super::key::{MortonKey, code};

/// Before the first reference and after the last.
const END: u8 = u8::MAX;
/// Of neighbours of one code that are not separated.
const EQUAL: u8 = 0;
/// Neighbours that are partitioned by the middle have lower deltas than this.
const MIDDLE: u8 = 126;
/// Deltas beyond either end, so that windows may reach over it.
const PAD: usize = MOST - 1;
/// Most references of a leaf.
const MOST: usize = 4;

/// The deltas of a run.
#[derive(Default)]
pub(crate) struct Deltas {
    /// `padded[PAD + i]`: of references i - 1 and i.
    padded: Vec<u8>,
    /// Whether a leaf begins with reference i, or all leaves end before it.
    begins: Vec<bool>,
}

impl Deltas {
    /// Computes the deltas of sorted keys.
    pub fn of_codes(&mut self, keys: &[MortonKey]) {
        self.padded.clear();
        self.padded.resize(keys.len() + 1 + 2 * PAD, END);
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

    /// Finds where leaves begin, the largest subtrees of at most `most` references, and where the last one ends.
    ///
    /// On either side of a delta, its subtree has one reference more than there are lower deltas in a row. No branch
    /// depends on a delta.
    pub fn leaves(&mut self, most: u32, leaves: &mut Vec<u32>) {
        debug_assert!((1..=MOST as u32).contains(&most));
        let ends = self.padded.len() - 2 * PAD;
        self.begins.resize(ends, true);
        let [a, b, c, own, d, e, f] = std::array::from_fn(|i| &self.padded[i..i + ends]);
        for (i, begins) in self.begins.iter_mut().enumerate() {
            let lower = |delta: u8| delta < own[i];
            let left = [lower(c[i]), lower(c[i]) & lower(b[i]), lower(c[i]) & lower(b[i]) & lower(a[i])];
            let right = [lower(d[i]), lower(d[i]) & lower(e[i]), lower(d[i]) & lower(e[i]) & lower(f[i])];
            let count = 2 + left.iter().chain(&right).map(|&is| u8::from(is)).sum::<u8>();
            *begins = count > most as u8;
        }
        // Both ends, whatever lies between.
        self.begins[0] = true;
        self.begins[ends - 1] = true;
        leaves.resize(ends, 0);
        let mut found = 0;
        for (i, &begins) in self.begins.iter().enumerate() {
            leaves[found] = i as u32;
            found += usize::from(begins);
        }
        leaves.truncate(found);
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
