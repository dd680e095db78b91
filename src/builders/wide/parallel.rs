//! Paper 4.6: subtrees are built in parallel.
//!
//! The paper shares a queue of unbuilt subtrees among threads. Here the upper part of the recursion is divided into
//! tasks that fit a cache ([`TaskTree`]), with splits made ahead where there are any ([`super::ahead`]); each task
//! builds a chunk, and the chunks are appended in the order of the tasks ([`ordered_append`]), so that the tree is the
//! same at any number of threads.

use super::memory::{Scratch, Worker};
use super::optimal::Choice;
use super::top_down::{MAX_GRAIN, TopDown};
use crate::memory::pool::Pool;
use crate::parallel::ordered_append::{self, Chunk, Offset};
use crate::parallel::task_tree::{Division, TaskTree};
use arrayvec::ArrayVec;

/// A count that [`Choice`] does not tell exactly is above the grain of trees of them, which is that of most builders.
const _: () = assert!(MAX_GRAIN <= Choice::MOST as usize);

/// A recursion over a scene, divided into tasks.
pub(crate) struct ParallelBuild<'a, T: TopDown> {
    /// What builds the parts.
    pub builder: &'a T,
    /// Memory of threads.
    pub workers: &'a Pool<Box<Worker<T::Scratch>>>,
    /// Parts of fewer references than this are a task.
    grain: u32,
}

impl<'a, T: TopDown> ParallelBuild<'a, T> {
    /// Over a scene of `n` triangles.
    pub fn new(builder: &'a T, workers: &'a Pool<Box<Worker<T::Scratch>>>, n: usize) -> Self {
        Self { builder, workers, grain: builder.grain(n) as u32 }
    }

    /// Whether one thread builds the part.
    pub fn is_task(&self, part: &T::Part) -> bool {
        self.builder.count(part) < self.grain || self.builder.is_leaf(part)
    }

    /// The tasks below `root`, the children of the wide node over each part being known.
    pub fn tasks<const N: usize>(&self, root: T::Task) -> TaskTree<T::Task> {
        TaskTree::grow(root, &|task| {
            self.with_part(task, |part, Worker { scratch, .. }| {
                let export = |part: &T::Part, scratch: &T::Scratch| self.builder.export(part, scratch);
                if self.is_task(part) {
                    return Division::Task(export(part, scratch));
                }
                let mut parts = ArrayVec::<_, N>::new();
                self.builder.children(part, scratch, &mut parts);
                Division::Parts(parts.iter().map(|part| export(part, scratch)).collect())
            })
        })
    }

    /// Builds each task by `make` into a chunk, and appends the chunks to `a` and `b`. Returns the tree over the tasks,
    /// and the results of `make` with the offsets of the chunks.
    pub fn run<C: Chunk, R: Send>(
        &self,
        tree: TaskTree<T::Task>,
        pool: &Pool<C>,
        (a, b): (&mut Vec<C::A>, &mut Vec<C::B>),
        make: impl Fn(&T::Part, &mut C, &mut Worker<T::Scratch>) -> R + Sync,
    ) -> (TaskTree<usize>, Vec<(R, Offset)>) {
        let (tree, tasks) = tree.number();
        let built = ordered_append::append(tasks.len(), pool, a, b, |task, chunk| {
            self.with_part(tasks.take(task), |part, worker| {
                self.builder.prefetch(part, &worker.scratch);
                make(part, chunk, worker)
            })
        });
        (tree, built)
    }

    /// Calls `f` on a part in the memory of a worker, which is as before afterwards.
    pub fn with_part<R>(&self, task: T::Task, f: impl FnOnce(&T::Part, &mut Worker<T::Scratch>) -> R) -> R {
        let mut worker = self.workers.take();
        let checkpoint = worker.scratch.checkpoint();
        let part = self.builder.import(task, &mut worker.scratch);
        let result = f(&part, &mut worker);
        worker.scratch.rollback(checkpoint);
        self.workers.put(worker);
        result
    }
}
