//! The binary splits of a recursion as a tree to be optimised: no wide node and no leaf block is made before it is
//! known which are worth it.

use super::tree::{Node, Pair, Tree};
use crate::builders::wide::top_down::{Kind, Memory, TopDown, Worker};
use crate::parallel::ordered_append::{self, Batch, Place, Spare};
use rayon::join;
use std::sync::{Mutex, OnceLock};

/// A part of the tree under construction, made by one task: links are relative to its own arrays.
#[derive(Default)]
pub(crate) struct Draft {
    pairs: Vec<Pair>,
    prims: Vec<u32>,
}

impl Draft {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.pairs.capacity() * size_of::<Pair>() + self.prims.capacity() * size_of::<u32>()
    }
}

impl Batch for Draft {
    type A = Pair;
    type B = u32;

    fn elements(&self) -> (&[Pair], &[u32]) {
        (&self.pairs, &self.prims)
    }

    #[inline]
    fn moved(pair: &Pair, [pairs, prims]: Place) -> Pair {
        Pair(pair.0.map(|node| node.moved(pairs, prims)))
    }

    fn clear(&mut self) {
        self.pairs.clear();
        self.prims.clear();
    }
}

/// The upper part of the tree over drafts yet to be made.
enum Upper<S> {
    Draft(S),
    Pair(Box<[Self; 2]>),
    Nothing,
}

impl Tree {
    /// Becomes the tree of the splits of `builder` below `root`, over leaves of up to four of `n` triangles. Returns
    /// false if there are none.
    pub fn draw<T: TopDown>(
        &mut self,
        builder: &T,
        root: T::Seed,
        n: usize,
        memory: &Memory<T::Scratch>,
        spare: &Spare<Draft>,
    ) -> bool {
        self.clear(n);
        // As for wide nodes: drafts fit caches, and their number depends on the scene alone.
        let grain = (n / 256).clamp(1 << 9, 1 << 12) as u32;
        let drawing = Drawing { builder, workers: &memory.workers };
        let mut seeds = Vec::new();
        let upper = drawing.upper(root, grain).number(&mut seeds);
        let begin = [self.pairs.len(), self.prims.len()];
        let made: Vec<OnceLock<(Option<Node>, Place)>> = seeds.iter().map(|_| OnceLock::new()).collect();
        ordered_append::append(
            seeds.len(),
            spare,
            &mut self.pairs,
            &mut self.prims,
            |i, draft: &mut Draft| {
                let seed = seeds[i].lock().expect("no task panics").take().expect("each task runs once");
                let root = drawing.draft(seed, draft);
                made[i].set((root, [draft.pairs.len(), draft.prims.len()])).expect("each task runs once");
            },
        );
        let mut at = begin;
        let roots: Vec<Option<Node>> = made
            .into_iter()
            .map(|made| {
                let (root, len) = made.into_inner().expect("all tasks have run");
                let moved = root.map(|root| root.moved(at[0], at[1]));
                at = [at[0] + len[0], at[1] + len[1]];
                moved
            })
            .collect();
        let root = upper.finish(&roots, &mut self.pairs);
        root.inspect(|&root| self.finish(root)).is_some()
    }
}

impl<S> Upper<S> {
    /// Moves the seeds to an array, depth first, and leaves their numbers.
    fn number(self, seeds: &mut Vec<Mutex<Option<S>>>) -> Upper<usize> {
        match self {
            Self::Draft(seed) => {
                seeds.push(Mutex::new(Some(seed)));
                Upper::Draft(seeds.len() - 1)
            }
            Self::Pair(halves) => Upper::Pair(Box::new((*halves).map(|half| half.number(seeds)))),
            Self::Nothing => Upper::Nothing,
        }
    }
}

impl Upper<usize> {
    /// Appends the upper pairs over the drafts' roots.
    fn finish(self, roots: &[Option<Node>], pairs: &mut Vec<Pair>) -> Option<Node> {
        match self {
            Self::Draft(i) => roots[i],
            Self::Pair(halves) => {
                let halves = (*halves).map(|half| half.finish(roots, pairs));
                unite(halves, pairs)
            }
            Self::Nothing => None,
        }
    }
}

/// Appends the pair of two subtrees, if both are there: pairs come after those below them.
#[inline]
fn unite(halves: [Option<Node>; 2], pairs: &mut Vec<Pair>) -> Option<Node> {
    match halves {
        [Some(left), Some(right)] => {
            let pair = Pair([left, right]);
            pairs.push(pair);
            Some(Node::inner(&pair, pairs.len() - 1))
        }
        [only, None] | [None, only] => only,
    }
}

/// Turns parts into pairs and leaves.
struct Drawing<'a, T: TopDown> {
    builder: &'a T,
    workers: &'a Spare<Box<Worker<T::Scratch>>>,
}

impl<T: TopDown> Drawing<'_, T> {
    /// Splits a part down to drafts of less than `grain` references, both sides in parallel.
    fn upper(&self, seed: T::Seed, grain: u32) -> Upper<T::Seed> {
        let mut worker = self.workers.take();
        let scratch = &mut worker.scratch;
        let mark = self.builder.mark(scratch);
        let part = self.builder.plant(seed, scratch);
        let is_draft = self.builder.count(&part) < grain;
        let sides = if is_draft { [Some(part), None] } else { self.builder.split(&part, scratch) };
        let seeds = sides.map(|side| side.map(|side| self.builder.lift(&side, scratch)));
        self.builder.release(scratch, mark);
        self.workers.put(worker);
        match seeds {
            [Some(seed), None] if is_draft => Upper::Draft(seed),
            [Some(left), Some(right)] => {
                let (left, right) = join(|| self.upper(left, grain), || self.upper(right, grain));
                Upper::Pair(Box::new([left, right]))
            }
            [Some(only), None] | [None, Some(only)] => self.upper(only, grain),
            [None, None] => Upper::Nothing,
        }
    }

    /// Makes the subtree of a seed; returns its root.
    fn draft(&self, seed: T::Seed, draft: &mut Draft) -> Option<Node> {
        let mut worker = self.workers.take();
        let mark = self.builder.mark(&worker.scratch);
        let part = self.builder.plant(seed, &mut worker.scratch);
        self.builder.approach(&part, &worker.scratch);
        let root = self.serial(&part, draft, &mut worker);
        self.builder.release(&mut worker.scratch, mark);
        self.workers.put(worker);
        root
    }

    fn serial(&self, part: &T::Part, draft: &mut Draft, worker: &mut Worker<T::Scratch>) -> Option<Node> {
        if self.builder.kind(part) != Kind::Inner {
            return self.leaf(part, draft, worker);
        }
        let mark = self.builder.mark(&worker.scratch);
        let sides = self.builder.split(part, &mut worker.scratch);
        let halves = sides.map(|side| side.and_then(|side| self.serial(&side, draft, worker)));
        self.builder.release(&mut worker.scratch, mark);
        unite(halves, &mut draft.pairs)
    }

    fn leaf(&self, part: &T::Part, draft: &mut Draft, worker: &mut Worker<T::Scratch>) -> Option<Node> {
        worker.prims.clear();
        let bounds = self.builder.visible_leaf(part, &mut worker.prims, &mut worker.scratch);
        let first = draft.prims.len();
        draft.prims.extend_from_slice(&worker.prims);
        (!worker.prims.is_empty()).then(|| Node::leaf(bounds, first, worker.prims.len()))
    }
}
