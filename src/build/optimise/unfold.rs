//! From a wide tree to a binary one over single triangle references, each with the box of what its leaf sees of
//! the triangle.

use super::tree::{Node, Pair, ROOT, Tree};
use crate::bvh::{Bvh4, Child, Link, MAX_LEAF_BLOCKS, Polygon, WideNode};
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;
use rayon::prelude::*;

/// Wide nodes per task.
const CHUNK: usize = 1 << 10;
/// Most references of a leaf.
const MAX_LEAF: usize = 4 * MAX_LEAF_BLOCKS;

impl Tree {
    /// Becomes the binary tree of `wide`, whose nodes come before their parents, the root last. Here parents come
    /// first: nodes are numbered by rank, from the last.
    pub fn unfold(&mut self, wide: &Bvh4, mesh: &Mesh) {
        let pairs: Vec<usize> =
            wide.nodes.par_iter().rev().with_min_len(CHUNK).map(|node| room_for(wide, node)).collect();
        // Where each wide node's pairs begin: pair 0 is the root's.
        let mut total = 1;
        let mut first = Vec::with_capacity(pairs.len() + 1);
        for own in pairs {
            first.push(total);
            total += own;
        }
        first.push(total);
        self.make_room(total);

        let mut rest = &mut self.pairs[1..];
        let mut tasks = Vec::new();
        for begin in (0..wide.nodes.len()).step_by(CHUNK) {
            let end = (begin + CHUNK).min(wide.nodes.len());
            let (own, others) = rest.split_at_mut(first[end] - first[begin]);
            rest = others;
            tasks.push((begin..end, own));
        }
        let first = &first[..];
        tasks.into_par_iter().for_each(|(range, mut pairs)| {
            for rank in range {
                let (own, others) = pairs.split_at_mut(first[rank + 1] - first[rank]);
                pairs = others;
                let room = own.len();
                Unfolding { wide, mesh, first, rank, pairs: own, free: room }.run();
            }
        });
        self.place(ROOT, inner(wide, first, 0));
        self.fit_all();
    }
}

/// The most pairs that a wide node unfolds to: one less than it has inner children and references.
fn room_for(wide: &Bvh4, node: &WideNode<4>) -> usize {
    let below = |link: &Link| match link.get() {
        Child::Empty => 0,
        Child::Inner(_) => 1,
        Child::Leaf { first, count } => wide.leaf_ids(first, count).count(),
    };
    node.links.iter().map(below).sum::<usize>() - 1
}

/// The wide node of a rank, and the rank of an index.
fn rank(wide: &Bvh4, index: usize) -> usize {
    wide.nodes.len() - 1 - index
}

/// The binary node of the wide node of a rank: of its lone child where it has but one.
fn inner(wide: &Bvh4, first: &[usize], mut at: usize) -> Node {
    while first[at] == first[at + 1] {
        let node = &wide.nodes[rank(wide, at)];
        match node.links[0].get() {
            Child::Inner(lone) => at = rank(wide, lone),
            Child::Leaf { first, .. } => return Node::leaf(node.bounds(0), wide.blocks[first].prims[0]),
            Child::Empty => unreachable!("inner nodes have children"),
        }
    }
    Node::to_fit(first[at])
}

/// One wide node being unfolded.
struct Unfolding<'a> {
    wide: &'a Bvh4,
    mesh: &'a Mesh,
    first: &'a [usize],
    /// Its rank.
    rank: usize,
    /// Its pairs, made from the last to the first, so that parents come before children.
    pairs: &'a mut [Pair],
    /// How many of them are not yet made.
    free: usize,
}

impl Unfolding<'_> {
    fn node(&self) -> &WideNode<4> {
        &self.wide.nodes[rank(self.wide, self.rank)]
    }

    fn run(mut self) {
        if self.pairs.is_empty() {
            return;
        }
        let mut boxes = ArrayVec::<Aabb, 4>::new();
        let mut subtrees = ArrayVec::<Node, 4>::new();
        let node = *self.node();
        for (bounds, link) in node.children() {
            boxes.push(bounds);
            subtrees.push(match link.get() {
                Child::Leaf { first, count } => self.leaf(first, count, bounds),
                Child::Inner(below) => inner(self.wide, self.first, rank(self.wide, below)),
                Child::Empty => unreachable!("children are not empty"),
            });
        }
        self.join(&mut subtrees, &mut boxes);
        // Where references were left out some room is left over. The first pair is where the parent looks.
        if self.free > 0 {
            self.pairs[0] = self.pairs[self.free];
            self.pairs[1..=self.free].fill(Pair::UNUSED);
        }
    }

    /// A leaf's references as a closed subtree. Those whose triangle only its box led here are left out.
    fn leaf(&mut self, first: usize, count: usize, bounds: Aabb) -> Node {
        let mut boxes = ArrayVec::<Aabb, MAX_LEAF>::new();
        let mut references = ArrayVec::<Node, MAX_LEAF>::new();
        // So many must stay that the leaf remains, and a wide node with a lone leaf as well.
        let least = if self.node().links[1].is_empty() { MAX_LEAF } else { 1 };
        let mut left = self.wide.leaf_ids(first, count).count();
        for prim in self.wide.leaf_ids(first, count) {
            let part = visible(self.mesh, prim, bounds);
            if part.is_none() && left > least {
                left -= 1;
                continue;
            }
            let part = part.unwrap_or(bounds);
            boxes.push(part);
            references.push(Node::leaf(part, prim));
        }
        self.join(&mut references, &mut boxes)
    }

    /// Joins the two subtrees of the least common box until one is left: it is closed if it is of references.
    fn join<const N: usize>(
        &mut self,
        subtrees: &mut ArrayVec<Node, N>,
        boxes: &mut ArrayVec<Aabb, N>,
    ) -> Node {
        while subtrees.len() > 1 {
            let mut best = (f32::INFINITY, 0, 1);
            for b in 1..subtrees.len() {
                for a in 0..b {
                    let area = boxes[a].union(boxes[b]).half_area();
                    if area < best.0 {
                        best = (area, a, b);
                    }
                }
            }
            let (_, a, b) = best;
            self.free -= 1;
            let pair = Pair([subtrees[a], subtrees[b]]);
            self.pairs[self.free] = pair;
            let parent = Node::inner(&pair, self.first[self.rank] + self.free);
            boxes[a] = boxes[a].union(boxes[b]);
            subtrees[a] = if N == MAX_LEAF { parent.closed() } else { parent };
            subtrees.swap_remove(b);
            boxes.swap_remove(b);
        }
        subtrees[0]
    }
}

/// The box of the part of triangle `prim` inside `bounds`; none if they do not meet.
fn visible(mesh: &Mesh, prim: u32, bounds: Aabb) -> Option<Aabb> {
    let corners = mesh.corners(prim);
    let whole = Aabb::of_triangle(corners);
    if bounds.contains(whole) {
        return Some(whole);
    }
    // What touches a face from outside within rounding stays on both sides.
    let slack = bounds.min.abs().max(bounds.max.abs()) * (4.0 * f32::EPSILON);
    let grown = Aabb::new(bounds.min - slack, bounds.max + slack);
    let part = Polygon::triangle(corners).clipped(grown).bounds().intersection(bounds);
    (!part.is_empty()).then_some(part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    #[test]
    fn a_triangle_is_seen_as_far_as_it_reaches_into_the_box() {
        let vertices = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let (mesh, _) = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap();
        let space = |min: f32, max: f32| Aabb::new(Vec3A::splat(min), Vec3A::splat(max));
        assert_eq!(visible(&mesh, 0, space(-1.0, 9.0)), Some(mesh.bounds()));
        let part =
            visible(&mesh, 0, Aabb::new(Vec3A::new(3.0, 0.0, 0.0), Vec3A::new(4.0, 4.0, 0.0))).unwrap();
        assert!((part.max.y - 1.0).abs() < 1e-5 && part.min.x == 3.0, "{part:?}");
        // The box meets the triangle's box, but not the triangle.
        assert_eq!(visible(&mesh, 0, space(3.0, 4.0)), None);
    }
}
