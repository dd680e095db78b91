//! Full leaves: a subtree of a few blocks has as few as hold its references, so that fewer blocks and nodes are
//! written. The radix tree, which separates references where their codes differ most, leaves three of ten places empty.
//!
//! A subtree is still separated where neighbours differ most, but only there where it takes no block more. What may
//! separate a part of it could have separated all of it: so deltas fall from the root down, as in the radix tree.

use crate::builders::lbvh::deltas::Deltas;
use crate::bvh::limits::BLOCK;

/// Most references of a subtree with full leaves.
const FULL: usize = 16;

/// Memory to find full leaves in.
#[derive(Default)]
pub(crate) struct FullLeaves {
    /// Parts of subtrees that are to be separated: where each begins, and its references.
    parts: Vec<[u32; 2]>,
}

impl FullLeaves {
    /// Finds where leaves begin, and where the last one ends.
    #[inline(always)]
    pub fn find(&mut self, deltas: &mut Deltas, leaves: &mut Vec<u32>) {
        deltas.find_subtrees::<FULL>(FULL as u32);
        deltas.begins(leaves);
        // Each part has references of its own.
        self.parts.resize(leaves.last().map_or(0, |&end| end as usize) + 1, [0; 2]);
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
            deltas.separate(begin + left);
            for part in [[begin, left], [begin + left, len - left]] {
                self.parts[found] = part;
                found += usize::from(part[1] > BLOCK);
            }
        }
        deltas.begins(leaves);
    }
}

/// After how many of `len` references the greatest delta is, the first of equals, of those that take no block more.
#[inline(always)]
fn split(deltas: &[u8; FULL], len: u32) -> u32 {
    let last = FULL as i16 - 1;
    let mut greatest = 0;
    for (i, (&delta, may)) in deltas.iter().zip(&MAY_SEPARATE[len as usize]).enumerate() {
        // Above the place, for which earlier ones count more.
        let place = i16::from(delta) << 4 | (last - i as i16);
        greatest = (place & may).max(greatest);
    }
    (last - (greatest & last)) as u32
}

/// By the number of references: all bits, where they may be separated before that one.
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
