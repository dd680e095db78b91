//! References of one code, parted by the middle of their centroids' bounds: what further bits would say.
//!
//! Most parts are small, so that what time they take is that of branches nobody could foresee. Those of up to
//! [`SMALL`] references wait in a row and are parted without any, many of them in the processor's hands at once.

use crate::builders::lbvh::deltas::Heights;
use crate::builders::lbvh::sort::MIDDLE_DEPTH;
use glam::{Vec3A, Vec4};
use std::ops::Range;

/// Most references of a small part.
const SMALL: usize = 8;

/// Neighbouring references that are to be parted.
#[derive(Clone, Copy, Default)]
struct Part {
    first: u32,
    len: u32,
    /// How often they have been parted by the middle.
    depth: u32,
}

/// Memory to part references in.
#[derive(Default)]
pub(crate) struct SameCode {
    /// Doubled centroids, their numbers in the run the fourth float: all that moves while they are parted. Those of
    /// references that share their code with none mean nothing.
    centers: Vec<Vec4>,
    /// References of one code each.
    groups: Vec<Range<usize>>,
    large: Vec<Part>,
    small: Vec<Part>,
}

impl SameCode {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.centers.capacity() * size_of::<Vec4>()
            + self.groups.capacity() * size_of::<Range<usize>>()
            + (self.large.capacity() + self.small.capacity()) * size_of::<Part>()
    }

    /// Forgets all about the run before; this one has `len` references.
    pub fn begin(&mut self, len: usize) {
        self.groups.clear();
        // What windows reach over the end means nothing.
        self.centers.resize(len + SMALL, Vec4::ZERO);
    }

    /// Takes references of one code: their numbers in the run, and their doubled centroids.
    #[inline]
    pub fn add(&mut self, group: Range<usize>, centers: impl Iterator<Item = Vec3A>) {
        for (i, center) in group.clone().zip(centers) {
            self.centers[i] = center.extend(i as f32);
        }
        self.groups.push(group);
    }

    /// Parts all groups, of three or more, down to leaves of `leaf` references, and tells at which heights. The run has
    /// been parted by the middle `depth` times before.
    pub fn part(&mut self, [depth, leaf]: [u32; 2], heights: &mut Heights) {
        let Self { centers, groups, large, small, .. } = self;
        let mut parts = Parts { large, small, found: 0, leaf };
        parts.small.clear();
        for group in groups {
            parts.push(group.start as u32, group.len() as u32, depth);
            while let Some(part) = parts.large.pop() {
                let Part { first, len, depth } = part;
                let row = &mut centers[first as usize..][..len as usize];
                let split = if depth >= MIDDLE_DEPTH { row.len() / 2 } else { part_by_middle(row) };
                for (first, len) in parts.halves(part, split as u32, heights) {
                    parts.push(first, len, depth + 1);
                }
            }
        }
        let mut next = 0;
        while next < parts.found {
            let part = parts.small[next];
            let Part { first, len, depth } = part;
            next += 1;
            let window = centers[first as usize..].first_chunk_mut().expect("there are more beyond the end");
            let split = part_few(window, len, depth >= MIDDLE_DEPTH);
            for (first, len) in parts.halves(part, split, heights) {
                parts.push_small(first, len, depth + 1);
            }
        }
    }

    /// Brings what belongs to the references of the run into their order; `copy` is memory to use.
    pub fn reorder<T: Copy>(&self, elements: &mut [T], copy: &mut Vec<T>) {
        for group in &self.groups {
            let elements = &mut elements[group.clone()];
            copy.clear();
            copy.extend_from_slice(elements);
            for (element, center) in elements.iter_mut().zip(&self.centers[group.clone()]) {
                *element = copy[center.w as usize - group.start];
            }
        }
    }
}

/// Parts that wait to be parted.
struct Parts<'a> {
    large: &'a mut Vec<Part>,
    small: &'a mut Vec<Part>,
    /// Number of the small ones.
    found: usize,
    leaf: u32,
}

impl Parts<'_> {
    /// The first references and the lengths of what a part is parted into. Tells at which height that is, and of
    /// halves that are pairs, which need no comparison, as well.
    #[inline(always)]
    fn halves(&self, part: Part, split: u32, heights: &mut Heights) -> [(u32, u32); 2] {
        let Part { first, len, depth } = part;
        let middle = first + split;
        heights.part_by_middle(middle as usize, depth);
        let halves = [(first, split), (middle, len - split)];
        for (first, len) in halves {
            // If it is none, the same is told again.
            let is_pair = (len == 2) & (self.leaf == 1);
            let (at, depth) = if is_pair { (first + 1, depth + 1) } else { (middle, depth) };
            heights.part_by_middle(at as usize, depth);
        }
        halves
    }

    fn push(&mut self, first: u32, len: u32, depth: u32) {
        if len as usize > SMALL {
            self.large.push(Part { first, len, depth });
        } else {
            self.push_small(first, len, depth);
        }
    }

    /// Appends a part, to be overwritten by the next if it is a leaf or a pair.
    #[inline]
    fn push_small(&mut self, first: u32, len: u32, depth: u32) {
        if self.found == self.small.len() {
            self.small.resize(2 * self.found + 16, Part::default());
        }
        self.small[self.found] = Part { first, len, depth };
        self.found += usize::from(len > self.leaf.max(2));
    }
}

/// Which centroid comes to which place when those of a set of bits are moved to the front by swaps.
const SWAPPED: [[u8; SMALL]; 1 << SMALL] = {
    let mut table = [[0; SMALL]; 1 << SMALL];
    let mut before = 0;
    while before < 1 << SMALL {
        let mut order = [0, 1, 2, 3, 4, 5, 6, 7];
        let (mut i, mut split) = (0, 0);
        while i < SMALL {
            if before >> i & 1 == 1 {
                (order[i], order[split]) = (order[split], order[i]);
                split += 1;
            }
            i += 1;
        }
        table[before] = order;
        before += 1;
    }
    table
};

/// As [`part_by_middle`], of the first `len` centroids; only in the middle of the row if `halve`.
#[inline]
fn part_few(centers: &mut [Vec4; SMALL], len: u32, halve: bool) -> u32 {
    let (mut lower, mut upper) = ([centers[0]; 2], [centers[0]; 2]);
    for i in 1..SMALL {
        let center = centers[i.min(len as usize - 1)];
        lower[i % 2] = lower[i % 2].min(center);
        upper[i % 2] = upper[i % 2].max(center);
    }
    let (axis, middle) = middle(lower[0].min(lower[1]), upper[0].max(upper[1]));
    let mut before = 0;
    for (i, center) in centers.iter().enumerate() {
        before |= usize::from(center.as_ref()[axis] < middle) << i;
    }
    before &= (1 << len) - 1;
    before = if halve { 0 } else { before };
    let order = &SWAPPED[before];
    let at = |i: usize| centers[order[i] as usize % SMALL];
    let [a, b, c, d, e, f, g, h] = [at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)];
    *centers = [a, b, c, d, e, f, g, h];
    let split = before.count_ones();
    if (split > 0) & (split < len) { split } else { len / 2 }
}

/// The axis along which centroids within the given bounds are parted, and where.
#[inline]
fn middle(lower: Vec4, upper: Vec4) -> (usize, f32) {
    let axis = Vec3A::from_vec4(upper - lower).max_position();
    (axis, ((lower + upper) * 0.5).as_ref()[axis])
}

/// As [`crate::builders::lbvh::sort::part_by_middle`], the order included.
fn part_by_middle(centers: &mut [Vec4]) -> usize {
    let (mut lower, mut upper) = ([centers[0]; 2], [centers[0]; 2]);
    let pairs = centers.chunks_exact(2);
    let last = pairs.remainder().last().copied().unwrap_or(centers[0]);
    for pair in pairs {
        for i in 0..2 {
            lower[i] = lower[i].min(pair[i]);
            upper[i] = upper[i].max(pair[i]);
        }
    }
    let (axis, middle) = middle(lower[0].min(lower[1]).min(last), upper[0].max(upper[1]).max(last));
    let (mut split, len) = (0, centers.len());
    for i in 0..len {
        let center = centers[i];
        let is_before = centers[i].as_ref()[axis] < middle;
        // No branch: it could not be foreseen. Not by `swap`, which may go through memory.
        let to = if is_before { split } else { i };
        let displaced = centers[to];
        centers[i] = displaced;
        centers[to] = center;
        split += usize::from(is_before);
    }
    if (1..len).contains(&split) { split } else { len / 2 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::lbvh::sort;

    #[test]
    fn parts_are_those_of_runs_in_the_same_order() {
        let mix = |i: u32| i.wrapping_mul(0x9e37_79b9) >> 20;
        for len in 2..200usize {
            for spread in [1, 2, 5, 4096] {
                let center =
                    |i: u32| Vec4::new((mix(i) % spread) as f32, (mix(i + 7) % 3) as f32, -0.0, i as f32);
                let centers: Vec<Vec4> = (0..len as u32).map(|i| center(mix(i + len as u32))).collect();
                let mut expected = centers.clone();
                let split = sort::part_by_middle(&mut expected, |center| Vec3A::from_vec4(*center));
                let mut parted = centers.clone();
                assert_eq!(part_by_middle(&mut parted), split);
                assert_eq!(parted, expected);
                if (3..=SMALL).contains(&len) {
                    let mut window = [Vec4::NAN; SMALL];
                    window[..len].copy_from_slice(&centers);
                    assert_eq!(part_few(&mut window, len as u32, false) as usize, split);
                    assert_eq!(window[..len], expected);
                    assert_eq!(part_few(&mut window, len as u32, true) as usize, len / 2);
                    assert_eq!(window[..len], expected);
                }
            }
        }
    }
}
