//! CPU time of this process as the system counts it, and a spin check: did other programs hold the processors?

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// CPU time over a span, summed over this process's threads, in seconds. Systems other than Linux do not report
/// it: `ran_s` and `waited_s` stay 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CpuTime {
    /// Wall clock.
    pub wall_s: f64,
    /// Time on a processor.
    pub ran_s: f64,
    /// Time ready to run, but waiting for a processor that others held.
    pub waited_s: f64,
}

impl CpuTime {
    /// Fraction of their runnable time that threads waited for a processor, 0 to 1.
    pub fn waiting(&self) -> f64 {
        if self.waited_s > 0.0 { self.waited_s / (self.ran_s + self.waited_s) } else { 0.0 }
    }
}

impl std::iter::Sum for CpuTime {
    fn sum<I: Iterator<Item = Self>>(times: I) -> Self {
        times.fold(Self::default(), |a, b| Self {
            wall_s: a.wall_s + b.wall_s,
            ran_s: a.ran_s + b.ran_s,
            waited_s: a.waited_s + b.waited_s,
        })
    }
}

/// Above this [`CpuTime::waiting`] a measurement counts as disturbed.
pub const DISTURBED: f64 = 0.05;
/// Attempts at an undisturbed measurement.
const ATTEMPTS: usize = 4;

/// Measures until an attempt is undisturbed, four times at most, and returns the attempt with the least waiting. With
/// as many threads as processors, the scheduler at times keeps two threads on one processor and leaves another idle, no
/// matter which builder runs. Durations play no part in the choice.
///
/// # Errors
/// The first error of `measure`.
pub fn least_disturbed<T, E>(
    mut measure: impl FnMut() -> Result<(T, CpuTime), E>,
) -> Result<(T, CpuTime), E> {
    let mut best = measure()?;
    for _ in 1..ATTEMPTS {
        if best.1.waiting() <= DISTURBED {
            break;
        }
        let next = measure()?;
        if next.1.waiting() < best.1.waiting() {
            best = next;
        }
    }
    Ok(best)
}

/// A reading of this process's CPU time; [`CpuClock::since`] takes the difference.
#[derive(Clone, Copy, Debug)]
pub struct CpuClock {
    at: Instant,
    ran_ns: u64,
    waited_ns: u64,
}

impl CpuClock {
    /// Reads the CPU time of all threads.
    pub fn read() -> Self {
        let (mut ran_ns, mut waited_ns) = (0, 0);
        for task in std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten() {
            let text = std::fs::read_to_string(task.path().join("schedstat")).unwrap_or_default();
            let mut fields = text.split_whitespace().map(|field| field.parse().unwrap_or(0));
            ran_ns += fields.next().unwrap_or(0);
            waited_ns += fields.next().unwrap_or(0);
        }
        Self { at: Instant::now(), ran_ns, waited_ns }
    }

    /// CPU time since `self` was read. The time of threads that ended meanwhile is lost.
    pub fn since(&self) -> CpuTime {
        let now = Self::read();
        CpuTime {
            wall_s: now.at.duration_since(self.at).as_secs_f64(),
            ran_s: now.ran_ns.saturating_sub(self.ran_ns) as f64 * 1e-9,
            waited_s: now.waited_ns.saturating_sub(self.waited_ns) as f64 * 1e-9,
        }
    }
}

/// Result of the spin check.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spin {
    /// Threads that spun together.
    pub threads: usize,
    /// Work of one thread alone, million steps per second.
    pub alone: f64,
    /// Work of all threads together.
    pub together: f64,
    /// `together / (threads * alone)`: 1 if every thread had a processor of its own.
    pub efficiency: f64,
}

impl Spin {
    /// Below this [`Spin::efficiency`] the machine cannot carry the threads.
    pub const ENOUGH: f64 = 0.85;

    /// Spins once on one thread and once on `threads`, each for `span`.
    pub fn check(threads: usize, span: Duration) -> Self {
        let alone = spin(span);
        let together = std::thread::scope(|scope| {
            let spinning: Vec<_> = (0..threads).map(|_| scope.spawn(|| spin(span))).collect();
            spinning.into_iter().map(|thread| thread.join().unwrap_or(0.0)).sum::<f64>()
        });
        Self { threads, alone, together, efficiency: together / (threads as f64 * alone) }
    }

    /// True if every thread had nearly a processor of its own.
    pub fn is_enough(&self) -> bool {
        self.efficiency >= Self::ENOUGH
    }
}

/// Million steps of dependent arithmetic per second that this thread makes during `span`.
fn spin(span: Duration) -> f64 {
    const BLOCK: u64 = 1 << 14;
    let start = Instant::now();
    let (mut steps, mut x) = (0, 1u64);
    while start.elapsed() < span {
        for _ in 0..BLOCK {
            x = black_box(x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        }
        steps += BLOCK;
    }
    steps as f64 * 1e-6 / start.elapsed().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_sees_work() {
        let before = CpuClock::read();
        assert!(spin(Duration::from_millis(30)) > 0.0);
        let load = before.since();
        assert!(load.wall_s >= 0.03);
        if cfg!(target_os = "linux") {
            assert!(load.ran_s + load.waited_s > 0.0);
        }
    }

    #[test]
    fn the_least_disturbed_attempt_counts_whatever_it_took() {
        let chosen = |waits: &[f64]| {
            let mut attempts = waits.iter().enumerate();
            let measure = || {
                let (attempt, &waited_s) = attempts.next().ok_or("one attempt too many")?;
                Ok((attempt, CpuTime { wall_s: 1.0, ran_s: 1.0, waited_s }))
            };
            least_disturbed(measure).map(|(attempt, _)| attempt)
        };
        assert_eq!(chosen(&[0.0]), Ok(0));
        assert_eq!(chosen(&[0.5, 0.01]), Ok(1));
        assert_eq!(chosen(&[0.5, 0.2, 0.3, 0.4]), Ok(1));
        assert_eq!(chosen(&[0.5, 0.2]), Err("one attempt too many"));
    }

    #[test]
    fn the_spin_check_reports_what_it_measured() {
        let spin = Spin::check(2, Duration::from_millis(10));
        assert_eq!(spin.threads, 2);
        assert!(spin.alone > 0.0 && spin.together > 0.0);
        assert!((spin.efficiency - spin.together / (2.0 * spin.alone)).abs() < 1e-9);
    }
}
