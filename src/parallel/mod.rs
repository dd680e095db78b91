//! Parallel building blocks: tasks over a slice, a recursion divided into tasks, an append in the order of the tasks, a
//! radix sort. All that builders do in parallel goes through here, so that a [`timeline`] can record it.

pub(crate) mod disjoint;
pub(crate) mod ordered_append;
pub(crate) mod radix_sort;
pub(crate) mod slots;
pub(crate) mod task_tree;
pub(crate) mod timeline;

use rayon::prelude::*;
use slots::Slots;
use timeline::{fork, task};

/// What `f` makes of each of the items, in their order.
pub(crate) fn map<I, R>(items: I, f: impl Fn(I::Item) -> R + Sync) -> Vec<R>
where
    I: IntoIterator<Item: Send>,
    R: Send,
{
    let items: Slots<I::Item> = items.into_iter().collect();
    let results = Slots::empty(items.len());
    each_below(items.len(), &|i| results.put(i, f(items.take(i))));
    results.into_values().collect()
}

/// Calls `f` on each of the items.
pub(crate) fn for_each<I>(items: I, f: impl Fn(I::Item) + Sync)
where
    I: IntoIterator<Item: Send>,
{
    let items: Slots<I::Item> = items.into_iter().collect();
    each_below(items.len(), &|i| f(items.take(i)));
}

/// The results of both.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    let (mut a, mut b) = (Some(a), Some(b));
    let (mut of_a, mut of_b) = (None, None);
    both(&mut || of_a = a.take().map(|a| a()), &mut || of_b = b.take().map(|b| b()));
    (of_a.expect("both were called"), of_b.expect("both were called"))
}

// Rayon's code for a closure takes ten kilobytes. It is made for those below alone, which call what they are given, not
// for each use at each width: a release build of `phr` takes a tenth less.

/// Calls `f` with each number below `count`.
fn each_below(count: usize, f: &(dyn Fn(usize) + Sync)) {
    fork(|| (0..count).into_par_iter().for_each(|i| task(|| f(i))));
}

fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    fork(|| rayon::join(|| task(a), || task(b)));
}

/// Calls `f` so many times at once, each of which has tasks of its own.
fn on_threads(count: usize, f: &(dyn Fn() + Sync)) {
    fork(|| rayon::scope(|scope| (0..count).for_each(|_| scope.spawn(|_| f()))));
}
