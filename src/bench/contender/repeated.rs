//! Builds repeated on warm threads, the same for all contenders.

use crate::bench::build_times::{WarmTimes, is_enough, ms};
use crate::bench::cpu_time::{CpuClock, least_disturbed};
use crate::bench::hardware_counters::HardwareCounters;
use rayon::ThreadPool;
use std::convert::Infallible;
use std::time::{Duration, Instant};

/// What `build` makes on `pool`, and how long that took.
pub fn timed<T: Send>(pool: &ThreadPool, build: impl FnOnce() -> T + Send) -> (Duration, T) {
    pool.install(|| {
        let start = Instant::now();
        let built = build();
        (start.elapsed(), built)
    })
}

/// Builds by `build`, which returns what its clock saw, until that is enough; all of them again while other programs
/// disturb them.
///
/// # Errors
/// The first error of `build`.
pub fn repeated<E>(mut build: impl FnMut() -> Result<Duration, E>) -> Result<WarmTimes, E> {
    let ((ms, counted), cpu_time) = least_disturbed(|| {
        let counters = HardwareCounters::start();
        let clock = CpuClock::read();
        let mut builds = Vec::new();
        while !is_enough(&builds) {
            builds.push(build()?);
        }
        let cpu_time = clock.since();
        let counted = counters.and_then(HardwareCounters::counted);
        Ok(((builds.into_iter().map(ms).collect(), counted), cpu_time))
    })?;
    Ok(WarmTimes { ms, cpu_time, counted })
}

/// As [`repeated`], of builds that cannot fail.
pub fn warm(mut build: impl FnMut() -> Duration) -> WarmTimes {
    let Ok(times) = repeated(|| Ok::<_, Infallible>(build()));
    times
}
