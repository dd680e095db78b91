//! Parallel building blocks: tasks over a slice, a recursion divided into tasks, an append in the order of the tasks, a
//! radix sort. What builders do in parallel goes through here, so that a [`timeline`] can record it, but for the check
//! of boxes, a library's sort in the reinsertion of `phr-best`, and arrays that are filled with one value
//! ([`resize`](crate::memory::huge_pages::resize)).

pub(crate) mod awake;
pub(crate) mod disjoint;
pub(crate) mod ordered_append;
pub(crate) mod radix_sort;
pub(crate) mod slots;
pub(crate) mod task_tree;
pub(crate) mod timeline;

use awake::{AtWork, wait};
use slots::Slots;
use std::sync::atomic::{AtomicUsize, Ordering};
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

/// Calls `f` with each number below `count`. A thread takes a range of its own, so that neighbours stay together from
/// step to step, and then what is left of others.
fn each_below(count: usize, f: &(dyn Fn(usize) + Sync)) {
    let threads = count.min(rayon::current_num_threads());
    let begin = |range: usize| range * count / threads;
    let next: Vec<AtomicUsize> = (0..threads).map(|range| AtomicUsize::new(begin(range))).collect();
    let own = AtomicUsize::new(0);
    on_threads(threads, &|| {
        let own = own.fetch_add(1, Ordering::Relaxed);
        for range in (own..threads).chain(0..own) {
            let take = || next[range].fetch_add(1, Ordering::Relaxed);
            let end = begin(range + 1);
            std::iter::repeat_with(take).take_while(|&i| i < end).for_each(|i| task(|| f(i)));
        }
    });
}

fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    // 1 when it begins, 2 when it is over.
    let calls_of_b = AtomicUsize::new(0);
    let first = || {
        let _at_work = AtWork::begin();
        task(a);
        // Where another thread has taken it up: rayon would sleep at once.
        if calls_of_b.load(Ordering::Relaxed) > 0 {
            wait(|| calls_of_b.load(Ordering::Relaxed) > 1);
        }
    };
    let second = || {
        let _at_work = AtWork::begin();
        let _begun = Told::begin(&calls_of_b);
        task(b);
    };
    fork(|| rayon::join(first, second));
}

/// Calls `f` so many times at once, on this thread and on others that are free.
fn on_threads(count: usize, f: &(dyn Fn() + Sync)) {
    let calls = AtomicUsize::new(0);
    let call = || {
        let _at_work = AtWork::begin();
        let _told = Told::begin(&calls);
        f();
    };
    let all = || {
        rayon::scope(|scope| {
            (1..count).for_each(|_| scope.spawn(|_| call()));
            if count > 0 {
                call();
            }
            let _at_work = AtWork::begin();
            // Rayon would sleep at once.
            wait(|| calls.load(Ordering::Relaxed) >= 2 * count);
        });
    };
    fork(all);
}

/// Counts when a call begins and when it is over, also where it panics. Only for those who wait: what they see of the
/// call's results is rayon's care.
struct Told<'a>(&'a AtomicUsize);

impl<'a> Told<'a> {
    fn begin(count: &'a AtomicUsize) -> Self {
        count.fetch_add(1, Ordering::Relaxed);
        Self(count)
    }
}

impl Drop for Told<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}
