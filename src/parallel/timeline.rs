//! What a build does one after another and what it could do at once, recorded while one thread does all of it: the
//! critical path, and how long more threads than the machine has would take ([`crate::bench::scaling`]).

use std::cell::RefCell;
use std::time::Instant;

/// A part of a recorded run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Step {
    /// Seconds of work of one thread.
    Work(f64),
    /// Tasks that may run at once, each a run of its own; what follows waits for all of them.
    Fork(Vec<Vec<Step>>),
    /// The end of a phase of a build.
    Phase(&'static str),
}

/// What is open, outermost first: runs, and forks between them.
enum Open {
    Run(Vec<Step>),
    Fork(Vec<Vec<Step>>),
}

struct Recorder {
    /// Threads that the run is to believe it has.
    workers: usize,
    open: Vec<Open>,
    /// When the last part ended.
    last: Instant,
}

thread_local! {
    static RECORDER: RefCell<Option<Recorder>> = const { RefCell::new(None) };
}

/// Runs `f`, which divides its work for `workers` threads, and records its steps.
///
/// # Panics
/// If the current rayon pool has more than one thread: tasks of others would not be seen.
#[cfg_attr(not(any(feature = "harness", test)), expect(dead_code))]
pub(crate) fn record<R>(workers: usize, f: impl FnOnce() -> R) -> (R, Vec<Step>) {
    /// Ends the recording, also when `f` panics.
    struct Ended;
    impl Drop for Ended {
        fn drop(&mut self) {
            RECORDER.take();
        }
    }

    assert_eq!(rayon::current_num_threads(), 1, "a pool of one thread records");
    RECORDER.set(Some(Recorder { workers, open: vec![Open::Run(Vec::new())], last: Instant::now() }));
    let ended = Ended;
    let result = f();
    let steps = with(|recorder| {
        recorder.work();
        match recorder.open.pop() {
            Some(Open::Run(steps)) => steps,
            _ => Vec::new(),
        }
    });
    drop(ended);
    (result, steps.unwrap_or_default())
}

/// The threads to divide work for.
pub(crate) fn workers() -> usize {
    with(|recorder| recorder.workers).unwrap_or_else(rayon::current_num_threads)
}

/// Ends a phase.
pub(crate) fn phase(name: &'static str) {
    with(|recorder| {
        recorder.work();
        recorder.push(Step::Phase(name));
    });
}

/// Runs `f`, within which calls of [`task`] may run at once.
#[inline]
pub(crate) fn fork<R>(f: impl FnOnce() -> R) -> R {
    fork_begins();
    let result = f();
    fork_ends();
    result
}

/// Runs `f`, a task of the innermost [`fork`].
#[inline]
pub(crate) fn task<R>(f: impl FnOnce() -> R) -> R {
    task_begins();
    let result = f();
    task_ends();
    result
}

// Not in the functions above, of which there is a copy for each closure.

fn fork_begins() {
    with(|recorder| {
        recorder.work();
        recorder.open.push(Open::Fork(Vec::new()));
    });
}

fn fork_ends() {
    with(|recorder| {
        if let Some(Open::Fork(tasks)) = recorder.open.pop() {
            recorder.push(Step::Fork(tasks));
        }
        recorder.last = Instant::now();
    });
}

fn task_begins() {
    with(|recorder| {
        recorder.open.push(Open::Run(Vec::new()));
        recorder.last = Instant::now();
    });
}

fn task_ends() {
    with(|recorder| {
        recorder.work();
        if let Some(Open::Run(steps)) = recorder.open.pop()
            && let Some(Open::Fork(tasks)) = recorder.open.last_mut()
        {
            tasks.push(steps);
        }
    });
}

/// Calls `f` if this thread records.
#[inline]
fn with<R>(f: impl FnOnce(&mut Recorder) -> R) -> Option<R> {
    RECORDER.with_borrow_mut(|recorder| recorder.as_mut().map(f))
}

impl Recorder {
    /// Ends the work that the thread has done since the last part.
    fn work(&mut self) {
        let now = Instant::now();
        self.push(Step::Work((now - self.last).as_secs_f64()));
        self.last = now;
    }

    fn push(&mut self, step: Step) {
        if let Some(Open::Run(steps)) = self.open.last_mut() {
            steps.push(step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shape of a run: "w" for work, "p" for a phase, tasks in brackets.
    fn shape(steps: &[Step]) -> String {
        let one = |step: &Step| match step {
            Step::Work(seconds) => {
                assert!(*seconds >= 0.0);
                "w".to_owned()
            }
            Step::Phase(_) => "p".to_owned(),
            Step::Fork(tasks) => {
                format!("[{}]", tasks.iter().map(|task| shape(task)).collect::<Vec<_>>().join(","))
            }
        };
        steps.iter().map(one).collect()
    }

    fn alone<R: Send>(f: impl FnOnce() -> R + Send) -> R {
        rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(f)
    }

    #[test]
    fn runs_are_recorded_as_they_nest() {
        let (result, steps) = alone(|| {
            record(16, || {
                let (a, b) =
                    crate::parallel::join(|| crate::parallel::map(vec![1, 2], |x| x + workers()), || 5);
                phase("sum");
                a.iter().sum::<usize>() + b
            })
        });
        assert_eq!(result, 40);
        assert_eq!(shape(&steps), "w[w[w,w]w,w]wpw");
        assert_eq!(alone(workers), 1, "the recording has ended");
    }

    #[test]
    fn a_panic_ends_the_recording() {
        alone(|| {
            let panicked = std::panic::catch_unwind(|| record(9, || panic!("on purpose")));
            assert!(panicked.is_err() && workers() == 1);
        });
    }
}
