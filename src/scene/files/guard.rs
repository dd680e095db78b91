//! What reading a file may cost: memory for its mesh, and bytes that come out of a compressed one.
//!
//! Sizes that a file declares are checked before memory is taken, sizes that it does not while its mesh grows. What is
//! refused is kept here, because errors of decoders and deserializers between do not carry a remedy.

use super::error::Fault;
use crate::geometry::Mesh;
use std::cell::RefCell;
use std::path::Path;

/// What a scene read from a file may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of vertices, triangles and buffers that are held at a time.
    pub memory: u64,
}

impl Limits {
    /// What may be taken where the system does not tell: more than any mesh has, less than what many machines have.
    const UNTOLD: u64 = 8 << 30;

    /// What this process may have now: memory of the machine that is free or can be freed, what its control groups
    /// leave, and what is left of its address space (`ulimit -v`). 8 GiB where the system does not tell (it does on
    /// Linux).
    pub fn of_machine() -> Self {
        let kibibytes = |file: &str, key: &str| {
            let text = text(Path::new(file));
            let line = text.lines().find_map(|line| line.strip_prefix(key))?;
            Some(line.split_whitespace().next()?.parse::<u64>().ok()?.saturating_mul(1024))
        };
        let machine = kibibytes("/proc/meminfo", "MemAvailable:");
        let taken = kibibytes("/proc/self/status", "VmSize:").unwrap_or(0);
        let addresses = of_addresses(&text(Path::new("/proc/self/limits")), taken);
        let groups = of_groups(Path::new("/sys/fs/cgroup"), &text(Path::new("/proc/self/cgroup")));
        Self::least(machine.into_iter().chain(addresses).chain(groups))
    }

    /// The least of what the system tells.
    fn least(told: impl Iterator<Item = u64>) -> Self {
        Self { memory: told.min().unwrap_or(Self::UNTOLD) }
    }
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// What `limits` leave of the address space to a process that has `taken` so much; `None` where it has no limit.
fn of_addresses(limits: &str, taken: u64) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(taken))
}

/// The files in which a version of control groups tells of memory.
struct Names {
    /// Where its groups are, below the root of all.
    root: &'static str,
    /// The controller in the line of a process's own group (`4:cpu,memory:/jobs`); version 2 has none.
    controller: &'static str,
    most: &'static str,
    current: &'static str,
    /// Of `memory.stat`.
    cached: [&'static str; 2],
}

const VERSIONS: [Names; 2] = [
    Names {
        root: "",
        controller: "",
        most: "memory.max",
        current: "memory.current",
        cached: ["inactive_file", "active_file"],
    },
    Names {
        root: "memory",
        controller: "memory",
        most: "memory.limit_in_bytes",
        current: "memory.usage_in_bytes",
        cached: ["total_inactive_file", "total_active_file"],
    },
];

/// What the control groups below `root` leave to a process: the least of its own, which a line of `own` names, and
/// those around it. `None` where none of them has a limit.
fn of_groups(root: &Path, own: &str) -> Option<u64> {
    let of_version = |names: &Names| {
        let group = |line: &'_ str| {
            let (_, line) = line.split_once(':')?;
            let (controllers, group) = line.split_once(':')?;
            controllers.split(',').any(|name| name == names.controller).then(|| group.to_owned())
        };
        let own = own.lines().find_map(group).unwrap_or_default();
        let root = root.join(names.root);
        let own = root.join(own.trim_start_matches('/'));
        let groups = own.ancestors().take_while(|group| group.starts_with(&root));
        groups.filter_map(|group| names.left_in(group)).min()
    };
    VERSIONS.iter().filter_map(of_version).min()
}

impl Names {
    fn left_in(&self, group: &Path) -> Option<u64> {
        let number = |name: &str| text(&group.join(name)).trim().parse::<u64>().ok();
        let most = number(self.most)?;
        // Files that are cached are given back where memory is short; what lies in memory files is not.
        let stat = text(&group.join("memory.stat"));
        let cached = stat.lines().filter_map(|line| {
            let (name, bytes) = line.split_once(' ')?;
            self.cached.contains(&name).then(|| bytes.trim().parse::<u64>().ok())?
        });
        let held = number(self.current).unwrap_or(0).saturating_sub(cached.sum());
        Some(most.saturating_sub(held))
    }
}

/// A file may stand for so many bytes for each of its own; compressed meshes do for 2 to 30.
pub(super) const MOST_EXPANSION: u64 = 200;
/// For so many bytes it may stand in any case.
const EXPANDED_AT_LEAST: u64 = 1 << 28;

/// The bytes for which a file of `length` may stand.
pub(super) fn most_expanded(length: u64) -> u64 {
    length.saturating_mul(MOST_EXPANSION).max(EXPANDED_AT_LEAST)
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
    const REMEDY: &'static str = "free memory, allow more (--max-memory, `Limits`) or give a smaller scene";

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

    /// Refuses more triangles than a mesh may have.
    pub fn allow_triangles(&self, triangles: u64) -> Result<(), Refused> {
        if triangles <= Mesh::MAX_TRIANGLES as u64 {
            return Ok(());
        }
        let problem = format!("{triangles} triangles or more, of at most {}", Mesh::MAX_TRIANGLES);
        Err(self.refuse("its size", &problem, "split the scene"))
    }

    /// Refuses `bytes` that stand nowhere in a file of `length` bytes, where it may not stand for so many.
    pub fn allow_unwritten(&self, bytes: u64, length: u64) -> Result<(), Refused> {
        if bytes <= most_expanded(length) {
            return Ok(());
        }
        let problem = format!("{} of zeros from {}", mebibytes(bytes), mebibytes(length));
        Err(self.refuse("its size", &problem, "export it with the data of its accessors"))
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
    fn groups_around_a_process_count_too() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        let inner = root.join("jobs/one");
        std::fs::create_dir_all(&inner).unwrap();
        let write = |group: &Path, name: &str, text: &str| std::fs::write(group.join(name), text).unwrap();
        assert_eq!(of_groups(root, "0::/jobs/one\n"), None);
        write(&root.join("jobs"), "memory.max", "1000\n");
        write(&root.join("jobs"), "memory.current", "700\n");
        write(&root.join("jobs"), "memory.stat", "file 600\ninactive_file 200\nactive_file 100\nshmem 300\n");
        write(&inner, "memory.max", "max\n");
        assert_eq!(of_groups(root, "0::/jobs/one\n"), Some(600));
        write(&inner, "memory.max", "50\n");
        assert_eq!(of_groups(root, "0::/jobs/one\n"), Some(50));
        assert_eq!(of_groups(root, "0::/jobs\n"), Some(600));
        assert_eq!(of_groups(root, ""), None);
        // The first version, in which each resource has its own groups.
        let older = root.join("memory/jobs");
        std::fs::create_dir_all(&older).unwrap();
        write(&older, "memory.limit_in_bytes", "500\n");
        write(&older, "memory.usage_in_bytes", "400\n");
        write(&older, "memory.stat", "inactive_file 1\ntotal_inactive_file 100\n");
        assert_eq!(
            of_groups(root, "11:cpuset:/\n4:cpu,memory:/jobs/one\n1:name=systemd:/0::/jobs\n"),
            Some(200)
        );
    }

    #[test]
    fn the_address_space_has_a_limit_where_one_is_set() {
        let limits = |most: &str| {
            format!("Limit  Soft Limit  Hard Limit  Units\nMax address space  {most}  unlimited  bytes\n")
        };
        assert_eq!(of_addresses(&limits("5000"), 2000), Some(3000));
        assert_eq!(of_addresses(&limits("5000"), 9000), Some(0));
        assert_eq!(of_addresses(&limits("unlimited"), 2000), None);
        assert_eq!(of_addresses("", 0), None);
    }

    #[test]
    fn there_is_a_limit_where_the_system_tells_none() {
        assert_eq!(Limits::least([].into_iter()).memory, Limits::UNTOLD);
        assert_eq!(Limits::least([9, 5, 7].into_iter()).memory, 5);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_machine_tells_its_memory() {
        let memory = Limits::of_machine().memory;
        assert!(memory > 1 << 20 && memory < 1 << 50, "{memory}");
    }
}
