//! Instructions and cycles of this process, as the processor counts them: where it does and Linux lets a program read
//! that (`perf_event_paranoid`; most virtual machines have no counters). Other programs hardly change them.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use serde::{Deserialize, Serialize};

/// What was counted over a span, of all threads in user space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counted {
    /// Instructions executed.
    pub instructions: u64,
    /// Cycles of the processors while they did so.
    pub cycles: u64,
}

/// Counters that run.
#[derive(Debug)]
pub struct HardwareCounters(counters::Counters);

impl HardwareCounters {
    /// Counts from now on, what threads started meanwhile do included; `None` where nothing can be counted.
    pub fn start() -> Option<Self> {
        counters::start().map(Self)
    }

    /// What was counted; `None` if the processor had too few counters for all of it.
    pub fn counted(self) -> Option<Counted> {
        let [instructions, cycles] = counters::read(self.0)?;
        Some(Counted { instructions, cycles })
    }
}

#[cfg(target_os = "linux")]
mod counters {
    use perf_event::events::{Event, Hardware};
    use perf_event::{Builder, Counter};

    /// Two of every thread.
    pub type Counters = Vec<[Counter; 2]>;

    pub fn start() -> Option<Counters> {
        start_both([Hardware::INSTRUCTIONS, Hardware::CPU_CYCLES])
    }

    pub fn start_both<E: Event + Copy>(events: [E; 2]) -> Option<Counters> {
        let mut counters = Vec::new();
        for task in std::fs::read_dir("/proc/self/task").ok()?.flatten() {
            let thread = task.file_name().to_str()?.parse().ok()?;
            let open = |event| {
                let mut builder = Builder::new(event);
                builder.observe_pid(thread).any_cpu().inherit(true).enabled(true).build()
            };
            let [first, second] = events.map(open);
            match (first, second) {
                (Ok(first), Ok(second)) => counters.push([first, second]),
                // It ended since the folder was read.
                (Err(error), _) | (_, Err(error)) if error.raw_os_error() == Some(libc::ESRCH) => {}
                _ => return None,
            }
        }
        Some(counters)
    }

    pub fn read(counters: Counters) -> Option<[u64; 2]> {
        counters.into_iter().try_fold([0; 2], |[a, b], [mut first, mut second]| {
            Some([a + whole(&mut first)?, b + whole(&mut second)?])
        })
    }

    /// The count over the whole time: where events take turns on a counter, each is seen for a part of it.
    fn whole(counter: &mut Counter) -> Option<u64> {
        let data = counter.read_full().ok()?;
        let (enabled, running) = (data.time_enabled()?, data.time_running()?);
        if enabled == running {
            return Some(data.count());
        }
        (!running.is_zero())
            .then(|| (data.count() as f64 * enabled.as_secs_f64() / running.as_secs_f64()) as u64)
    }
}

#[cfg(not(target_os = "linux"))]
mod counters {
    /// There are none.
    pub type Counters = std::convert::Infallible;

    pub fn start() -> Option<Counters> {
        None
    }

    pub fn read(counters: Counters) -> Option<[u64; 2]> {
        match counters {}
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::bench::cpu_time::CpuClock;
    use perf_event::events::Software;
    use std::hint::black_box;

    fn work() -> u64 {
        (0..3_000_000u64).fold(1, |x, i| black_box(x.wrapping_mul(i | 1)))
    }

    /// The kernel's clock of tasks is counted everywhere, by the same way as instructions.
    #[test]
    fn threads_that_were_there_and_new_ones_are_counted() {
        let Some(counters) = counters::start_both([Software::TASK_CLOCK; 2]) else {
            eprintln!("skipped: this system has no perf events");
            return;
        };
        let clock = CpuClock::read();
        black_box(rayon::join(work, work));
        std::thread::spawn(work).join().unwrap();
        let ran_ns = 1e9 * clock.since().ran_s;
        let [first, second] = counters::read(counters).unwrap();
        // The thread that ended is in the counters alone.
        assert!(first as f64 > 0.8 * ran_ns && second as f64 > 0.8 * ran_ns, "{first} {second} of {ran_ns}");
    }

    #[test]
    fn what_is_counted_grows_with_the_work() {
        let count = |times: usize| {
            let counters = HardwareCounters::start()?;
            for _ in 0..times {
                black_box(work());
            }
            counters.counted()
        };
        let (Some(little), Some(much)) = (count(1), count(4)) else {
            eprintln!("skipped: this machine counts no instructions");
            return;
        };
        assert!(little.instructions > 3_000_000 && little.cycles > 0, "{little:?}");
        assert!(much.instructions > 2 * little.instructions, "{little:?} {much:?}");
    }
}
