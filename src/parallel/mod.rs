//! Parallel building blocks: tasks over a slice, a recursion divided into tasks, an append in the order of the tasks, a
//! radix sort. All that builders do in parallel goes through here, so that a [`timeline`] can record it.

pub(crate) mod disjoint;
pub(crate) mod ordered_append;
pub(crate) mod radix_sort;
pub(crate) mod task_tree;
pub(crate) mod timeline;

use rayon::prelude::*;
use timeline::{fork, task};

/// What `f` makes of each of the items, in their order.
pub(crate) fn map<I, R>(items: I, f: impl Fn(I::Item) -> R + Sync + Send) -> Vec<R>
where
    I: IntoParallelIterator<Iter: IndexedParallelIterator>,
    R: Send,
{
    fork(|| items.into_par_iter().map(|item| task(|| f(item))).collect())
}

/// Calls `f` on each of the items.
pub(crate) fn for_each<I>(items: I, f: impl Fn(I::Item) + Sync + Send)
where
    I: IntoParallelIterator,
{
    fork(|| items.into_par_iter().for_each(|item| task(|| f(item))));
}

/// The results of both.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    fork(|| rayon::join(|| task(a), || task(b)))
}
