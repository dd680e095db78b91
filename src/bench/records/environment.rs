//! `environment.json`: the machine, the program and the settings of a run, and how it ended. Holds no host name
//! and no path of the machine.

use super::library::{UNKNOWN, output};
use crate::bench::cpu_time::Spin;
use serde::{Deserialize, Serialize};
use std::time::{SystemTime, UNIX_EPOCH};

pub use super::library::Library;

/// The file in a results folder.
pub const ENVIRONMENT: &str = "environment.json";

/// How far a run has come. A folder whose state is not [`State::Complete`] holds part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Under way, or killed.
    Running,
    /// Stopped by Ctrl-C; the rows are those of finished rounds.
    Interrupted,
    /// All rounds of all cells are done.
    Complete,
}

/// This program: what it was built from and how.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Version of the package.
    pub version: String,
    /// Git revision, `-dirty` if tracked files differed from it.
    pub git_rev: String,
    /// Compiler.
    pub rustc: String,
    /// Target triple.
    pub target: String,
    /// Cargo profile and optimisation level.
    pub profile: String,
    /// Flags given to the compiler beside the profile's.
    pub rustflags: String,
    /// Instruction sets assumed at compile time; kernels choose theirs at run time.
    pub target_features: String,
}

impl Program {
    /// This very program.
    pub fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            git_rev: env!("PHR_GIT_REV").into(),
            rustc: env!("PHR_RUSTC").into(),
            target: env!("PHR_TARGET").into(),
            profile: concat!(env!("PHR_PROFILE"), ", opt-level ", env!("PHR_OPT_LEVEL")).into(),
            rustflags: env!("PHR_RUSTFLAGS").into(),
            target_features: env!("PHR_TARGET_FEATURES").into(),
        }
    }
}

/// The machine and its system; "unknown" where the system does not say.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// A name given on the command line, else "anonymous".
    pub host: String,
    /// Processor model.
    pub cpu: String,
    /// Processors this process may use.
    pub processors: usize,
    /// Instruction sets of the processor that matter here.
    pub cpu_features: Vec<String>,
    /// Main memory, MiB.
    pub memory_mib: u64,
    /// Operating system.
    pub os: String,
    /// Kernel release.
    pub kernel: String,
    /// C library.
    pub libc: String,
    /// Processor time granted by the control group, "max" for no limit.
    pub cpu_quota: String,
    /// Transparent huge pages, as the kernel writes it: the mode in brackets.
    pub huge_pages: String,
    /// Frequency governor.
    pub governor: String,
}

impl Machine {
    /// The machine that this runs on.
    pub fn this(host: &str) -> Self {
        Self {
            host: host.into(),
            cpu: cpu_model(),
            processors: std::thread::available_parallelism().map_or(1, usize::from),
            cpu_features: cpu_features(),
            memory_mib: memory_kib("MemTotal:") / 1024,
            os: line_of("/etc/os-release", "PRETTY_NAME=").trim_matches('"').into(),
            kernel: text("/proc/sys/kernel/osrelease"),
            libc: output("getconf", &["GNU_LIBC_VERSION"]),
            cpu_quota: cpu_quota(),
            huge_pages: text("/sys/kernel/mm/transparent_hugepage/enabled"),
            governor: text("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
        }
    }
}

/// Load of the machine at one moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// ISO 8601.
    pub utc: String,
    /// Load averages over 1, 5 and 15 minutes.
    pub load: String,
    /// Times that the control group was throttled so far.
    pub throttled: u64,
    /// The spin check.
    pub spin: Spin,
}

impl Moment {
    /// Now; spins for about a quarter of a second.
    pub fn now(threads: usize) -> Self {
        let load = text("/proc/loadavg").split(' ').take(3).collect::<Vec<_>>().join(" ");
        let throttled = line_of("/sys/fs/cgroup/cpu.stat", "nr_throttled ").parse().unwrap_or(0);
        let spin = Spin::check(threads, std::time::Duration::from_millis(120));
        Self { utc: utc_now(), load, throttled, spin }
    }
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Environment {
    /// [`super::row::SCHEMA`].
    pub schema: u32,
    /// Names the run.
    pub run_id: String,
    /// How far it has come.
    pub state: State,
    /// The command line after the program's name, paths without their folders.
    pub arguments: Vec<String>,
    /// The settings (sizes, rounds, threads, seed) and the scenes.
    pub plan: serde_json::Value,
    /// This program.
    pub program: Program,
    /// The machine.
    pub machine: Machine,
    /// Embree.
    pub library: Library,
    /// Instruction sets in use, by our kernel and builders and by Embree's: an object of `phr`, `phr_builders`, `embree`
    /// and `embree_builders`; null without Embree.
    pub isa: serde_json::Value,
    /// Before the first round, and again where a run was resumed.
    pub before: Vec<Moment>,
    /// After the last.
    pub after: Option<Moment>,
    /// Remarks for the reader of the figures.
    pub notes: Vec<String>,
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

/// Memory available now, bytes, if the system reports it.
pub fn available_memory() -> Option<u64> {
    Some(memory_kib("MemAvailable:") * 1024).filter(|&bytes| bytes > 0)
}

fn memory_kib(key: &str) -> u64 {
    line_of("/proc/meminfo", key).split_whitespace().next().and_then(|kib| kib.parse().ok()).unwrap_or(0)
}

fn cpu_model() -> String {
    let model = line_of("/proc/cpuinfo", "model name");
    if model == UNKNOWN { std::env::consts::ARCH.into() } else { model.trim_matches([':', ' ', '\t']).into() }
}

fn cpu_features() -> Vec<String> {
    let known = ["sse4_2", "avx", "avx2", "fma", "avx512f", "avx512vl", "avx512bw", "asimd", "sve"];
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let flags = cpuinfo.lines().find(|line| line.starts_with("flags") || line.starts_with("Features"));
    let flags: Vec<&str> = flags.unwrap_or_default().split_whitespace().collect();
    known.iter().filter(|name| flags.contains(*name)).map(ToString::to_string).collect()
}

fn cpu_quota() -> String {
    let unified = text("/sys/fs/cgroup/cpu.max");
    if unified != UNKNOWN {
        return unified;
    }
    match text("/sys/fs/cgroup/cpu/cpu.cfs_quota_us").as_str() {
        UNKNOWN => UNKNOWN.into(),
        "-1" => "max".into(),
        quota => format!("{quota} {}", text("/sys/fs/cgroup/cpu/cpu.cfs_period_us")),
    }
}

fn text(path: &str) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    if text.trim().is_empty() { UNKNOWN.into() } else { text.trim().into() }
}

/// The rest of the first line that starts with `key`.
fn line_of(path: &str, key: &str) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let value = text.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
    value.unwrap_or(UNKNOWN).into()
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
    fn the_machine_is_described_without_its_name() {
        let machine = Machine::this("anonymous");
        assert!(machine.processors >= 1);
        assert_eq!(machine.host, "anonymous");
        let text = serde_json::to_string(&machine).unwrap();
        if let Ok(name) = std::fs::read_to_string("/proc/sys/kernel/hostname") {
            let name = name.trim();
            assert!(name.len() < 5 || !text.contains(name), "{text}");
        }
    }

    #[test]
    fn the_program_knows_its_compiler() {
        assert!(Program::this().rustc.contains("rustc"));
    }
}
