//! The recursion every top-down builder shares: wide nodes formed by splitting the largest child first
//! (paper 4.5), subtrees built in parallel (4.6), and their assembly into one tree.
//!
//! Where the paper shares a queue of unbuilt subtrees among threads, rayon's deques do it here; each task
//! emits into memory of its own, and the pieces are put together in depth-first order, so that the tree is the
//! same at any number of threads.

#![allow(unsafe_code)]

use super::pages;
use super::primitives::GRAIN;
use crate::bvh::{Bvh4, Link, MAX_LEAF_BLOCKS, TriangleBlock, WideNode};
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;
use rayon::prelude::*;
use std::sync::Mutex;

/// Children of a wide node.
pub(super) const WIDTH: usize = 4;
/// Triangles of a leaf block: up to so many are always a leaf.
pub(super) const QUARTET: u32 = 4;

/// What a concrete builder supplies.
pub(super) trait TopDown: Sync {
    /// An unbuilt subtree.
    type Part: Send;
    /// Memory and counts of one task.
    type Scratch: Default + Send;

    /// Triangle references below the part, an upper bound where it is clipped.
    fn count(&self, part: &Self::Part) -> u32;

    /// Half the surface area of the part's box.
    fn half_area(&self, part: &Self::Part) -> f32;

    /// Whether the part is to become a leaf; it is then of at most 4 * [`MAX_LEAF_BLOCKS`] references.
    fn is_leaf(&self, part: &Self::Part) -> bool;

    /// Divides a part that is no leaf in two, either of which may turn out to be empty; or finds that it should
    /// be a leaf, and gives it back as one.
    fn split(&self, part: Self::Part, scratch: &mut Self::Scratch) -> [Option<Self::Part>; 2];

    /// Splits a part that is no leaf into up to four: the largest that is no leaf first (paper 4.5).
    fn children(&self, part: Self::Part, scratch: &mut Self::Scratch) -> ArrayVec<Self::Part, WIDTH> {
        let mut children = ArrayVec::new();
        children.push(part);
        while (1..WIDTH).contains(&children.len()) {
            let splittable = (0..children.len()).filter(|&i| !self.is_leaf(&children[i]));
            let area = |i: usize| self.half_area(&children[i]);
            let Some(largest) = splittable.reduce(|a, b| if area(b) > area(a) { b } else { a }) else {
                break;
            };
            let [left, right] = self.split(children.remove(largest), scratch);
            if let Some(right) = right {
                children.insert(largest, right);
            }
            if let Some(left) = left {
                children.insert(largest, left);
            }
        }
        children
    }

    /// Appends the triangles of a leaf; returns their box, clipped like the part.
    fn leaf(&self, part: Self::Part, ids: &mut Vec<u32>, scratch: &mut Self::Scratch) -> Aabb;
}

/// Memory of tasks, kept from build to build.
pub(super) struct Pool<S> {
    workers: Mutex<Vec<Worker<S>>>,
    pieces: Mutex<Vec<Piece>>,
}

impl<S> Default for Pool<S> {
    fn default() -> Self {
        Self { workers: Mutex::default(), pieces: Mutex::default() }
    }
}

impl<S: Default> Pool<S> {
    /// Calls `f` on each worker's scratch memory: to gather counts.
    pub fn for_each_scratch(&self, f: impl FnMut(&mut S)) {
        self.workers.lock().expect("no task panics").iter_mut().map(|worker| &mut worker.scratch).for_each(f);
    }

    /// Bytes held by the pieces of the last tree.
    pub fn bytes(&self) -> usize {
        self.pieces.lock().expect("no task panics").iter().map(Piece::bytes).sum()
    }

    fn worker(&self) -> Worker<S> {
        self.workers.lock().expect("no task panics").pop().unwrap_or_default()
    }

    fn put_back(&self, worker: Worker<S>) {
        self.workers.lock().expect("no task panics").push(worker);
    }
}

#[derive(Default)]
struct Worker<S> {
    scratch: S,
    ids: Vec<u32>,
}

/// A serially built part of the tree; links are relative to its own arrays.
#[derive(Default)]
struct Piece {
    nodes: Vec<WideNode<WIDTH>>,
    blocks: Vec<TriangleBlock>,
}

impl Piece {
    fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<WideNode<WIDTH>>()
            + self.blocks.capacity() * size_of::<TriangleBlock>()
    }
}

/// A finished subtree.
enum Subtree {
    /// Built by one task.
    Piece(Piece, Link),
    /// An upper node whose children were built in parallel.
    Spine(Vec<(Aabb, Subtree)>),
}

/// Builds the tree below `root`.
pub(super) fn build<T: TopDown>(
    builder: &T,
    root: Option<T::Part>,
    mesh: &Mesh,
    pool: &Pool<T::Scratch>,
) -> Bvh4 {
    let task = Task { builder, mesh, pool };
    match root.and_then(|root| task.parallel(root)) {
        None => Bvh4::default(),
        Some((bounds, subtree)) => assemble(bounds, subtree, pool),
    }
}

struct Task<'a, T: TopDown> {
    builder: &'a T,
    mesh: &'a Mesh,
    pool: &'a Pool<T::Scratch>,
}

impl<T: TopDown> Task<'_, T> {
    /// Builds a part, its children in parallel while they are large. `None` if clipping left nothing of it.
    fn parallel(&self, part: T::Part) -> Option<(Aabb, Subtree)> {
        let mut worker = self.pool.worker();
        if (self.builder.count(&part) as usize) < GRAIN {
            let mut piece = self.pool.pieces.lock().expect("no task panics").pop().unwrap_or_default();
            let built = self.serial(part, &mut piece, &mut worker);
            self.pool.put_back(worker);
            return built.map(|(bounds, link)| (bounds, Subtree::Piece(piece, link)));
        }
        let children = self.builder.children(part, &mut worker.scratch);
        self.pool.put_back(worker);
        let children: Vec<_> = children
            .into_iter()
            .collect::<Vec<_>>()
            .into_par_iter()
            .filter_map(|child| self.parallel(child))
            .collect();
        let bounds = children.iter().map(|(bounds, _)| *bounds).collect();
        (!children.is_empty()).then_some((bounds, Subtree::Spine(children)))
    }

    /// Builds a part depth first into `piece`.
    fn serial(
        &self,
        part: T::Part,
        piece: &mut Piece,
        worker: &mut Worker<T::Scratch>,
    ) -> Option<(Aabb, Link)> {
        if self.builder.is_leaf(&part) {
            return self.leaf(part, piece, worker);
        }
        let mut children = self.builder.children(part, &mut worker.scratch);
        // Clipping may leave a single child, or the part be found to be a leaf: it takes its parent's place.
        if children.len() <= 1 {
            return self.serial(children.pop()?, piece, worker);
        }
        let index = piece.nodes.len();
        piece.nodes.push(WideNode::EMPTY);
        let mut node = WideNode::EMPTY;
        let (mut bounds, mut slot) = (Aabb::EMPTY, 0);
        let mut last = Link::EMPTY;
        for child in children {
            if let Some((child_bounds, link)) = self.serial(child, piece, worker) {
                node.set(slot, child_bounds, link);
                bounds = bounds.union(child_bounds);
                last = link;
                slot += 1;
            }
        }
        if slot <= 1 {
            // The others were clipped away and emitted nothing. A node left in place for a lone inner child
            // would only cost a visit, and taking it out would move the ones after it: it is rare, so it stays.
            if slot == 0 || !last.is_inner() {
                piece.nodes.pop();
                return (slot == 1).then_some((bounds, last));
            }
        }
        piece.nodes[index] = node;
        Some((bounds, Link::inner(index)))
    }

    fn leaf(
        &self,
        part: T::Part,
        piece: &mut Piece,
        worker: &mut Worker<T::Scratch>,
    ) -> Option<(Aabb, Link)> {
        worker.ids.clear();
        let bounds = self.builder.leaf(part, &mut worker.ids, &mut worker.scratch);
        if worker.ids.is_empty() {
            return None;
        }
        let first = piece.blocks.len();
        debug_assert!(worker.ids.len() <= QUARTET as usize * MAX_LEAF_BLOCKS);
        for ids in worker.ids.chunks(QUARTET as usize) {
            let mut block = TriangleBlock::EMPTY;
            for (lane, &prim) in ids.iter().enumerate() {
                block.set(lane, self.mesh.corners(prim), prim);
            }
            piece.blocks.push(block);
        }
        Some((bounds, Link::leaf(first, piece.blocks.len() - first)))
    }
}

/// Puts the pieces together: the spine's nodes first, then piece after piece, depth first.
fn assemble<S>(bounds: Aabb, subtree: Subtree, pool: &Pool<S>) -> Bvh4 {
    let mut plan = Plan { spine: Vec::new(), pieces: Vec::new(), nodes: 0, blocks: 0 };
    plan.nodes = spine_len(&subtree);
    let root = plan.place(subtree);
    let (mut nodes, mut blocks) = (Vec::new(), Vec::new());
    pages::reserve(&mut nodes, plan.nodes);
    pages::reserve(&mut blocks, plan.blocks);
    nodes.extend_from_slice(&plan.spine);
    let mut node_room = nodes.spare_capacity_mut();
    let mut block_room = blocks.spare_capacity_mut();
    let mut copies = Vec::with_capacity(plan.pieces.len());
    let mut first_node = plan.spine.len();
    let mut first_block = 0;
    for piece in plan.pieces {
        let (to_nodes, rest) = node_room.split_at_mut(piece.nodes.len());
        node_room = rest;
        let (to_blocks, rest) = block_room.split_at_mut(piece.blocks.len());
        block_room = rest;
        let at = (first_node, first_block);
        first_node += to_nodes.len();
        first_block += to_blocks.len();
        copies.push((piece, to_nodes, to_blocks, at));
    }
    let pieces: Vec<Piece> = copies
        .into_par_iter()
        .map(|(mut piece, to_nodes, to_blocks, (first_node, first_block))| {
            for (to, node) in to_nodes.iter_mut().zip(&piece.nodes) {
                let links = node.links.map(|link| link.moved(first_node, first_block));
                to.write(WideNode { links, ..*node });
            }
            for (to, block) in to_blocks.iter_mut().zip(&piece.blocks) {
                to.write(*block);
            }
            piece.nodes.clear();
            piece.blocks.clear();
            piece
        })
        .collect();
    pool.pieces.lock().expect("no task panics").extend(pieces);
    // SAFETY: the spine and the pieces were written one after the other without a gap: `plan.nodes` and
    // `plan.blocks` are the sums of their lengths, and the capacities are no less.
    unsafe {
        nodes.set_len(plan.nodes);
        blocks.set_len(plan.blocks);
    }
    Bvh4 { root, bounds, nodes, blocks }
}

fn spine_len(subtree: &Subtree) -> usize {
    match subtree {
        Subtree::Piece(..) => 0,
        Subtree::Spine(children) => 1 + children.iter().map(|(_, child)| spine_len(child)).sum::<usize>(),
    }
}

/// Where everything goes.
struct Plan {
    spine: Vec<WideNode<WIDTH>>,
    pieces: Vec<Piece>,
    /// Nodes placed so far, the whole spine included.
    nodes: usize,
    blocks: usize,
}

impl Plan {
    fn place(&mut self, subtree: Subtree) -> Link {
        match subtree {
            Subtree::Piece(piece, link) => {
                let link = link.moved(self.nodes, self.blocks);
                self.nodes += piece.nodes.len();
                self.blocks += piece.blocks.len();
                self.pieces.push(piece);
                link
            }
            Subtree::Spine(children) => {
                let index = self.spine.len();
                self.spine.push(WideNode::EMPTY);
                for (slot, (bounds, child)) in children.into_iter().enumerate() {
                    let link = self.place(child);
                    self.spine[index].set(slot, bounds, link);
                }
                Link::inner(index)
            }
        }
    }
}
