//! Saved trees as contenders: what is timed in place of a build is loading the tree from its file.

use super::ours::Ours;
use crate::bench::cell::{Cell, Kernel, SAVED};
use crate::bench::planned_scene::plain_name;
use crate::builders::{Build, Builder, Counts, Phase};
use crate::bvh::WideBvh;
use crate::bvh::saved::{Header, SavedError, header_of};
use crate::geometry::Mesh;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

/// The saved trees of this process, where the command line names some.
static TREES: OnceLock<Vec<Saved>> = OnceLock::new();

/// A saved tree under its name in records, which has no folder in it.
struct Saved {
    name: String,
    path: PathBuf,
    header: Header,
}

/// Offers the trees saved at `paths` beside the builders, once in a process; returns their names.
///
/// # Errors
/// The first file that is no saved tree.
pub fn offer(paths: &[PathBuf]) -> Result<Vec<String>, SavedError> {
    let saved = |path: &PathBuf| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        // Lines that filters are matched against divide at spaces.
        let name = format!("{SAVED}{}", plain_name(&stem)).replace(' ', "_");
        Ok(Saved { name, path: path.clone(), header: header_of(path)? })
    };
    let trees = paths.iter().map(saved).collect::<Result<Vec<_>, _>>()?;
    // Records tell them apart by name and width alone.
    let key = |tree: &Saved| (tree.name.clone(), tree.header.width);
    for (i, tree) in trees.iter().enumerate() {
        if let Some(first) = trees[..i].iter().find(|first| key(first) == key(tree)) {
            let what = format!("named like {}, and records tell trees apart by name", first.path.display());
            return Err(SavedError::Unusable { path: tree.path.clone(), what });
        }
    }
    let names = trees.iter().map(|tree| tree.name.clone()).collect();
    TREES.get_or_init(|| trees);
    Ok(names)
}

/// Refuses trees that are not of `mesh`.
///
/// # Errors
/// The first such tree's.
pub fn check(mesh: &Mesh) -> Result<(), SavedError> {
    trees().iter().try_for_each(|tree| match tree.header.width {
        4 => WideBvh::<4>::load(mesh, &tree.path).map(drop),
        _ => WideBvh::<8>::load(mesh, &tree.path).map(drop),
    })
}

/// The cells of the trees on offer.
pub(super) fn cells(kernels: &[Kernel]) -> impl Iterator<Item = Cell> {
    trees().iter().map(|tree| Cell::new(&tree.name, tree.header.width, kernels))
}

/// What loads the tree called `name`, if it is `N` wide.
pub(super) fn by_name<const N: usize>(name: &str) -> Option<Ours<N>>
where
    super::EitherWidth: From<WideBvh<N>>,
{
    let tree = trees().iter().find(|tree| tree.name == name && tree.header.width == N as u32)?;
    Some(Ours::new(|| Box::new(Loader { path: &tree.path, header: &tree.header })))
}

fn trees() -> &'static [Saved] {
    TREES.get().map_or(&[], |trees| trees)
}

/// Loads a tree where others build one.
struct Loader {
    path: &'static Path,
    header: &'static Header,
}

impl<const N: usize> Builder<N> for Loader {
    fn name(&self) -> &'static str {
        "saved"
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({ "builder": self.header.builder })
    }

    /// # Panics
    /// If the file is no longer what it was: [`check`] has loaded it before.
    fn build(&mut self, mesh: &Mesh) -> Build<N> {
        let start = Instant::now();
        let tree = WideBvh::load(mesh, self.path).unwrap_or_else(|error| panic!("{error}"));
        let phases = vec![Phase { name: "load", duration: start.elapsed() }];
        Build { tree, phases, counts: Counts::default() }
    }

    fn recycle(&mut self, tree: WideBvh<N>) {
        drop(tree);
    }
}
