//! Threads that stay awake while a tree is built.
//!
//! Rayon's threads go to sleep after some microseconds without work, and take some tens of microseconds to wake. A
//! build has a dozen steps, each of which waits for the one before, and takes a few milliseconds in all. So the threads
//! of its pool look for work until it is over ([`Awake`]), and so does a thread that waits for others ([`wait`]).
//! Embree's threads, which are TBB's, do much the same.
//!
//! All this only takes the place of sleep: a thread that finds nothing for [`PATIENCE`] goes to sleep as ever, whatever
//! it waits for. A thread that is [`AtWork`] on a part of a build, and waits for the rest of it, does not begin to stay
//! awake for another build on top: it would not see that its own wait is over.

use rayon::Yield;
use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long a thread looks for work in vain: longer than most steps that one thread makes alone.
const PATIENCE: Duration = Duration::from_millis(1);
/// For builds over fewer primitives not all threads are woken: most are of few tasks. The number was not tuned.
const FEW: usize = 1 << 14;
/// Pauses of the processor between two looks for work: no more than some microseconds, in which the core's other thread
/// has the core to itself.
const PAUSES: usize = 32;

thread_local! {
    /// Parts of builds on the stack of this thread.
    static PARTS: Cell<usize> = const { Cell::new(0) };
}

/// While this lives, this thread is at work on a part of a build.
#[derive(Debug)]
pub(crate) struct AtWork {
    /// Of one thread alone.
    _thread: PhantomData<*const ()>,
}

impl AtWork {
    pub fn begin() -> Self {
        PARTS.set(PARTS.get() + 1);
        Self { _thread: PhantomData }
    }

    fn is_here() -> bool {
        PARTS.get() > 0
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        PARTS.set(PARTS.get() - 1);
    }
}

/// While this lives, a build, idle threads of the pool do not go to sleep at once.
#[derive(Debug)]
pub(crate) struct Awake {
    is_over: Arc<AtomicBool>,
    _at_work: AtWork,
}

impl Awake {
    /// Of a build over so many primitives.
    pub fn begin(primitives: usize) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        // One within another build, as of a test's, has threads that are awake.
        if primitives >= FEW && rayon::current_num_threads() > 1 && !AtWork::is_here() {
            let is_over = Arc::clone(&is_over);
            rayon::spawn_broadcast(move |_| {
                if !AtWork::is_here() {
                    wait(|| is_over.load(Ordering::Relaxed));
                }
            });
        }
        Self { is_over, _at_work: AtWork::begin() }
    }
}

impl Drop for Awake {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
    }
}

/// Takes up tasks of the pool until `is_over`, or until there are none for too long.
pub(super) fn wait(is_over: impl Fn() -> bool) {
    let mut idle_since = Instant::now();
    while !is_over() && idle_since.elapsed() < PATIENCE {
        if rayon::yield_now() == Some(Yield::Executed) {
            idle_since = Instant::now();
        } else {
            (0..PAUSES).for_each(|_| std::hint::spin_loop());
            // To other programs, where there are more threads than processors.
            std::thread::yield_now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::{for_each, join};

    /// Builds within builds, which threads take up on top of one another.
    #[test]
    fn builds_at_once_in_one_pool_end() {
        fn build(depth: usize) -> usize {
            let _awake = Awake::begin(FEW);
            for_each(0..3, |_| std::hint::black_box(()));
            if depth == 0 {
                return 1;
            }
            // A part of a build that builds, and rayon's own fork around two.
            let (a, (b, c)) =
                join(|| build(depth - 1), || rayon::join(|| build(depth - 1), || build(depth - 1)));
            a + b + c
        }
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let outside = pool.install(|| rayon::join(|| build(4), || build(4)));
            assert_eq!(outside, (81, 81));
            assert!(!AtWork::is_here());
        }
        assert_eq!(build(3), 27, "outside a pool");
    }

    #[test]
    fn a_build_that_panics_is_over() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let build = |fails: bool| {
            let _awake = Awake::begin(FEW);
            for_each(0..4, |i| assert!(!fails || i != 2, "failed"));
        };
        let failed = pool.install(|| std::panic::catch_unwind(|| build(true)));
        assert!(failed.is_err());
        // Both threads are there for what follows.
        pool.install(|| build(false));
        let at_work = pool.broadcast(|_| AtWork::is_here());
        assert_eq!(at_work, [false; 2]);
    }
}
