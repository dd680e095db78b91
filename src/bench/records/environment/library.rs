//! The library measured against: its version, its package, and whether it has assertions.

use super::system::{UNKNOWN, output};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The file of the Embree that this process has loaded, whose name begins with `library`.
fn loaded_embree(library: &str) -> Option<PathBuf> {
    let maps = std::fs::read_to_string("/proc/self/maps").ok()?;
    let path = maps
        .lines()
        .find_map(|line| line.find('/').map(|at| &line[at..]).filter(|path| path.contains(library)))?;
    Some(PathBuf::from(path))
}

/// Whether a library has assertions: those call `__assert_fail`, whose name then is among its symbols.
fn assertions_in(library: &Path) -> &'static str {
    const CALLED: &[u8] = b"__assert_fail";
    match std::fs::read(library) {
        Ok(bytes) if bytes.windows(CALLED.len()).any(|found| found == CALLED) => {
            "assertions on (no -DNDEBUG)"
        }
        Ok(_) => "assertions off (-DNDEBUG)",
        Err(_) => "assertions unknown",
    }
}

/// The library measured against.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Library {
    /// Embree's version as the loaded library reports it; empty without it.
    pub embree: String,
    /// The package it came from, as the system's package manager knows it.
    pub embree_package: String,
    /// The package of its scheduler.
    pub tbb_package: String,
    /// How it was built, where known.
    pub note: String,
}

impl Library {
    /// The library of version `embree`, with the packages it came from.
    pub fn of(embree: String) -> Self {
        let package = |name: &str| output("dpkg-query", &["-W", "-f", "${Package} ${Version}", name]);
        // Debian's names: libembree3-3, libembree4-4.
        let major = embree.split('.').next().unwrap_or_default();
        let embree_package = package(&format!("libembree{major}-{major}"));
        let note = match loaded_embree(&format!("libembree{major}")) {
            None => UNKNOWN.into(),
            Some(path) => {
                let whose = if path.starts_with("/usr/lib") && embree_package.starts_with("libembree") {
                    "the distribution's build"
                } else {
                    "a build of the user's own"
                };
                format!("{whose}: {}, ISA chosen at run time", assertions_in(&path))
            }
        };
        Self { embree, embree_package, tbb_package: package("libtbb12"), note }
    }
}
