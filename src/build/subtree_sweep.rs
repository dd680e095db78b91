//! The binary tree over a few references at once, by sweeps of the SAH along all three axes down to quartets.
//!
//! Near the leaves refining cuts costs more than it saves: cuts are short, and each is gathered, sorted and
//! measured anew. Here references are put in order of their centroids once per axis, and splits keep the order;
//! all of it stays in the first-level cache.

#![allow(unsafe_code)]

use super::binary::Node;
use super::small_sweep::Isa;
use super::subtrees::Subtrees;
use super::top_down::QUARTET;
use crate::geometry::Aabb;
use arrayvec::ArrayVec;
use glam::{Mat3A, Vec3A};

/// Most references of a subtree: they are numbered by bytes.
pub(super) const MOST: usize = 256;

/// Centroids are put in order by so many steps along each axis of their bounds; within a step they keep the order
/// in which they came, that of the Morton codes.
pub(super) const STEPS: usize = 64;

/// From this depth on references are halved by count, which bounds the depth of a subtree by it and another 6
/// levels.
pub(super) const HALVE: u32 = 12;

/// The leaf blocks that so many references fill.
const BLOCKS: [f32; MOST + 1] = {
    let mut blocks = [0.0; MOST + 1];
    let mut n = 0;
    while n <= MOST {
        blocks[n] = n.div_ceil(QUARTET as usize) as f32;
        n += 1;
    }
    blocks
};

/// Memory for one subtree at a time.
pub(super) struct SubtreeSweep {
    len: usize,
    boxes: [Aabb; MOST],
    prims: [u32; MOST],
    /// The references in order of their centroids along each axis; splits reorder ranges of all three.
    order: [[u8; MOST]; 3],
    /// By reference: whether it goes to the right.
    is_right: [u8; MOST],
    /// By place in the orders: half areas of the boxes of what follows, by axis.
    areas: [Vec3A; MOST],
}

impl Default for SubtreeSweep {
    fn default() -> Self {
        Self {
            len: 0,
            boxes: [Aabb::EMPTY; MOST],
            prims: [0; MOST],
            order: [[0; MOST]; 3],
            is_right: [0; MOST],
            areas: [Vec3A::ZERO; MOST],
        }
    }
}

/// Places of the orders yet to be split.
#[derive(Clone, Copy)]
struct Range {
    first: usize,
    end: usize,
    depth: u32,
    /// Place of its pair.
    pair: usize,
}

/// A split: how many references go to the left of those in order along an axis.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    left: usize,
}

impl SubtreeSweep {
    /// Forgets the references.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a reference, of which there may be [`MOST`].
    #[inline]
    pub fn push(&mut self, bounds: Aabb, prim: u32) {
        self.boxes[self.len] = bounds;
        self.prims[self.len] = prim;
        self.len += 1;
    }

    /// The tree over the references, appended to `done`; `None` without references.
    pub fn build(&mut self, isa: Isa, done: &mut Subtrees) -> Option<Node> {
        if self.len == 0 {
            return None;
        }
        #[cfg(target_arch = "x86_64")]
        if isa != Isa::Scalar {
            // SAFETY: `Isa::best` has found the feature.
            return Some(unsafe { self.tree_avx2(done) });
        }
        let _ = isa;
        Some(self.tree(done))
    }

    /// As [`Self::tree`], compiled for newer processors; it does the same operations.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,bmi2")]
    unsafe fn tree_avx2(&mut self, done: &mut Subtrees) -> Node {
        self.tree(done)
    }

    /// The tree over the references, of which there are some.
    #[inline(always)]
    fn tree(&mut self, done: &mut Subtrees) -> Node {
        let n = self.len;
        let place = done.prims.len();
        let bounds = self.boxes[..n].iter().copied().collect();
        if n <= QUARTET as usize {
            done.prims.extend(&self.prims[..n]);
            return Node::leaf(bounds, place, n as u32);
        }
        self.put_in_order();
        let mut ranges = ArrayVec::<Range, MOST>::new();
        let node = |bounds, range: Range, done: &mut Subtrees, ranges: &mut ArrayVec<Range, MOST>| {
            let count = (range.end - range.first) as u32;
            if count <= QUARTET {
                return Node::leaf(bounds, place + range.first, count);
            }
            let pair = done.pairs.len();
            done.pairs.push([Node::ZERO; 2]);
            ranges.push(Range { pair, ..range });
            Node::of_pair(bounds, pair, count)
        };
        let root = node(bounds, Range { first: 0, end: n, depth: 0, pair: 0 }, done, &mut ranges);
        while let Some(range) = ranges.pop() {
            let Range { first, end, depth, pair } = range;
            let split = if depth < HALVE {
                self.best(first, end)
            } else {
                Split { axis: 0, left: (end - first) / 2 }
            };
            let [left, right] = self.part(first, end, split);
            let (depth, middle) = (depth + 1, first + split.left);
            let right = node(right, Range { first: middle, end, depth, pair }, done, &mut ranges);
            let left = node(left, Range { first, end: middle, depth, pair }, done, &mut ranges);
            done.pairs[pair] = [left, right];
        }
        done.prims.extend(self.order[0][..n].iter().map(|&i| self.prims[usize::from(i)]));
        root
    }

    /// Counting sorts by the steps in which centroids lie.
    #[inline(always)]
    fn put_in_order(&mut self) {
        let boxes = &self.boxes[..self.len];
        let centers = boxes.iter().fold(Aabb::EMPTY, |all, b| all.grow(b.center2()));
        let scale = Vec3A::splat(STEPS as f32 * 0.999) / centers.extent();
        let scale = Vec3A::select(scale.cmplt(Vec3A::splat(f32::MAX)), scale, Vec3A::ZERO);
        let mut begin = [[0u8; STEPS]; 3];
        let mut steps = [[0u8; 3]; MOST];
        for (b, steps) in boxes.iter().zip(&mut steps) {
            let place = ((b.center2() - centers.min) * scale).to_array();
            for axis in 0..3 {
                let step = place[axis] as i32 as usize % STEPS;
                steps[axis] = step as u8;
                begin[axis][step] = begin[axis][step].wrapping_add(1);
            }
        }
        for begin in &mut begin {
            let mut sum = 0u8;
            for begin in begin {
                (*begin, sum) = (sum, sum.wrapping_add(*begin));
            }
        }
        for (i, steps) in steps[..boxes.len()].iter().enumerate() {
            for axis in 0..3 {
                let place = &mut begin[axis][usize::from(steps[axis]) % STEPS];
                self.order[axis][usize::from(*place)] = i as u8;
                *place = place.wrapping_add(1);
            }
        }
    }

    /// The split of least cost (paper 4.2, equation 1) where leaves cost their blocks; of equal ones the first by
    /// axis, then by position.
    #[inline(always)]
    fn best(&mut self, first: usize, end: usize) -> Split {
        let n = end - first;
        let [x, y, z] = self.order.each_ref().map(|order| &order[first..end]);
        let boxes = &self.boxes;
        let grow = |sides: &mut [Aabb; 3], i: usize| {
            for (side, order) in sides.iter_mut().zip([x, y, z]) {
                *side = side.union(boxes[usize::from(order[i])]);
            }
        };
        let areas = &mut self.areas[..n];
        let mut sides = [Aabb::EMPTY; 3];
        for i in (1..n).rev() {
            grow(&mut sides, i);
            areas[i] = half_areas(&sides);
        }
        let mut sides = [Aabb::EMPTY; 3];
        let (mut least, mut left) = (Vec3A::INFINITY, Vec3A::ONE);
        for i in 1..n {
            grow(&mut sides, i - 1);
            let cost = half_areas(&sides) * BLOCKS[i] + areas[i] * BLOCKS[n - i];
            let is_less = cost.cmplt(least);
            least = Vec3A::select(is_less, cost, least);
            left = Vec3A::select(is_less, Vec3A::splat(i as f32), left);
        }
        let axis = (1..3).fold(0, |best, axis| if least[axis] < least[best] { axis } else { best });
        Split { axis, left: left[axis] as usize }
    }

    /// Brings to the front of each order what is on the left, both sides otherwise in order; returns their boxes.
    #[inline(always)]
    fn part(&mut self, first: usize, end: usize, split: Split) -> [Aabb; 2] {
        let (left, right) = self.order[split.axis][first..end].split_at(split.left);
        let bounds = [left, right].map(|side| side.iter().map(|&i| self.boxes[usize::from(i)]).collect());
        left.iter().for_each(|&i| self.is_right[usize::from(i)] = 0);
        right.iter().for_each(|&i| self.is_right[usize::from(i)] = 1);
        for axis in (0..3).filter(|&axis| axis != split.axis) {
            let order = &mut self.order[axis][first..end];
            let mut on_right = [0; MOST];
            let (mut left, mut right) = (0, 0);
            for at in 0..order.len() {
                let i = order[at];
                let is_right = usize::from(self.is_right[usize::from(i)]);
                order[left] = i;
                on_right[right] = i;
                left += 1 - is_right;
                right += is_right;
            }
            order[left..].copy_from_slice(&on_right[..right]);
        }
        bounds
    }
}

/// Half areas of three boxes, as [`Aabb::half_area`].
#[inline(always)]
pub(super) fn half_areas(boxes: &[Aabb; 3]) -> Vec3A {
    let [a, b, c] = boxes.map(Aabb::extent);
    let e = Mat3A::from_cols(a, b, c).transpose();
    e.x_axis * (e.y_axis + e.z_axis) + e.y_axis * e.z_axis
}
