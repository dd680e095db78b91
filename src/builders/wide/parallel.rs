//! Paper 4.6: subtrees are built in parallel.
//!
//! The paper shares a queue of unbuilt subtrees among threads. Here the upper part of the recursion is divided into
//! tasks that fit a cache ([`TaskTree`]); each task builds a chunk, and the chunks are appended in the order of the
//! tasks ([`ordered_append`]), so that the tree is the same at any number of threads.

use super::memory::{Scratch, Worker};
use super::optimal::Choice;
use super::top_down::TopDown;
use crate::memory::pool::Pool;
use crate::parallel::ordered_append::{self, Chunk, Offset};
use crate::parallel::task_tree::{Division, TaskTree};

/// Parts of as many references are divided further in any scene.
const MAX_GRAIN: usize = 1 << 12;

/// A count that [`Choice`] does not tell exactly is above it.
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
        // Tasks are small enough for caches and many enough for threads, and their number depends on the scene alone.
        Self { builder, workers, grain: (n / 256).clamp(1 << 9, MAX_GRAIN) as u32 }
    }

    /// Divides `root` by `divide` into tasks, builds each by `make` into a chunk, and appends the chunks to `a` and
    /// `b`. Returns the tree over the tasks, and the results of `make` with the offsets of the chunks.
    pub fn run<C: Chunk, R: Send>(
        &self,
        root: T::Task,
        pool: &Pool<C>,
        (a, b): (&mut Vec<C::A>, &mut Vec<C::B>),
        divide: impl Fn(&T::Part, &mut T::Scratch) -> Vec<T::Part> + Sync,
        make: impl Fn(&T::Part, &mut C, &mut Worker<T::Scratch>) -> R + Sync,
    ) -> (TaskTree<usize>, Vec<(R, Offset)>) {
        let tree = TaskTree::grow(root, &|task| {
            self.with_part(task, |part, worker| {
                let scratch = &mut worker.scratch;
                if self.builder.count(part) < self.grain || self.builder.is_leaf(part) {
                    return Division::Task(self.builder.export(part, scratch));
                }
                let parts = divide(part, scratch);
                Division::Parts(parts.iter().map(|part| self.builder.export(part, scratch)).collect())
            })
        });
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
    fn with_part<R>(&self, task: T::Task, f: impl FnOnce(&T::Part, &mut Worker<T::Scratch>) -> R) -> R {
        let mut worker = self.workers.take();
        let checkpoint = worker.scratch.checkpoint();
        let part = self.builder.import(task, &mut worker.scratch);
        let result = f(&part, &mut worker);
        worker.scratch.rollback(checkpoint);
        self.workers.put(worker);
        result
    }
}
