//! The binary splits of a recursion, recorded as a tree to be optimised: no wide node and no leaf block is made
//! before it is known which pay.

use super::tree::{LinkedNode, Pair, Tree};
use crate::builders::binary::kind::Kind;
use crate::builders::phr::cut::{Cut, OwnedCut};
use crate::builders::phr::memory::CutScratch;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::memory::{Memory, Scratch, Worker};
use crate::builders::wide::parallel::ParallelBuild;
use crate::builders::wide::top_down::BinarySplits;
use crate::memory::pool::Pool;
use crate::parallel::ordered_append::{Chunk, Offset};

/// The pairs and triangles of one task: links are relative to its own arrays.
#[derive(Default)]
pub(super) struct RecordedChunk {
    pairs: Vec<Pair>,
    prims: Vec<u32>,
}

impl Chunk for RecordedChunk {
    type A = Pair;
    type B = u32;

    fn elements(&self) -> (&[Pair], &[u32]) {
        (&self.pairs, &self.prims)
    }

    #[inline]
    fn moved(pair: &Pair, [pairs, prims]: Offset) -> Pair {
        Pair(pair.0.map(|node| node.moved(pairs, prims)))
    }

    fn clear(&mut self) {
        self.pairs.clear();
        self.prims.clear();
    }
}

impl Tree {
    /// Becomes the tree of the splits of `recursion` below `root`, over leaves of up to four primitives of
    /// `geometry`. Returns false if there are none.
    pub fn record<P: CutPolicy, G: Geometry, const N: usize>(
        &mut self,
        recursion: &CutRecursion<'_, P, G>,
        root: OwnedCut,
        geometry: &G,
        memory: &Memory<CutScratch, N, G::Block>,
        pool: &Pool<RecordedChunk>,
    ) -> bool {
        self.clear(geometry.len());
        let parallel = ParallelBuild::new(recursion, &memory.workers, geometry.len());
        let tasks = parallel.split_tasks::<2>(root);
        let arrays = (&mut self.pairs, &mut self.prims);
        let (tree, built) = parallel
            .run(tasks, pool, arrays, |cut, chunk, worker| record(recursion, geometry, cut, chunk, worker));
        let moved =
            |(root, [pairs, prims]): (Option<LinkedNode>, Offset)| root.map(|root| root.moved(pairs, prims));
        let roots: Vec<Option<LinkedNode>> = built.into_iter().map(moved).collect();
        let root = tree.fold(&roots, &mut |halves| match halves {
            [left, right] => merge([*left, *right], &mut self.pairs),
            _ => halves.first().copied().flatten(),
        });
        root.inspect(|&root| self.finish(root)).is_some()
    }
}

/// Appends the pair of two subtrees, if both are there: pairs come after those below them.
#[inline]
fn merge(halves: [Option<LinkedNode>; 2], pairs: &mut Vec<Pair>) -> Option<LinkedNode> {
    match halves {
        [Some(left), Some(right)] => {
            let pair = Pair([left, right]);
            pairs.push(pair);
            Some(LinkedNode::inner(&pair, pairs.len() - 1))
        }
        [only, None] | [None, only] => only,
    }
}

/// Records the splits below a cut, depth first; returns the root, if clipping left anything.
fn record<P: CutPolicy, G: Geometry>(
    recursion: &CutRecursion<'_, P, G>,
    geometry: &G,
    cut: &Cut,
    chunk: &mut RecordedChunk,
    worker: &mut Worker<CutScratch>,
) -> Option<LinkedNode> {
    if recursion.kind(cut) != Kind::Inner {
        let Worker { scratch, prims } = worker;
        prims.clear();
        // The leaf sees what lies of its triangles within the cut; those of which nothing does are left out.
        let bounds = recursion.gather(cut, prims, scratch, |prim, bounds| geometry.visible(prim, bounds));
        let first = chunk.prims.len();
        chunk.prims.extend_from_slice(prims);
        return (!prims.is_empty()).then(|| LinkedNode::leaf(bounds, first, prims.len()));
    }
    let checkpoint = worker.scratch.checkpoint();
    let sides = recursion.split(cut, &mut worker.scratch);
    let halves = sides.map(|side| side.and_then(|side| record(recursion, geometry, &side, chunk, worker)));
    worker.scratch.rollback(checkpoint);
    merge(halves, &mut chunk.pairs)
}
