//! A few references ordered by the cells in which their centroids lie along an axis, many at once.

use glam::Vec3A;

/// Centroids are ordered by cells along each axis of their bounds; within a cell they keep their given order, that
/// of the Morton codes.
pub(crate) const CELLS: usize = 64;

/// The whole parts of places below [`CELLS`].
#[inline(always)]
pub(super) fn cells(place: Vec3A) -> [i8; 3] {
    // So large a float has no fraction: its lowest bits are the place, rounded. Conversions would check for more.
    const WHOLE: Vec3A = Vec3A::splat(super::cost::WHOLE);
    let rounded = place + WHOLE;
    let is_above = (rounded - WHOLE).cmpgt(place);
    let whole = rounded - Vec3A::select(is_above, Vec3A::ONE, Vec3A::ZERO);
    whole.to_array().map(|whole| (whole.to_bits() % CELLS as u32) as i8)
}

/// References to a vector of bytes.
pub(super) const LANES: usize = 32;

/// Orders the first `len` references by cells, equal ones in their given order: counts how many come before each, many
/// at once.
#[inline(always)]
pub(super) fn order_by_cell<const MOST: usize>(cells: &[i8; MOST], len: usize, order: &mut [u8; MOST]) {
    // Whole vectors, references numbered by bytes.
    const { assert!(MOST.is_multiple_of(LANES) && MOST <= 256) };
    for (first, own) in (0..len).step_by(LANES).zip(cells.as_chunks::<LANES>().0) {
        let mut ranks = [0u8; LANES];
        for (i, &cell) in cells[..len].iter().enumerate() {
            // Of equal ones, those before come first: the lanes later than i.
            let later = LANES - (i + 1).saturating_sub(first).min(LANES);
            let is_later: &[i8; LANES] = ZEROS_AND_ONES[later..].first_chunk().expect("half of the table");
            for lane in 0..LANES {
                ranks[lane] += u8::from(cell < own[lane] + is_later[lane]);
            }
        }
        for (i, rank) in (first..len).zip(ranks) {
            order[usize::from(rank)] = i as u8;
        }
    }
}

/// As many zeros as lanes, and as many ones.
const ZEROS_AND_ONES: [i8; 2 * LANES] = {
    let mut table = [0; 2 * LANES];
    let (_, ones) = table.split_at_mut(LANES);
    let mut i = 0;
    while i < LANES {
        ones[i] = 1;
        i += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn cells_are_whole_parts() {
        for place in [0.0, 0.49, 0.5, 0.51, 0.999_999_9, 1.0, 1.5, 2.5, 31.5, 62.999_996, 63.0, 63.936] {
            let all = cells(Vec3A::new(place, 0.0, place));
            assert_eq!(all, [place as i8, 0, place as i8], "{place}");
        }
    }

    #[test]
    fn equal_cells_keep_their_order() {
        let mut random = SplitMix64::new(9);
        for len in (0..=70).chain([255, 256]) {
            for different in [1, 2, CELLS as u64] {
                let cells: [i8; 256] = std::array::from_fn(|_| (random.next_u64() % different) as i8);
                let mut expected: Vec<u8> = (0..len).map(|i| i as u8).collect();
                expected.sort_by_key(|&i| cells[usize::from(i)]);
                let mut order = [0; 256];
                order_by_cell(&cells, len, &mut order);
                assert_eq!(order[..len], expected);
            }
        }
    }
}
