//! End-point overlap: how much foreign surface a ray's end points meet inside each node's box.
//! Aila, Karras, Laine, *On Quality Metrics of Bounding Volume Hierarchies*, HPG 2013, equation 2.
//!
//! `EPO = sum over nodes n of C(n) * area(surface outside n's subtree, but inside n's box) / area(surface)`,
//! with C = 1 for an inner node and the number of blocks for a leaf. Large meshes are sampled by area.

use super::{Child, Link, WideBvh};
use crate::geometry::{Mesh, Polygon};
use crate::memory::huge_pages;
use rayon::prelude::*;
use std::cell::Cell;

/// Most triangles sampled, evenly spaced along the cumulative area. A fixed number keeps the cost of
/// measuring bounded; meshes with fewer triangles are measured whole.
const SAMPLES: usize = 1 << 16;

/// Nodes visited for all samples, at most: where geometry overlaps so much that a sample is inside of most boxes, fewer
/// samples are taken.
const VISITS: u64 = 1 << 29;
/// Samples, evenly spaced, that tell how many nodes each visits; none fewer are taken.
const PILOTS: usize = 64;

/// What memory is asked for.
const ARRAYS: &str = "the end-point overlap";

/// The end-point overlap of `tree` over `mesh`; 0 for trees of one leaf and surfaces without area. The tree must be one
/// that [`WideBvh::validate`] finds whole over this mesh.
pub fn epo<const N: usize>(tree: &WideBvh<N>, mesh: &Mesh) -> f64 {
    within(tree, mesh, VISITS).0
}

/// The same, by about so many visits to nodes, and how many there were.
fn within<const N: usize>(tree: &WideBvh<N>, mesh: &Mesh, visits: u64) -> (f64, u64) {
    let order = LeafOrder::of(tree, mesh.len());
    let mut samples = samples(mesh);
    let of = |&(prim, weight): &(u32, f64)| {
        let triangle = Part::of(Polygon::triangle(mesh.corners(prim)));
        let visit = Visit { tree, order: &order, leaves: order.leaves_of(prim), nodes: Cell::new(0) };
        let overlap = if triangle.area > 0.0 {
            weight * visit.below(tree.root, tree.bounds, &triangle) / triangle.area
        } else {
            0.0
        };
        (overlap, visit.nodes.get())
    };
    let pilots: u64 = spaced(&samples, PILOTS).par_iter().map(|sample| of(sample).1).sum();
    let each = pilots / PILOTS.min(samples.len()).max(1) as u64;
    let affordable = (visits / each.max(1)) as usize;
    let mut taken = 1.0;
    if affordable < samples.len() {
        samples = spaced(&samples, affordable.max(PILOTS));
        taken = samples.iter().map(|(_, weight)| weight).sum();
    }
    let overlaps: Vec<(f64, u64)> = samples.par_iter().with_min_len(64).map(of).collect();
    let overlap: f64 = overlaps.iter().map(|(overlap, _)| overlap).sum();
    let visited = pilots + overlaps.iter().map(|(_, nodes)| nodes).sum::<u64>();
    (if taken > 0.0 { overlap / taken } else { 0.0 }, visited)
}

/// `count` of `samples`, evenly spaced, or all.
fn spaced(samples: &[(u32, f64)], count: usize) -> Vec<(u32, f64)> {
    let count = count.min(samples.len());
    (0..count).map(|i| samples[i * samples.len() / count]).collect()
}

/// Triangles and their share of the whole area (which add up to 1).
fn samples(mesh: &Mesh) -> Vec<(u32, f64)> {
    let mut areas = huge_pages::filled(mesh.len(), 0.0, ARRAYS);
    areas.par_iter_mut().enumerate().for_each(|(prim, area)| {
        *area = Polygon::triangle(mesh.corners(prim as u32)).area();
    });
    let total: f64 = areas.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return Vec::new();
    }
    let share = |(prim, area): (usize, &f64)| (prim as u32, area / total);
    if areas.len() <= SAMPLES {
        return areas.iter().enumerate().map(share).collect();
    }
    let mut cumulative = 0.0;
    let mut taken = 0;
    let mut samples = Vec::new();
    for (prim, area) in areas.iter().enumerate() {
        cumulative += area / total;
        // Sample k stands at (k + 1/2) / SAMPLES; a large triangle takes several at once.
        let upto = ((cumulative * SAMPLES as f64 + 0.5).floor() as usize).min(SAMPLES);
        if upto > taken {
            samples.push((prim as u32, (upto - taken) as f64 / SAMPLES as f64));
            taken = upto;
        }
    }
    samples
}

/// Leaves numbered depth first, so that a subtree is an interval of them and membership two comparisons.
struct LeafOrder {
    /// Half-open interval of leaf numbers below each inner node.
    interval: Vec<(u32, u32)>,
    /// Number of the leaf that begins at each block.
    leaf_of_block: Vec<u32>,
    /// (triangle, leaf), sorted: a triangle may be in several leaves after spatial splits.
    leaf_of: Vec<(u32, u32)>,
    first_of: Vec<u32>,
}

impl LeafOrder {
    fn of<const N: usize>(tree: &WideBvh<N>, triangles: usize) -> Self {
        let mut order = Self {
            interval: huge_pages::filled(tree.nodes.len(), (0, 0), ARRAYS),
            leaf_of_block: huge_pages::filled(tree.blocks.len(), 0, ARRAYS),
            leaf_of: Vec::new(),
            first_of: huge_pages::filled(triangles + 1, 0, ARRAYS),
        };
        huge_pages::reserve(&mut order.leaf_of, triangles, ARRAYS);
        let mut leaves = 0;
        order.number(tree, tree.root, &mut leaves);
        order.leaf_of.par_sort_unstable();
        for &(prim, _) in &order.leaf_of {
            order.first_of[prim as usize + 1] += 1;
        }
        for i in 0..triangles {
            order.first_of[i + 1] += order.first_of[i];
        }
        order
    }

    fn number<const N: usize>(&mut self, tree: &WideBvh<N>, link: Link, leaves: &mut u32) {
        match link.get() {
            Child::Empty => {}
            Child::Inner(index) => {
                let begin = *leaves;
                for child in tree.nodes[index].links {
                    self.number(tree, child, leaves);
                }
                self.interval[index] = (begin, *leaves);
            }
            Child::Leaf { first, count } => {
                self.leaf_of_block[first] = *leaves;
                let ids = tree.leaf_ids(first, count);
                ids.for_each(|prim| huge_pages::push(&mut self.leaf_of, (prim, *leaves), ARRAYS));
                *leaves += 1;
            }
        }
    }

    fn leaves_of(&self, prim: u32) -> &[(u32, u32)] {
        &self.leaf_of[self.first_of[prim as usize] as usize..self.first_of[prim as usize + 1] as usize]
    }
}

/// A part of a triangle with its area.
struct Part {
    polygon: Polygon,
    area: f64,
}

impl Part {
    fn of(polygon: Polygon) -> Self {
        Self { polygon, area: polygon.area() }
    }
}

struct Visit<'a, const N: usize> {
    tree: &'a WideBvh<N>,
    order: &'a LeafOrder,
    leaves: &'a [(u32, u32)],
    /// Nodes visited.
    nodes: Cell<u64>,
}

impl<const N: usize> Visit<'_, N> {
    /// Cost-weighted area of the triangle inside the boxes of `link`'s subtree that do not hold it.
    /// `part` is the rest of it inside the parent's box, which contains this one.
    fn below(&self, link: Link, bounds: crate::geometry::Aabb, part: &Part) -> f64 {
        self.nodes.set(self.nodes.get() + 1);
        let clipped;
        let part = if part.polygon.is_inside(bounds) {
            part
        } else {
            clipped = Part::of(part.polygon.clipped(bounds));
            &clipped
        };
        if part.polygon.is_empty() {
            return 0.0;
        }
        match link.get() {
            Child::Empty => 0.0,
            Child::Inner(index) => {
                let (begin, end) = self.order.interval[index];
                let from = self.leaves.partition_point(|&(_, leaf)| leaf < begin);
                let holds = self.leaves.get(from).is_some_and(|&(_, leaf)| leaf < end);
                let own = if holds { 0.0 } else { part.area };
                let node = &self.tree.nodes[index];
                own + node.children().map(|(bounds, child)| self.below(child, bounds, part)).sum::<f64>()
            }
            Child::Leaf { first, count } => {
                let number = self.order.leaf_of_block[first];
                let holds = self.leaves.binary_search_by_key(&number, |&(_, leaf)| leaf).is_ok();
                if holds { 0.0 } else { part.area * count as f64 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Bvh4, TriangleBlock, WideNode};

    /// Each of 2^12 triangles in the same place lies in all leaves but its own.
    #[test]
    fn identical_triangles_are_measured_by_fewer_samples() {
        let count = 1usize << 12;
        let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        let (mesh, _) = Mesh::new(vertices, vec![[0, 1, 2]; count]).unwrap();
        let mut blocks = vec![TriangleBlock::EMPTY; count];
        blocks.iter_mut().zip(0..).for_each(|(block, prim)| block.set(0, mesh.corners(prim), prim));
        // Six levels of four children each, all of the same box.
        let mut nodes: Vec<WideNode<4>> = Vec::new();
        let mut level: Vec<Link> = (0..count).map(|first| Link::leaf(first, 1)).collect();
        while level.len() > 1 {
            let begin = nodes.len();
            for children in level.chunks(4) {
                let mut node = WideNode::<4>::EMPTY;
                for (slot, &link) in children.iter().enumerate() {
                    node.set(slot, mesh.bounds(), link);
                }
                nodes.push(node);
            }
            level = (begin..nodes.len()).map(Link::inner).collect();
        }
        let inner = nodes.len() as f64;
        let tree = Bvh4 { root: level[0], bounds: mesh.bounds(), nodes, blocks };
        let expected = (count - 1) as f64 + inner - 6.0;
        let all = (tree.nodes.len() + count) as u64;
        for (visits, samples) in [(VISITS, count as u64), (1 << 20, (1 << 20) / all), (1, PILOTS as u64)] {
            let (epo, visited) = within(&tree, &mesh, visits);
            assert!((epo / expected - 1.0).abs() < 1e-9, "{visits}");
            // Each sample visits every node and leaf.
            assert_eq!(visited, (PILOTS as u64 + samples) * all, "{visits}");
        }
    }

    /// Two triangles of area 1/2 in leaves of their own; the second's box is swollen to hold the first.
    #[test]
    fn a_foreign_triangle_in_a_box_counts_its_area() {
        let vertices =
            vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [5., 0., 0.], [6., 0., 0.], [5., 1., 0.]];
        let (mesh, _) = Mesh::new(vertices, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let build = |second| {
            let mut node = WideNode::<4>::EMPTY;
            let mut blocks = vec![TriangleBlock::EMPTY; 2];
            for prim in 0..2u32 {
                let bounds = if prim == 1 { second } else { mesh.bounds_of(0) };
                blocks[prim as usize].set(0, mesh.corners(prim), prim);
                node.set(prim as usize, bounds, Link::leaf(prim as usize, 1));
            }
            Bvh4 { root: Link::inner(0), bounds: mesh.bounds(), nodes: vec![node], blocks }
        };
        assert_eq!(epo(&build(mesh.bounds_of(1)), &mesh), 0.0);
        assert_eq!(epo(&build(mesh.bounds()), &mesh), 0.5);
    }
}
