//! The builder that makes the auxiliary LBVH wide and does nothing better. Runs are built, made wide and written
//! while they are in the cache; the tree over them is made wide at the end.

use crate::builders::builder::{Build, Builder, Counts, Stopwatch};
use crate::builders::lbvh::direct_treelet::WideRun;
use crate::builders::lbvh::sort::MortonOrder;
use crate::builders::lbvh::top_tree::{self, Top, Upper};
use crate::builders::wide::top_down::{Memory, WIDTH};
use crate::builders::wide::treelet::{self, Subtree};
use crate::bvh::{Bvh4, Link, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::parallel::ordered_append::Spare;
use arrayvec::ArrayVec;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Builds the LBVH (see [`crate::builders::lbvh::auxiliary`]); memory is kept between builds.
#[derive(Default)]
pub struct Lbvh {
    order: MortonOrder,
    runs: Spare<WideRun>,
    memory: Memory<()>,
}

impl Builder for Lbvh {
    fn name(&self) -> &'static str {
        "lbvh"
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({ "code_bits": crate::builders::lbvh::morton::BITS })
    }

    fn build(&mut self, mesh: &Mesh) -> Build {
        let mut watch = Stopwatch::start();
        self.order.sort(mesh, None, self.memory.blocks(mesh.len()), &mut watch);
        let mut keys = std::mem::take(&mut self.order.keys);
        let pairs = AtomicUsize::new(0);
        let tree = if keys.is_empty() { Bvh4::default() } else { self.tree(mesh, &mut keys, &pairs) };
        self.order.keys = keys;
        watch.lap("tree");
        let auxiliary_nodes = 2 * pairs.into_inner() as u64 + 1;
        let counts = Counts { auxiliary_nodes, ..Counts::default() };
        let mut runs = 0;
        self.runs.for_each(|run| runs += run.bytes());
        Build::finish(tree, watch.phases, counts, self.order.bytes() + runs + self.memory.bytes())
    }

    fn recycle(&mut self, tree: Bvh4) {
        self.memory.recycle(tree);
    }
}

impl Lbvh {
    /// The tree over sorted keys, of which there are some.
    fn tree(&mut self, mesh: &Mesh, keys: &mut [u64], pairs: &AtomicUsize) -> Bvh4 {
        let references = &self.order.references(mesh);
        let (mut nodes, mut blocks) = self.memory.arrays(mesh.len());
        let upper = Upper::part(references, keys);
        let subtrees =
            treelet::append(upper.len(), &self.memory.pieces, &mut nodes, &mut blocks, |i, piece| {
                let mut run = self.runs.take();
                let (_, depth, keys) = upper.run(i);
                let subtree = run.build(mesh, &keys, depth, piece);
                pairs.fetch_add(run.pairs() + 1, Ordering::Relaxed);
                self.runs.put(run);
                subtree
            });
        let bounds: Vec<Aabb> =
            subtrees.iter().map(|subtree| subtree.map_or(Aabb::EMPTY, |(b, _)| b)).collect();
        let pair_bounds = upper.fold(&bounds, |[left, right]| left.union(right));
        let wide = Wide { upper: &upper, subtrees: &subtrees, bounds: &bounds, pair_bounds: &pair_bounds };
        match wide.subtree(upper.top(), &mut nodes) {
            None => Bvh4::default(),
            Some((bounds, root)) => Bvh4 { root, bounds, nodes, blocks },
        }
    }
}

/// The upper part on its way to wide nodes.
struct Wide<'a> {
    upper: &'a Upper<'a>,
    subtrees: &'a [Subtree],
    bounds: &'a [Aabb],
    pair_bounds: &'a [Aabb],
}

impl Wide<'_> {
    /// Appends the wide nodes below `top`, opening the largest first (paper 4.5).
    fn subtree(&self, top: Top, nodes: &mut Vec<WideNode<WIDTH>>) -> Subtree {
        if let Top::Run(run) = top {
            return self.subtrees[run];
        }
        let mut children = ArrayVec::<Top, WIDTH>::from_iter([top]);
        while children.len() < WIDTH {
            let area = |i: usize| top_tree::of(children[i], self.bounds, self.pair_bounds).half_area();
            let pairs = (0..children.len()).filter(|&i| matches!(children[i], Top::Pair(_)));
            let Some(largest) = pairs.reduce(|a, b| if area(b) > area(a) { b } else { a }) else { break };
            if let Top::Pair(pair) = children[largest] {
                let [left, right] = self.upper.children(pair);
                children[largest] = left;
                children.insert(largest + 1, right);
            }
        }
        let built: ArrayVec<(Aabb, Link), WIDTH> =
            children.into_iter().filter_map(|child| self.subtree(child, nodes)).collect();
        treelet::append_node(&built, nodes)
    }
}
