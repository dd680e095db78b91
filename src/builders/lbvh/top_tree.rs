//! The upper part of an LBVH: sorted codes are bisected down to runs that fit the cache, each of which one task
//! then makes a subtree of.

use crate::builders::lbvh::sort::{Key, part};
use crate::builders::prims::refs::References;
use std::sync::{Mutex, MutexGuard};

/// Most references of a run.
pub(crate) const RUN: usize = 1 << 12;

/// A run of keys.
struct Run<'a> {
    first: usize,
    depth: u32,
    keys: Mutex<&'a mut [Key]>,
}

/// A subtree of the upper part.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Top {
    /// Number of a run.
    Run(usize),
    /// Number of a pair.
    Pair(usize),
}

/// Runs and the tree over them.
pub(crate) struct Upper<'a> {
    runs: Vec<Run<'a>>,
    /// Children before parents.
    pairs: Vec<[Top; 2]>,
}

impl<'a> Upper<'a> {
    /// Parts `keys`, of which there are some; those of one code are reordered.
    pub fn part(references: &References<'_>, keys: &'a mut [Key]) -> Self {
        let mut upper = Self { runs: Vec::new(), pairs: Vec::new() };
        upper.part_run(references, keys, 0, 0);
        upper
    }

    fn part_run(
        &mut self,
        references: &References<'_>,
        keys: &'a mut [Key],
        first: usize,
        depth: u32,
    ) -> Top {
        if keys.len() <= RUN {
            self.runs.push(Run { first, depth, keys: Mutex::new(keys) });
            return Top::Run(self.runs.len() - 1);
        }
        let mut below = depth;
        let split = part(keys, references, &mut below);
        let (left, right) = keys.split_at_mut(split);
        let left = self.part_run(references, left, first, below);
        let right = self.part_run(references, right, first + split, below);
        self.pairs.push([left, right]);
        Top::Pair(self.pairs.len() - 1)
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// The position of a run's first key, how often the run was parted by the middle, and its keys, for the one
    /// task that builds it.
    pub fn run(&self, i: usize) -> (usize, u32, MutexGuard<'_, &'a mut [Key]>) {
        let run = &self.runs[i];
        (run.first, run.depth, run.keys.lock().expect("no task panics"))
    }

    /// The root.
    pub fn top(&self) -> Top {
        if self.pairs.is_empty() { Top::Run(0) } else { Top::Pair(self.pairs.len() - 1) }
    }

    /// The children of a pair.
    pub fn children(&self, pair: usize) -> [Top; 2] {
        self.pairs[pair]
    }

    /// What `join` makes of the children of each pair, whose runs are `runs`.
    pub fn fold<T: Copy>(&self, runs: &[T], mut join: impl FnMut([T; 2]) -> T) -> Vec<T> {
        let mut pairs: Vec<T> = Vec::with_capacity(self.pairs.len());
        for pair in &self.pairs {
            let children = pair.map(|child| *of(child, runs, &pairs));
            pairs.push(join(children));
        }
        pairs
    }
}

/// The entry of a subtree of the upper part.
pub(crate) fn of<'a, T>(top: Top, runs: &'a [T], pairs: &'a [T]) -> &'a T {
    match top {
        Top::Run(run) => &runs[run],
        Top::Pair(pair) => &pairs[pair],
    }
}
