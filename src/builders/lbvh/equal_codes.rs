//! References of one code are partitioned by the middle of their centroids' bounds: what further bits would say. The
//! partitions and their order are those of [`super::partition`].
//!
//! Most groups are small, so that their time is that of branches that cannot be predicted. Those of up to [`SMALL`]
//! references are queued and partitioned without a branch, many of them in flight at once.

use super::deltas::Deltas;
use crate::bvh::limits::MIDDLE_DEPTH;
use glam::{Vec3A, Vec4};
use std::ops::Range;

/// Most references of a small group.
const SMALL: usize = 8;

/// Neighbouring references that are to be partitioned.
#[derive(Clone, Copy, Default)]
struct Group {
    first: u32,
    len: u32,
    /// How often they have been partitioned by the middle.
    depth: u32,
}

/// Memory to partition references in.
#[derive(Default)]
pub(crate) struct EqualCodes {
    /// Doubled centroids, with the index in the run as fourth float: all that moves. Those of references that share
    /// their code with none are not used.
    centers: Vec<Vec4>,
    /// Runs of one code.
    runs: Vec<Range<usize>>,
    large: Vec<Group>,
    small: Vec<Group>,
}

impl EqualCodes {
    /// Partitions the runs of equal codes among `len` references down to groups of at most `leaf` references, where
    /// `deltas` are those of the codes and `depth` counts earlier partitions by the middle. `center2` gives doubled
    /// centroids. [`EqualCodes::reorder`] then brings other arrays into the new order.
    pub fn partition(
        &mut self,
        deltas: &mut Deltas,
        len: usize,
        [depth, leaf]: [u32; 2],
        center2: impl Fn(usize) -> Vec3A,
    ) {
        let Self { centers, runs, large, small } = self;
        runs.clear();
        // Windows reach over the end; what they read there is not used.
        centers.resize(len + SMALL, Vec4::ZERO);
        let mut begin = 0;
        while let Some(equal) = deltas.equal_codes(begin) {
            begin = equal.end;
            if equal.len() > leaf as usize {
                for i in equal.clone() {
                    centers[i] = center2(i).extend(i as f32);
                }
                runs.push(equal);
            }
        }
        let mut queue = Queue { large, small, found: 0, leaf };
        queue.small.clear();
        for run in runs {
            queue.push(run.start as u32, run.len() as u32, depth);
            while let Some(group) = queue.large.pop() {
                let Group { first, len, depth } = group;
                let row = &mut centers[first as usize..][..len as usize];
                let split = if depth >= MIDDLE_DEPTH { row.len() / 2 } else { partition_by_middle(row) };
                for (first, len) in queue.halves(group, split as u32, deltas) {
                    queue.push(first, len, depth + 1);
                }
            }
        }
        let mut next = 0;
        while next < queue.found {
            let group = queue.small[next];
            let Group { first, len, depth } = group;
            next += 1;
            let window = centers[first as usize..].first_chunk_mut().expect("there are more beyond the end");
            let split = partition_few(window, len, depth >= MIDDLE_DEPTH);
            for (first, len) in queue.halves(group, split, deltas) {
                queue.push_small(first, len, depth + 1);
            }
        }
    }

    /// Brings an array that goes with the references into their new order; `copy` is memory.
    pub fn reorder<T: Copy>(&self, elements: &mut [T], copy: &mut Vec<T>) {
        for run in &self.runs {
            let elements = &mut elements[run.clone()];
            copy.clear();
            copy.extend_from_slice(elements);
            for (element, center) in elements.iter_mut().zip(&self.centers[run.clone()]) {
                *element = copy[center.w as usize - run.start];
            }
        }
    }
}

/// Groups that wait to be partitioned.
struct Queue<'a> {
    large: &'a mut Vec<Group>,
    small: &'a mut Vec<Group>,
    /// Number of the small ones.
    found: usize,
    leaf: u32,
}

impl Queue<'_> {
    /// The first reference and the length of either half of a group. Sets its delta, and those of halves that are
    /// pairs, which need no comparison.
    #[inline(always)]
    fn halves(&self, group: Group, split: u32, deltas: &mut Deltas) -> [(u32, u32); 2] {
        let Group { first, len, depth } = group;
        let middle = first + split;
        deltas.separate_by_middle(middle as usize, depth);
        let halves = [(first, split), (middle, len - split)];
        for (first, len) in halves {
            // If the half is no pair, the delta of the group is set again.
            let is_pair = (len == 2) & (self.leaf == 1);
            let (at, depth) = if is_pair { (first + 1, depth + 1) } else { (middle, depth) };
            deltas.separate_by_middle(at as usize, depth);
        }
        halves
    }

    fn push(&mut self, first: u32, len: u32, depth: u32) {
        if len as usize > SMALL {
            self.large.push(Group { first, len, depth });
        } else {
            self.push_small(first, len, depth);
        }
    }

    /// Appends a group, to be overwritten by the next if it is a leaf or a pair.
    #[inline]
    fn push_small(&mut self, first: u32, len: u32, depth: u32) {
        if self.found == self.small.len() {
            self.small.resize(2 * self.found + 16, Group::default());
        }
        self.small[self.found] = Group { first, len, depth };
        self.found += usize::from(len > self.leaf.max(2));
    }
}

/// Which centroid comes to which place when swaps move those of a set of bits to the front.
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

/// As [`partition_by_middle`], of the first `len` centroids; only in the middle of the row if `halve`.
#[inline]
fn partition_few(centers: &mut [Vec4; SMALL], len: u32, halve: bool) -> u32 {
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

/// The axis along which centroids within the given bounds are partitioned, and where.
#[inline]
fn middle(lower: Vec4, upper: Vec4) -> (usize, f32) {
    let axis = Vec3A::from_vec4(upper - lower).max_position();
    (axis, ((lower + upper) * 0.5).as_ref()[axis])
}

/// As [`super::partition::partition_by_middle`], the order included.
fn partition_by_middle(centers: &mut [Vec4]) -> usize {
    let grow = |(lower, upper): (Vec4, Vec4), center: &Vec4| (lower.min(*center), upper.max(*center));
    let (lower, upper) = centers.iter().fold((centers[0], centers[0]), grow);
    let (axis, middle) = middle(lower, upper);
    let (mut split, len) = (0, centers.len());
    for i in 0..len {
        let center = centers[i];
        let is_before = centers[i].as_ref()[axis] < middle;
        // No branch: it could not be predicted. Not by `swap`, which may go through memory.
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
    use crate::builders::lbvh::partition;
    use crate::random;

    #[test]
    fn partitions_are_those_of_the_definition_in_the_same_order() {
        let mix = |i: u32| (random::mix(i.into()) >> 52) as u32;
        for len in 2..200usize {
            for spread in [1, 2, 5, 4096] {
                let center =
                    |i: u32| Vec4::new((mix(i) % spread) as f32, (mix(i + 7) % 3) as f32, -0.0, i as f32);
                let centers: Vec<Vec4> = (0..len as u32).map(|i| center(mix(i + len as u32))).collect();
                let mut expected = centers.clone();
                let split = partition::partition_by_middle(&mut expected, |center| Vec3A::from_vec4(*center));
                let mut partitioned = centers.clone();
                assert_eq!(partition_by_middle(&mut partitioned), split);
                assert_eq!(partitioned, expected);
                if (3..=SMALL).contains(&len) {
                    let mut window = [Vec4::NAN; SMALL];
                    window[..len].copy_from_slice(&centers);
                    assert_eq!(partition_few(&mut window, len as u32, false) as usize, split);
                    assert_eq!(window[..len], expected);
                    assert_eq!(partition_few(&mut window, len as u32, true) as usize, len / 2);
                    assert_eq!(window[..len], expected);
                }
            }
        }
    }
}
