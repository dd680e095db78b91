//! The binary tree over a few references at once, by SAH sweeps along all three axes down to blocks.
//!
//! Near the leaves refining cuts costs more than it saves: cuts are short, and each is gathered, sorted and measured
//! anew. Here references are ordered by centroid once per axis, and splits keep the order; all of it stays in the
//! first-level cache.
//!
//! A cut of leaves alone, where nothing is left to refine, is split so too, to the same tree that splitting cut
//! after cut makes.

use super::cell_order::{CELLS, LANES, cells, order_by_cell};
use super::cost::{Weight, cell_scale};
use super::three_axes::{AxisCosts, order, sweep_axes};
use crate::builders::binary::node::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::bvh::limits::{BLOCK, SUBTREE_DEPTH, SUBTREE_MOST as MOST};
use crate::geometry::Aabb;
use crate::simd::Isa;
use arrayvec::ArrayVec;
use glam::Vec3A;

/// `BLOCKS[n]`: the leaf blocks that n references fill.
const BLOCKS: [f32; MOST + 1] = {
    let mut blocks = [0.0; MOST + 1];
    let mut n = 0;
    while n <= MOST {
        blocks[n] = n.div_ceil(BLOCK as usize) as f32;
        n += 1;
    }
    blocks
};

/// Memory for one subtree at a time.
pub(crate) struct SubtreeSweep {
    len: usize,
    boxes: [Aabb; MOST],
    prims: [u32; MOST],
    /// The references in the order of their centroids along each axis; splits reorder ranges of all three.
    order: [[u8; MOST]; 3],
    /// By axis and reference: where its centroid lies.
    cells: [[i8; MOST]; 3],
    /// One of the orders before it is partitioned.
    came: [u8; MOST],
    /// By reference: whether it goes to the right.
    is_right: [u8; MOST],
    /// By place in the orders: half areas of the right sides, by axis.
    areas: [Vec3A; MOST],
}

impl Default for SubtreeSweep {
    fn default() -> Self {
        Self {
            len: 0,
            boxes: [Aabb::EMPTY; MOST],
            prims: [0; MOST],
            order: [[0; MOST]; 3],
            cells: [[0; MOST]; 3],
            came: [0; MOST],
            is_right: [0; MOST],
            areas: [Vec3A::ZERO; MOST],
        }
    }
}

/// Places of the orders yet to be split.
#[derive(Clone, Copy)]
struct Pending {
    first: usize,
    end: usize,
    /// Levels of splits that may still be found by cost.
    levels: u32,
    /// Place of its pair.
    pair: usize,
    /// Half area of its box.
    area: f32,
}

/// A split: the number of references on the left, of those in order along an axis; 0 if none gains anything.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    left: usize,
}

impl SubtreeSweep {
    /// Removes the references.
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
        (self.len > 0).then(|| self.compiled::<false>(isa, SUBTREE_DEPTH, done))
    }

    /// The tree that splitting the references as a cut of leaves makes, one or more, to `levels` levels of
    /// splits; below, references are halved in their given order. It is appended to `done`.
    pub fn build_as_cut(&mut self, isa: Isa, levels: u32, done: &mut Subtrees) -> Node {
        if self.len > BLOCK as usize {
            self.order_by_centroid(isa);
        }
        self.compiled::<true>(isa, levels, done)
    }

    /// As [`Self::tree`], compiled for the instruction set; the operations are the same.
    fn compiled<const AS_CUT: bool>(&mut self, isa: Isa, levels: u32, done: &mut Subtrees) -> Node {
        isa.run(
            #[inline(always)]
            move || {
                if !AS_CUT && self.len > BLOCK as usize {
                    self.order_by_cells();
                }
                self.tree::<AS_CUT>(levels, done)
            },
        )
    }

    /// The tree over the references, which are in order if they are more than a block.
    #[inline(always)]
    fn tree<const AS_CUT: bool>(&mut self, levels: u32, done: &mut Subtrees) -> Node {
        let n = self.len;
        let place = done.prims.len();
        let bounds: Aabb = self.boxes[..n].iter().copied().collect();
        if n <= BLOCK as usize {
            done.prims.extend(&self.prims[..n]);
            return Node::leaf(bounds, place, n as u32);
        }
        let mut ranges = ArrayVec::<Pending, MOST>::new();
        let node = |bounds, range: Pending, done: &mut Subtrees, ranges: &mut ArrayVec<Pending, MOST>| {
            let count = (range.end - range.first) as u32;
            if count <= BLOCK {
                return Node::leaf(bounds, place + range.first, count);
            }
            let pair = done.pairs.len();
            done.pairs.push([Node::ZERO; 2]);
            ranges.push(Pending { pair, area: bounds.half_area(), ..range });
            Node::of_pair(bounds, pair, count)
        };
        let root = Pending { first: 0, end: n, levels, pair: 0, area: 0.0 };
        let root = node(bounds, root, done, &mut ranges);
        while let Some(range) = ranges.pop() {
            let Pending { first, end, levels, pair, .. } = range;
            let n = end - first;
            let split = if levels > 0 { self.best::<AS_CUT>(range) } else { Split { axis: 0, left: n / 2 } };
            let [left, right] = if AS_CUT && (levels == 0 || split.left == 0) {
                self.halve(first, end)
            } else {
                self.partition(first, end, split)
            };
            let middle = first + if split.left > 0 { split.left } else { n / 2 };
            let levels = levels.saturating_sub(1);
            let right = node(right, Pending { first: middle, end, levels, ..range }, done, &mut ranges);
            let left = node(left, Pending { first, end: middle, levels, ..range }, done, &mut ranges);
            done.pairs[pair] = [left, right];
        }
        done.prims.extend(self.order[0][..n].iter().map(|&i| self.prims[usize::from(i)]));
        root
    }

    /// Orders the references by centroid along each axis, equal ones in their given order.
    fn order_by_centroid(&mut self, isa: Isa) {
        let mut centers = [Vec3A::ZERO; MOST];
        for (center, bounds) in centers.iter_mut().zip(&self.boxes[..self.len]) {
            *center = bounds.center2();
        }
        order(isa, &centers[..self.len], &mut self.order);
    }

    /// Orders the references by the cells in which centroids lie.
    #[inline(always)]
    fn order_by_cells(&mut self) {
        let boxes = &self.boxes[..self.len];
        let centers = boxes.iter().fold(Aabb::EMPTY, |all, b| all.grow(b.center2()));
        let scale = cell_scale(centers.extent(), CELLS);
        for (i, b) in boxes.iter().enumerate() {
            let own = cells((b.center2() - centers.min) * scale);
            self.cells.iter_mut().zip(own).for_each(|(cells, own)| cells[i] = own);
        }
        for (cells, order) in self.cells.iter().zip(&mut self.order) {
            order_by_cell(cells, self.len, order);
        }
    }

    /// The split of least cost (paper 4.2, equation 1), of equal ones the first by axis, then by position. For a
    /// cut, one that gains something, if there is any; else leaves cost their blocks, and there always is a split.
    #[inline(always)]
    fn best<const AS_CUT: bool>(&mut self, Pending { first, end, area, .. }: Pending) -> Split {
        let order = self.order.each_ref().map(|order| &order[first..end]);
        let AxisCosts { least, left } = if AS_CUT {
            let limit = Weight::Nodes.limit(area, end - first);
            sweep_axes(&self.boxes, order, &mut self.areas, limit, |n| Weight::Nodes.of(n))
        } else {
            sweep_axes(&self.boxes, order, &mut self.areas, f32::INFINITY, |n| BLOCKS[n])
        };
        let axis = (1..3).fold(0, |best, axis| if least[axis] < least[best] { axis } else { best });
        Split { axis, left: (left[axis] as usize).max(usize::from(!AS_CUT)) }
    }

    /// Halves references in their given order; returns the boxes of both halves.
    fn halve(&mut self, first: usize, end: usize) -> [Aabb; 2] {
        let mut came: ArrayVec<u8, MOST> = self.order[0][first..end].iter().copied().collect();
        came.sort_unstable();
        let middle = first + came.len() / 2;
        let bounds = sides(&self.boxes, &mut self.is_right, came.split_at(came.len() / 2));
        (0..3).for_each(|axis| self.partition_order(axis, [first, middle, end]));
        bounds
    }

    /// Moves the left side to the front of each order, both sides otherwise in order; returns their boxes.
    #[inline(always)]
    fn partition(&mut self, first: usize, end: usize, split: Split) -> [Aabb; 2] {
        let middle = first + split.left;
        let halves = self.order[split.axis][first..end].split_at(split.left);
        let bounds = sides(&self.boxes, &mut self.is_right, halves);
        // The first order tells the references of leaves; they need no other.
        let are_leaves = split.left.max(end - middle) <= BLOCK as usize;
        for axis in 0..if are_leaves { 1 } else { 3 } {
            if axis != split.axis {
                self.partition_order(axis, [first, middle, end]);
            }
        }
        bounds
    }

    /// Moves the left side, up to `middle`, to the front of an order.
    #[inline(always)]
    fn partition_order(&mut self, axis: usize, [first, middle, end]: [usize; 3]) {
        let Self { order, came, is_right, .. } = self;
        let order = &mut order[axis];
        // Whole vectors: the length of a copy could not be predicted.
        let vectors = first / LANES..end.div_ceil(LANES);
        came.as_chunks_mut::<LANES>().0[vectors.clone()].copy_from_slice(&order.as_chunks().0[vectors]);
        let (mut left, mut right) = (first, middle);
        for &i in &came[first..end] {
            let is_right = usize::from(is_right[usize::from(i)]);
            order[if is_right == 1 { right } else { left } % MOST] = i;
            left += 1 - is_right;
            right += is_right;
        }
    }
}

/// Marks which references are on the right; returns the boxes of both sides.
#[inline(always)]
fn sides(boxes: &[Aabb; MOST], is_right: &mut [u8; MOST], (left, right): (&[u8], &[u8])) -> [Aabb; 2] {
    let mut bounds = [Aabb::EMPTY; 2];
    for (on, side) in [left, right].into_iter().enumerate() {
        for &i in side {
            is_right[usize::from(i)] = on as u8;
            bounds[on] = bounds[on].union(boxes[usize::from(i)]);
        }
    }
    bounds
}
