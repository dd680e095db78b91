//! What reading a file may cost: memory for its mesh, and bytes that come out of a compressed one.
//!
//! Sizes that a file declares are checked before memory is taken, sizes that it does not while its mesh grows. What is
//! refused is kept here, because errors of decoders and deserializers between do not carry a remedy.

use super::error::Fault;
use std::cell::RefCell;

/// What a scene read from a file may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of vertices, triangles and buffers that are held at a time.
    pub memory: u64,
}

impl Limits {
    /// What this machine has to give now: memory that is free or can be freed, of the control group where it has less.
    /// Without limit where the system does not tell (it does on Linux).
    pub fn of_machine() -> Self {
        let text = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
        let kibibytes = text("/proc/meminfo").lines().find_map(|line| {
            line.strip_prefix("MemAvailable:")?.split_whitespace().next()?.parse::<u64>().ok()
        });
        let number = |path: &str| text(path).trim().parse::<u64>().ok();
        let group = number("/sys/fs/cgroup/memory.max").map(|most| {
            // Cached files are given back where memory is short.
            let stat = text("/sys/fs/cgroup/memory.stat");
            let cached = stat.lines().find_map(|line| line.strip_prefix("file ")?.trim().parse().ok());
            let current = number("/sys/fs/cgroup/memory.current").unwrap_or(0);
            most.saturating_sub(current.saturating_sub(cached.unwrap_or(0)))
        });
        let machine = kibibytes.map(|kibibytes| kibibytes.saturating_mul(1024));
        Self { memory: machine.into_iter().chain(group).min().unwrap_or(u64::MAX) }
    }
}

/// Keeps a reader within [`Limits`], and why it stopped.
#[derive(Debug)]
pub(super) struct Guard {
    memory: u64,
    refusal: RefCell<Option<Fault>>,
}

/// The guard has refused; it has the reason.
#[derive(Debug, thiserror::Error)]
#[error("refused")]
pub(super) struct Refused;

impl Guard {
    /// The remedy for what takes too much.
    const REMEDY: &'static str = "free memory, allow more (--max-memory) or give a smaller scene";

    pub fn new(limits: &Limits) -> Self {
        Self { memory: limits.memory, refusal: RefCell::new(None) }
    }

    /// Refuses `bytes` held at a time where they are too many.
    pub fn allow(&self, bytes: u64) -> Result<(), Refused> {
        if bytes <= self.memory {
            return Ok(());
        }
        let problem = format!(
            "takes {} or more of memory, of which {} may be taken",
            mebibytes(bytes),
            mebibytes(self.memory)
        );
        Err(self.refuse("its size", &problem, Self::REMEDY))
    }

    /// Bytes that may be held at a time.
    pub fn memory(&self) -> u64 {
        self.memory
    }

    /// Room for `more` entries beyond those of `list`, or a refusal where the system has none: an abort otherwise.
    pub fn reserve<T>(&self, list: &mut Vec<T>, more: usize) -> Result<(), Refused> {
        list.try_reserve_exact(more).map_err(|_| {
            let bytes = (list.len() as u64).saturating_add(more as u64).saturating_mul(size_of::<T>() as u64);
            self.refuse(
                "its size",
                &format!("the system has no {} of memory", mebibytes(bytes)),
                Self::REMEDY,
            )
        })
    }

    /// Keeps a reason.
    pub fn refuse(&self, place: &str, problem: &str, remedy: &'static str) -> Refused {
        self.refusal.replace(Some(Fault::new(place, problem, remedy)));
        Refused
    }

    /// The reason kept, if any.
    pub fn reason(&self) -> Option<Fault> {
        self.refusal.take()
    }
}

impl From<Refused> for Fault {
    /// Gives way to the reason that the guard keeps.
    fn from(refused: Refused) -> Self {
        Self::new("its size", &refused.to_string(), Guard::REMEDY)
    }
}

fn mebibytes(bytes: u64) -> String {
    if bytes < 1 << 20 {
        format!("{} KiB", bytes.div_ceil(1 << 10))
    } else {
        format!("{} MiB", bytes.div_ceil(1 << 20))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_outlives_the_error() {
        let guard = Guard::new(&Limits { memory: 1 << 20 });
        guard.allow(1 << 20).unwrap();
        assert!(guard.reason().is_none());
        let _ = guard.allow((1 << 20) + 1).unwrap_err();
        let reason = guard.reason().unwrap();
        assert!(reason.problem.contains("2 MiB") && reason.remedy.contains("--max-memory"), "{reason:?}");
        let mut list: Vec<u64> = Vec::new();
        let _ = guard.reserve(&mut list, usize::MAX).unwrap_err();
        assert!(guard.reason().is_some() && list.is_empty());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_machine_tells_its_memory() {
        let memory = Limits::of_machine().memory;
        assert!(memory > 1 << 20 && memory < 1 << 50, "{memory}");
    }
}
