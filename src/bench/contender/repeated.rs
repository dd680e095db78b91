//! Builds repeated on warm threads, the same for all contenders.

use crate::bench::build_times::{WarmTimes, is_enough, ms};
use crate::bench::cpu_time::{CpuClock, least_disturbed};
use std::time::Duration;

/// Builds by `build`, which returns what its clock saw, until that is enough; all of them again while other programs
/// disturb them.
///
/// # Errors
/// The first error of `build`.
pub fn repeated<E>(mut build: impl FnMut() -> Result<Duration, E>) -> Result<WarmTimes, E> {
    let (ms, cpu_time) = least_disturbed(|| {
        let clock = CpuClock::read();
        let mut builds = Vec::new();
        while !is_enough(&builds) {
            builds.push(build()?);
        }
        Ok((builds.into_iter().map(ms).collect(), clock.since()))
    })?;
    Ok(WarmTimes { ms, cpu_time })
}
