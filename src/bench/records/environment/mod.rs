//! `environment.json`: the machine, the program and the settings of a run, and how it ended. Holds no host name
//! and no path of the machine.

mod library;
pub mod moment;
mod system;

use crate::bench::files::Written;
use moment::Moment;
use serde::{Deserialize, Serialize};
use std::hash::Hasher;
pub use system::UNKNOWN;
use system::{line_of, output, text};

pub use library::Library;

/// The file in a results folder.
pub const ENVIRONMENT: &str = "environment.json";

/// What a reader of results can do about such a file that is not whole.
pub const REMEDY: &str = "fetch it again, or remove it: then the machine is not known";

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
    /// A hash of the executable, where its revision does not tell what it was made of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub executable: Option<String>,
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
            executable: env!("PHR_GIT_REV").ends_with("-dirty").then(executable),
        }
    }
}

/// A hash of the executable of this process; "unknown" if it cannot be read.
fn executable() -> String {
    let hash = |bytes: Vec<u8>| {
        let mut hasher = std::hash::DefaultHasher::new();
        hasher.write(&bytes);
        format!("{:016x}", hasher.finish())
    };
    std::env::current_exe().and_then(std::fs::read).map_or_else(|_| UNKNOWN.into(), hash)
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

/// The whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Environment {
    /// [`crate::bench::row::SCHEMA`].
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
    /// Instruction sets in use, by our kernel and builders and by Embree's: an object of `phr`, `phr_builders`,
    /// `embree` and `embree_builders`; null without Embree.
    pub isa: serde_json::Value,
    /// Before the first round, and again where a run was resumed.
    pub before: Vec<Moment>,
    /// After the last.
    pub after: Option<Moment>,
    /// Remarks for the reader of the figures.
    pub notes: Vec<String>,
    /// Lines of the other files, once the run has ended: one of them that was cut is not taken for the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub written: Option<Written>,
}

impl Environment {
    /// Whether times of both may be averaged: of like processors, instruction sets and libraries.
    pub fn is_alike(&self, other: &Self) -> bool {
        let traits =
            |of: &Self| (of.machine.cpu.clone(), of.machine.processors, of.machine.cpu_features.clone());
        traits(self) == traits(other) && self.isa == other.isa && self.library == other.library
    }
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

#[cfg(test)]
mod tests {
    use super::*;

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
