//! Arrays written by many tasks in the order of the tasks, each task knowing only when it is done how much it
//! has to write.
//!
//! Tasks make batches in memory of their own, which stays in the cache, and copy them to their place as soon
//! as those before them are known. What comes out is the same at any number of threads.

#![allow(unsafe_code)]

use std::collections::VecDeque;
use std::mem::MaybeUninit;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Places in, or lengths of, the two arrays.
pub(crate) type Place = [usize; 2];

/// What a task makes: elements of two arrays.
pub(crate) trait Batch: Default + Send {
    /// Elements of the first array, which name places in both.
    type A: Copy + Send;
    /// Elements of the second array.
    type B: Copy + Send;
    /// The elements.
    fn elements(&self) -> (&[Self::A], &[Self::B]);
    /// What an element becomes in a batch that begins at `at`.
    fn moved(element: &Self::A, at: Place) -> Self::A;
    /// Fills the batch's places, which begin at `at`.
    fn put(&self, at: Place, a: &mut [MaybeUninit<Self::A>], b: &mut [MaybeUninit<Self::B>]) {
        let (from_a, from_b) = self.elements();
        a.iter_mut().zip(from_a).for_each(|(to, a)| {
            to.write(Self::moved(a, at));
        });
        b.iter_mut().zip(from_b).for_each(|(to, &b)| {
            to.write(b);
        });
    }
    /// Forgets what it holds, but not its memory.
    fn clear(&mut self);
}

/// Finished batches that a thread keeps before it waits for others.
const PATIENCE: usize = 4;

/// Memory kept from build to build.
pub(crate) struct Spare<T>(Mutex<Vec<T>>);

impl<T> Default for Spare<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Default> Spare<T> {
    /// Memory used before, or new.
    pub fn take(&self) -> T {
        self.0.lock().expect("no task panics").pop().unwrap_or_default()
    }

    /// Keeps `memory`.
    pub fn put(&self, memory: T) {
        self.0.lock().expect("no task panics").push(memory);
    }

    /// Looks at all that is kept.
    pub fn for_each(&self, f: impl FnMut(&mut T)) {
        self.0.lock().expect("no task panics").iter_mut().for_each(f);
    }
}

/// Makes `tasks` batches by `make` and appends them to the arrays `a` and `b` in the order of the tasks.
/// Capacity that the arrays have is used at once; what exceeds it is kept until the end.
pub(crate) fn append<T: Batch>(
    tasks: usize,
    spare: &Spare<T>,
    a: &mut Vec<T::A>,
    b: &mut Vec<T::B>,
    make: impl Fn(usize, &mut T) + Sync,
) {
    let chain = Chain::new(tasks, [a.len(), b.len()]);
    let next = AtomicUsize::new(0);
    let left_over = Mutex::new(Vec::new());
    let failed = AtomicBool::new(false);
    let (room_a, room_b) = (Room::new(a), Room::new(b));
    let put = |mut batch: T, at: Place| {
        let (from_a, from_b) = batch.elements();
        let len = [from_a.len(), from_b.len()];
        if at[0] + len[0] > room_a.capacity || at[1] + len[1] > room_b.capacity {
            left_over.lock().expect("no task panics").push((at, batch));
            return;
        }
        // SAFETY: the chain gives every batch places of its own, beyond the arrays' elements, and these are
        // below the capacities; the arrays are borrowed and not touched until all tasks have ended.
        let (to_a, to_b) = unsafe { (room_a.places(at[0], len[0]), room_b.places(at[1], len[1])) };
        batch.put(at, to_a, to_b);
        batch.clear();
        spare.put(batch);
    };
    let work = || {
        let _alarm = Alarm(&failed);
        let mut waiting: VecDeque<(usize, T)> = VecDeque::new();
        loop {
            // Tasks are begun in order, so that whoever waits for an earlier one waits for one that runs.
            let task = next.fetch_add(1, Ordering::Relaxed);
            if task < tasks {
                let mut batch = spare.take();
                make(task, &mut batch);
                let (a, b) = batch.elements();
                chain.finish(task, [a.len(), b.len()]);
                waiting.push_back((task, batch));
            }
            while let Some(&(first, _)) = waiting.front() {
                if let Some(at) = chain.place(first) {
                    let (_, batch) = waiting.pop_front().expect("there is a front");
                    put(batch, at);
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
    };
    rayon::scope(|scope| (0..rayon::current_num_threads().min(tasks)).for_each(|_| scope.spawn(|_| work())));

    let mut left_over = left_over.into_inner().expect("no task panics");
    left_over.sort_by_key(|&(at, _)| at);
    // Once a batch has no room, none after it has: places only grow.
    let written = left_over.first().map_or(chain.end(), |&(at, _)| at);
    // SAFETY: all places below `written` were filled, see `put`.
    unsafe {
        a.set_len(written[0]);
        b.set_len(written[1]);
    }
    let end = chain.end();
    a.reserve_exact(end[0] - a.len());
    b.reserve_exact(end[1] - b.len());
    // They may be many, and their memory, unlike that of the others, is not kept.
    for (at, batch) in left_over {
        let (from_a, from_b) = batch.elements();
        a.extend(from_a.iter().map(|a| T::moved(a, at)));
        b.extend_from_slice(from_b);
    }
}

/// Tells the other threads when one panics: the task they wait for will never be done.
struct Alarm<'a>(&'a AtomicBool);

impl Drop for Alarm<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// The memory of an array, to be filled by several threads.
struct Room<T> {
    first: *mut MaybeUninit<T>,
    capacity: usize,
}

// SAFETY: threads get references to disjoint places only, see `append`.
unsafe impl<T: Send> Sync for Room<T> {}

impl<T> Room<T> {
    fn new(array: &mut Vec<T>) -> Self {
        Self { first: array.as_mut_ptr().cast(), capacity: array.capacity() }
    }

    /// The places `first..first + len`.
    ///
    /// # Safety
    /// They lie within the capacity of the array, hold no elements, and nobody else has them meanwhile.
    #[allow(clippy::mut_from_ref)] // disjoint, by the caller's promise
    unsafe fn places(&self, first: usize, len: usize) -> &mut [MaybeUninit<T>] {
        // SAFETY: the caller's promise.
        unsafe { std::slice::from_raw_parts_mut(self.first.add(first), len) }
    }
}

/// Where each task writes, known once all before it are done.
struct Chain(Mutex<Links>);

struct Links {
    /// Lengths of tasks that are done, then their places.
    tasks: Vec<Option<Place>>,
    /// Tasks whose places are known.
    placed: usize,
    end: Place,
}

impl Chain {
    fn new(tasks: usize, begin: Place) -> Self {
        Self(Mutex::new(Links { tasks: vec![None; tasks], placed: 0, end: begin }))
    }

    fn finish(&self, task: usize, len: Place) {
        let mut guard = self.0.lock().expect("no task panics");
        let links = &mut *guard;
        links.tasks[task] = Some(len);
        while let Some(Some(entry)) = links.tasks.get_mut(links.placed) {
            let [a, b] = std::mem::replace(entry, links.end);
            links.end = [links.end[0] + a, links.end[1] + b];
            links.placed += 1;
        }
    }

    fn place(&self, task: usize) -> Option<Place> {
        let links = self.0.lock().expect("no task panics");
        if task < links.placed { links.tasks[task] } else { None }
    }

    fn end(&self) -> Place {
        self.0.lock().expect("no task panics").end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Numbers(Vec<usize>, Vec<()>);

    impl Batch for Numbers {
        type A = usize;
        type B = ();
        fn elements(&self) -> (&[usize], &[()]) {
            (&self.0, &self.1)
        }
        fn moved(element: &usize, at: Place) -> usize {
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
                append(100, &Spare::default(), &mut vec![7], &mut Vec::new(), make);
            });
        };
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(append)).is_err());
    }

    #[test]
    fn batches_follow_each_other_in_order_whatever_their_lengths_and_the_room() {
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
                let make = |task: usize, batch: &mut Numbers| {
                    batch.0.extend(std::iter::repeat_n(task, task * 37 % 11));
                    batch.1.resize(batch.0.len(), ());
                };
                pool.install(|| append(100, &Spare::default(), &mut a, &mut b, make));
                assert_eq!(a, expected);
                assert_eq!(b.len() + 1, a.len());
            }
        }
    }
}
