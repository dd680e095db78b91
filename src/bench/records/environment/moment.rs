//! The load of the machine at a moment: do other programs hold its processors?

use super::system::{line_of, text};
use crate::bench::cpu_time::Spin;
use serde::{Deserialize, Serialize};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Load of the machine at one moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// ISO 8601.
    pub utc: String,
    /// Load averages over 1, 5 and 15 minutes.
    pub load: String,
    /// Times that the control group was throttled so far.
    pub throttled: u64,
    /// Share of all processors that other programs used while this one rested; absent where the system does not tell.
    #[serde(default)]
    pub others: Option<f64>,
    /// The spin check.
    pub spin: Spin,
}

impl Moment {
    /// Now; rests for a fifth of a second and spins for an eighth.
    pub fn now(threads: usize) -> Self {
        let load = text("/proc/loadavg").split(' ').take(3).collect::<Vec<_>>().join(" ");
        let throttled = line_of("/sys/fs/cgroup/cpu.stat", "nr_throttled ").parse().unwrap_or(0);
        let others = others_share(Duration::from_millis(200));
        let spin = Spin::check(threads, SPIN);
        Self { utc: utc_now(), load, throttled, others, spin }
    }

    /// Why the machine is busy, if it is.
    pub fn busy(&self) -> Option<String> {
        let others = self.others.unwrap_or(0.0);
        (others > OTHERS || !self.spin.is_enough()).then(|| {
            let Spin { threads, efficiency, .. } = self.spin;
            format!(
                "the machine is busy: others use {:.0} % of it, {threads} threads reach {efficiency:.2} of their speed alone",
                100.0 * others
            )
        })
    }
}

/// How long each part of the spin check takes. On two processors, quiet or with another program on one, 120 ms tell no
/// more.
const SPIN: Duration = Duration::from_millis(60);

/// Largest share of the processors that other programs may use in a quiet hour.
const OTHERS: f64 = 0.1;

/// Share of all processors' time that was used or stolen while this thread rested for `span`.
fn others_share(span: Duration) -> Option<f64> {
    let read = || -> Option<[u64; 2]> {
        let ticks: Vec<u64> = line_of("/proc/stat", "cpu ")
            .split_whitespace()
            .map_while(|field| field.parse().ok())
            .take(8)
            .collect();
        // user, nice, system, idle, iowait, irq, softirq, steal
        let [_, _, _, idle, iowait, ..] = ticks[..] else { return None };
        (ticks.len() == 8).then(|| [ticks.iter().sum(), idle + iowait])
    };
    let before = read()?;
    std::thread::sleep(span);
    let after = read()?;
    let (all, idle) = (after[0].saturating_sub(before[0]), after[1].saturating_sub(before[1]));
    (all > 0).then(|| 1.0 - idle as f64 / all as f64)
}

/// The present time, ISO 8601, to the second.
pub fn utc_now() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    utc(seconds)
}

/// Seconds since 1970 as ISO 8601 (days to civil date after Hinnant).
fn utc(seconds: u64) -> String {
    let (days, rest) = ((seconds / 86_400) as i64 + 719_468, seconds % 86_400);
    let (era, day_of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z", rest / 3600, rest / 60 % 60, rest % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_right() {
        assert_eq!(utc(0), "1970-01-01T00:00:00Z");
        assert_eq!(utc(951_782_399), "2000-02-28T23:59:59Z");
        assert_eq!(utc(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(utc(4_107_542_400), "2100-03-01T00:00:00Z");
        assert_eq!(utc(1_798_761_599), "2026-12-31T23:59:59Z");
    }

    #[test]
    fn a_busy_machine_says_why() {
        let moment = |others, efficiency| {
            let spin = Spin { threads: 2, alone: 900.0, together: 1800.0 * efficiency, efficiency };
            Moment { utc: utc(0), load: "0 0 0".into(), throttled: 0, others, spin }
        };
        assert_eq!(moment(Some(0.02), 0.98).busy(), None);
        assert_eq!(moment(None, 0.98).busy(), None);
        let reason = moment(Some(0.37), 0.74).busy().unwrap();
        assert!(reason.contains("37 %") && reason.contains("0.74"), "{reason}");
        assert!(moment(Some(0.37), 0.98).busy().is_some() && moment(Some(0.0), 0.74).busy().is_some());
    }
}
