//! Two arrays appended to by many tasks in the order of the tasks, where a task knows only when it is done how much
//! it appends.
//!
//! A task fills a chunk in memory of its own, which stays in the cache, and copies it to its offset as soon as the
//! lengths of all earlier chunks are known. The result is the same at any number of threads.
//!
//! Threads that wait spin. They cannot wait for ever: tasks are begun in order, so the earliest chunk without an offset
//! belongs to a task that some thread has begun. That thread waits for nothing before it has told the chunk's length,
//! unless it panics, which the alarm tells the others. So there always is a thread that makes progress, as long as
//! tasks do not wait for rayon's: a thread that does may take up another task on top of its own, and wait there for its
//! own chunk.

#![allow(unsafe_code)]

use super::disjoint::DisjointSlice;
use super::timeline;
use crate::memory::huge_pages;
use crate::memory::pool::Pool;
use std::collections::VecDeque;
use std::mem::MaybeUninit;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Offsets into, or lengths of, the two arrays.
pub(crate) type Offset = [usize; 2];

/// What a task appends: elements of two arrays.
pub(crate) trait Chunk: Default + Send {
    /// Elements of the first array, which may refer to elements of both.
    type A: Copy + Send;
    /// Elements of the second array.
    type B: Copy + Send;
    /// The elements.
    fn elements(&self) -> (&[Self::A], &[Self::B]);
    /// An element as it is in a chunk that begins at `offset`.
    fn moved(element: &Self::A, offset: Offset) -> Self::A;
    /// Copies the chunk to its places, which begin at `offset`.
    fn write(&self, offset: Offset, a: &mut [MaybeUninit<Self::A>], b: &mut [MaybeUninit<Self::B>]) {
        let (from_a, from_b) = self.elements();
        a.iter_mut().zip(from_a).for_each(|(to, a)| {
            to.write(Self::moved(a, offset));
        });
        b.iter_mut().zip(from_b).for_each(|(to, &b)| {
            to.write(b);
        });
    }
    /// Removes the elements and keeps the memory.
    fn clear(&mut self);

    /// Numbers of elements.
    fn lengths(&self) -> Offset {
        let (a, b) = self.elements();
        [a.len(), b.len()]
    }
}

/// Finished chunks that a thread keeps before it waits for others.
const PATIENCE: usize = 4;

/// Fills one chunk per task by `make` and appends them to the arrays `a` and `b` in the order of the tasks. Returns the
/// results of `make`, each with the offset of its chunk. The capacity of the arrays is used at once; what exceeds it is
/// kept until the end.
pub(crate) fn append<C: Chunk, R: Send>(
    tasks: usize,
    pool: &Pool<C>,
    a: &mut Vec<C::A>,
    b: &mut Vec<C::B>,
    make: impl Fn(usize, &mut C) -> R + Sync,
) -> Vec<(R, Offset)> {
    let begin = [a.len(), b.len()];
    let chain = Chain::new(tasks, begin);
    let next = AtomicUsize::new(0);
    let left_over = Mutex::new(Vec::new());
    let failed = AtomicBool::new(false);
    let (room_a, room_b) =
        (DisjointSlice::new(a.spare_capacity_mut()), DisjointSlice::new(b.spare_capacity_mut()));
    let write = |mut chunk: C, offset: Offset| {
        let (first, len) = ([offset[0] - begin[0], offset[1] - begin[1]], chunk.lengths());
        if first[0] + len[0] > room_a.len() || first[1] + len[1] > room_b.len() {
            left_over.lock().expect("no task panics").push((offset, chunk));
            return;
        }
        // SAFETY: within the slices, as just seen, and the chain gives every chunk places of its own.
        let (to_a, to_b) = unsafe { (room_a.range(first[0], len[0]), room_b.range(first[1], len[1])) };
        chunk.write(offset, to_a, to_b);
        chunk.clear();
        pool.put(chunk);
    };
    let work = || {
        let mut alarm = Alarm { failed: &failed, is_off: false };
        let mut waiting: VecDeque<(usize, C)> = VecDeque::new();
        loop {
            let task = next.fetch_add(1, Ordering::Relaxed);
            if task < tasks {
                let mut chunk = pool.take();
                let result = timeline::task(|| make(task, &mut chunk));
                chain.finish(task, result, chunk.lengths());
                waiting.push_back((task, chunk));
            }
            while let Some(&(first, _)) = waiting.front() {
                if let Some(offset) = chain.offset(first) {
                    let (_, chunk) = waiting.pop_front().expect("there is a front");
                    timeline::task(|| write(chunk, offset));
                } else if failed.load(Ordering::Relaxed) {
                    return;
                } else if task < tasks && waiting.len() < PATIENCE {
                    break;
                } else {
                    std::thread::yield_now();
                }
            }
            if task >= tasks {
                break;
            }
        }
        alarm.is_off = true;
    };
    let threads = rayon::current_num_threads().min(tasks);
    super::on_threads(threads, &work);

    let Links { tasks, end, .. } = chain.0.into_inner().expect("no task panics");
    let mut left_over = left_over.into_inner().expect("no task panics");
    left_over.sort_by_key(|&(offset, _)| offset);
    // Once a chunk has no room, none after it has: offsets only grow.
    let written = left_over.first().map_or(end, |&(offset, _)| offset);
    assert!(!failed.into_inner(), "a thread left its work");
    // SAFETY: each thread ended its work, as just seen, so that each chunk was written or left over; those below
    // `written` were written.
    unsafe {
        a.set_len(written[0]);
        b.set_len(written[1]);
    }
    huge_pages::reserve(a, end[0], "more than was foreseen");
    huge_pages::reserve(b, end[1], "more than was foreseen");
    // There may be many of them, and their memory, unlike that of the others, is not kept.
    for (offset, chunk) in left_over {
        let (from_a, from_b) = chunk.elements();
        a.extend(from_a.iter().map(|a| C::moved(a, offset)));
        b.extend_from_slice(from_b);
    }
    tasks.into_iter().map(|task| task.expect("all tasks have run")).collect()
}

/// Tells the other threads when one leaves its work by a panic: the task they wait for will never be done. It does not
/// ask whether the thread panics: one that unwinds already may do its work in a destructor.
struct Alarm<'a> {
    failed: &'a AtomicBool,
    /// The work is done.
    is_off: bool,
}

impl Drop for Alarm<'_> {
    fn drop(&mut self) {
        if !self.is_off {
            self.failed.store(true, Ordering::Relaxed);
        }
    }
}

/// Where each chunk begins, known once all tasks before its own are done.
struct Chain<R>(Mutex<Links<R>>);

struct Links<R> {
    /// Results of the tasks that are done, each with the lengths of its chunk, and then with its offset.
    tasks: Vec<Option<(R, Offset)>>,
    /// Tasks whose offsets are known.
    placed: usize,
    end: Offset,
}

impl<R> Chain<R> {
    fn new(tasks: usize, begin: Offset) -> Self {
        let tasks = std::iter::repeat_with(|| None).take(tasks).collect();
        Self(Mutex::new(Links { tasks, placed: 0, end: begin }))
    }

    fn finish(&self, task: usize, result: R, lengths: Offset) {
        let mut guard = self.0.lock().expect("no task panics");
        let Links { tasks, placed, end } = &mut *guard;
        tasks[task] = Some((result, lengths));
        while let Some(Some((_, entry))) = tasks.get_mut(*placed) {
            let [a, b] = std::mem::replace(entry, *end);
            *end = [end[0] + a, end[1] + b];
            *placed += 1;
        }
    }

    fn offset(&self, task: usize) -> Option<Offset> {
        let links = self.0.lock().expect("no task panics");
        if task < links.placed { links.tasks[task].as_ref().map(|(_, offset)| *offset) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Numbers(Vec<usize>, Vec<()>);

    impl Chunk for Numbers {
        type A = usize;
        type B = ();
        fn elements(&self) -> (&[usize], &[()]) {
            (&self.0, &self.1)
        }
        fn moved(element: &usize, at: Offset) -> usize {
            assert_eq!(at[0], at[1] + 1);
            *element
        }
        fn clear(&mut self) {
            self.0.clear();
            self.1.clear();
        }
    }

    #[test]
    fn a_panic_ends_the_whole() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let append = || {
            pool.install(|| {
                let make = |task: usize, _: &mut Numbers| assert!(task != 3);
                append(100, &Pool::default(), &mut vec![7], &mut Vec::new(), make);
            });
        };
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(append)).is_err());
    }

    /// Appends when it is dropped.
    struct Appends<'a>(&'a mut Vec<usize>);

    impl Drop for Appends<'_> {
        fn drop(&mut self) {
            let make = |task: usize, chunk: &mut Numbers| {
                if task % 3 == 1 {
                    std::thread::sleep(std::time::Duration::from_millis(2));
                }
                chunk.0.push(task);
                chunk.1.push(());
            };
            append(60, &Pool::default(), &mut *self.0, &mut Vec::with_capacity(60), make);
        }
    }

    #[test]
    fn a_thread_that_unwinds_already_ends_its_work() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        for _ in 0..5 {
            let mut a = vec![7];
            a.reserve_exact(60);
            let unwinding = || {
                pool.install(|| {
                    let _appends = Appends(&mut a);
                    std::panic::resume_unwind(Box::new("as wanted"));
                });
            };
            assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(unwinding)).is_err());
            assert_eq!(a, [7].into_iter().chain(0..60).collect::<Vec<_>>());
        }
    }

    #[test]
    fn chunks_follow_each_other_in_order_whatever_their_lengths_and_the_room() {
        let expected: Vec<usize> = [7]
            .into_iter()
            .chain((0..100).flat_map(|task| std::iter::repeat_n(task, task * 37 % 11)))
            .collect();
        for threads in [1, 2, 8] {
            for room in [0, 200, 10_000] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let (mut a, mut b) = (vec![7], Vec::new());
                a.reserve_exact(room);
                b.reserve_exact(room);
                let make = |task: usize, chunk: &mut Numbers| {
                    chunk.0.extend(std::iter::repeat_n(task, task * 37 % 11));
                    chunk.1.resize(chunk.0.len(), ());
                };
                pool.install(|| append(100, &Pool::default(), &mut a, &mut b, make));
                assert_eq!(a, expected);
                assert_eq!(b.len() + 1, a.len());
            }
        }
    }
}
