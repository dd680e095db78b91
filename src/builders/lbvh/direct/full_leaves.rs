//! Full leaves: a subtree of a few blocks has as few as hold its references, so that fewer blocks and nodes are
//! written. The radix tree, which separates references where their codes differ most, leaves three of ten places empty.
//!
//! A subtree is still split where neighbours differ most, but only where that takes no block more. A split allowed in a
//! part is also allowed in the whole, so deltas fall from top to bottom, and the Cartesian tree of the leaves is the
//! tree of these splits. Of equal deltas the first is above the others in both.

use crate::builders::lbvh::deltas::Deltas;
use crate::bvh::limits::BLOCK;

/// Most references of a subtree with full leaves.
const FULL: usize = 16;

/// Memory to find full leaves in.
#[derive(Default)]
pub(crate) struct FullLeaves {
    /// Subtrees and parts of them that are to be separated: where each begins, and its references.
    parts: Vec<[u32; 2]>,
}

impl FullLeaves {
    /// Finds where leaves begin, and where the last one ends.
    #[inline(always)]
    pub fn find(&mut self, deltas: &mut Deltas, leaves: &mut Vec<u32>) {
        deltas.find_subtrees::<FULL>(FULL as u32);
        deltas.list_subtrees(leaves);
        // Each part is separated before a block of its own; the last place is written, but not kept.
        let blocks = leaves.last().map_or(0, |&end| end / BLOCK);
        self.parts.resize(blocks as usize + 1, [0; 2]);
        let (mut next, mut found) = (0, 0);
        // No branch on the number of references could be predicted.
        for subtree in leaves.windows(2) {
            let part = [subtree[0], subtree[1] - subtree[0]];
            self.parts[found] = part;
            found += usize::from(part[1] > BLOCK);
        }
        while next < found {
            let [begin, len] = self.parts[next];
            next += 1;
            let left = split(deltas.from(begin as usize), len);
            deltas.begin_at(begin + left);
            for part in [[begin, left], [begin + left, len - left]] {
                self.parts[found] = part;
                found += usize::from(part[1] > BLOCK);
            }
        }
        deltas.list_subtrees(leaves);
    }
}

/// After how many of `len` references the greatest delta is, the first of equals, of those that take no block more.
#[inline(always)]
fn split(deltas: &[u8; FULL], len: u32) -> u32 {
    const BITS: u32 = FULL.trailing_zeros();
    const { assert!(FULL == 1 << BITS && BITS < 8, "a place and a delta share 15 bits") };
    let last = FULL as i16 - 1;
    let mut greatest = 0;
    for (i, (&delta, may)) in deltas.iter().zip(&MAY_SEPARATE[len as usize]).enumerate() {
        // Above the place, for which earlier ones count more.
        let place = i16::from(delta) << BITS | (last - i as i16);
        greatest = (place & may).max(greatest);
    }
    (last - (greatest & last)) as u32
}

/// By the number of references: all bits at each reference before which they may be separated.
const MAY_SEPARATE: [[i16; FULL]; FULL + 1] = {
    let mut table = [[0; FULL]; FULL + 1];
    let mut len = 1;
    while len <= FULL {
        let mut left = 1;
        while left < len {
            if blocks(left) + blocks(len - left) == blocks(len) {
                table[len][left] = -1;
            }
            left += 1;
        }
        len += 1;
    }
    table
};

/// As few as hold so many references.
const fn blocks(references: usize) -> usize {
    references.div_ceil(BLOCK as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::lbvh::cartesian::cartesian_tree;
    use crate::builders::lbvh::key::key_of;
    use crate::random::mix;

    /// Some sorted codes, no more than four alike.
    fn codes(len: usize, seed: u32) -> Vec<u32> {
        // Alike in many of their highest bits, or in few.
        let code = |i: u32| mix(u64::from(i) << 32 | u64::from(seed)) as u32 >> (seed * 5 % 28);
        let mut codes: Vec<u32> = (0..len as u32).map(|i| code(code(i) ^ i)).collect();
        codes.sort_unstable();
        let firsts: Vec<bool> = (0..len).map(|i| i < 4 || codes[i - 4] != codes[i]).collect();
        let mut firsts = firsts.into_iter();
        codes.retain(|_| firsts.next().unwrap());
        codes
    }

    /// Where the largest subtrees of at most `most` codes begin, by bisection.
    fn bisected(codes: &[u32], begin: usize, most: usize, subtrees: &mut Vec<u32>) {
        let different = codes[0] ^ codes[codes.len() - 1];
        // Of one code none are separated here, but where each reference is to be.
        if codes.len() <= most || different == 0 && most > 1 {
            subtrees.push(begin as u32);
            return;
        }
        let bit = different.checked_ilog2();
        let left = bit.map_or(1, |bit| codes.partition_point(|code| code >> bit & 1 == 0));
        bisected(&codes[..left], begin, most, subtrees);
        bisected(&codes[left..], begin + left, most, subtrees);
    }

    /// The separations of a subtree with full leaves: where its parts begin and end.
    fn separations(deltas: &Deltas, begin: usize, end: usize, all: &mut Vec<[usize; 3]>) {
        let blocks = |from: usize, to: usize| (to - from).div_ceil(4);
        if blocks(begin, end) > 1 {
            let may = |at: &usize| blocks(begin, *at) + blocks(*at, end) == blocks(begin, end);
            let at = (begin + 1..end).filter(may).rev().max_by_key(|&at| deltas.before(at)).unwrap();
            all.push([begin, at, end]);
            separations(deltas, begin, at, all);
            separations(deltas, at, end, all);
        }
    }

    #[test]
    fn subtrees_are_the_largest_and_have_no_block_more_than_they_need() {
        let (mut deltas, mut full) = (Deltas::default(), FullLeaves::default());
        let (mut blocks, mut subtrees_of_many) = (0, 0);
        for (len, seed) in (1..=130).flat_map(|len| (0..12).map(move |seed| (len, seed))) {
            let codes = codes(len, seed);
            let keys: Vec<u64> = codes.iter().zip(0..).map(|(&code, i)| key_of(code, i)).collect();
            let ended = |most: usize| {
                let mut subtrees = Vec::new();
                bisected(&codes, 0, most, &mut subtrees);
                subtrees.push(codes.len() as u32);
                subtrees
            };
            let mut found = Vec::new();
            deltas.of_codes(&keys);
            for most in 1..=4 {
                deltas.find_subtrees::<4>(most);
                deltas.list_subtrees(&mut found);
                assert_eq!(found, ended(most as usize), "{most} of {codes:?}");
            }
            full.find(&mut deltas, &mut found);
            let mut of_recursion = Vec::new();
            for subtree in ended(FULL).windows(2) {
                let [begin, end] = [subtree[0], subtree[1]];
                let within: Vec<u32> = found.iter().copied().filter(|at| (begin..end).contains(at)).collect();
                assert_eq!(within[0], begin);
                assert_eq!(within.len(), ((end - begin) as usize).div_ceil(4), "{codes:?}: {found:?}");
                separations(&deltas, begin as usize, end as usize, &mut of_recursion);
                blocks += within.len();
                subtrees_of_many += usize::from(within.len() > 2);
            }
            assert!(found.windows(2).all(|leaf| (1..=4).contains(&(leaf[1] - leaf[0]))), "{found:?}");
            assert_eq!(found.last(), Some(&(codes.len() as u32)));
            // The separations below subtrees are those of the tree that is built over the leaves.
            let mut of_tree = Vec::new();
            let leaves = found.windows(2).map(|leaf| [leaf[0] as usize, leaf[1] as usize]);
            let leaves = leaves.map(|leaf| (leaf, deltas.before(leaf[0])));
            cartesian_tree([0; 2], leaves, |[left, right]| {
                assert_eq!(left[1], right[0]);
                of_tree.push([left[0], right[0], right[1]]);
                [left[0], right[1]]
            });
            of_tree.retain(|[begin, _, end]| end - begin <= FULL);
            of_tree.sort_unstable();
            of_recursion.sort_unstable();
            assert_eq!(of_tree, of_recursion, "{codes:?}");
        }
        assert!(blocks > 10_000 && subtrees_of_many > 1000, "{blocks}, {subtrees_of_many}");
    }
}
