//! The request to a contender, and the tree that it returns.

use crate::bench::build_times::{BuildTimes, ms};
use crate::bench::cell::Kernel;
use crate::bench::pools::Pools;
use crate::bench::tree_facts::TreeFacts;
use crate::bvh::saved::SavedError;
use crate::bvh::{Bvh4, Bvh8, sah_cost};
use crate::geometry::{Mesh, Tracer};
use rayon::ThreadPool;
use std::path::Path;
use std::time::Instant;

/// A request to a contender.
#[derive(Clone, Copy)]
pub struct BuildRequest<'a> {
    /// The geometry.
    pub mesh: &'a Mesh,
    /// The threads to build with.
    pub pools: &'a Pools,
    /// The kernels that are to trace the tree.
    pub kernels: &'a [Kernel],
    /// Whether to compute the facts of the tree; untimed.
    pub wants_facts: bool,
    /// Whether to time fresh builds alone.
    pub fresh_only: bool,
}

/// A tree of either width in our form.
pub enum EitherWidth {
    /// 4-wide.
    Four(Bvh4),
    /// 8-wide.
    Eight(Bvh8),
}

impl From<Bvh4> for EitherWidth {
    fn from(tree: Bvh4) -> Self {
        Self::Four(tree)
    }
}

impl From<Bvh8> for EitherWidth {
    fn from(tree: Bvh8) -> Self {
        Self::Eight(tree)
    }
}

impl TryFrom<EitherWidth> for Bvh4 {
    type Error = EitherWidth;

    fn try_from(tree: EitherWidth) -> Result<Self, EitherWidth> {
        match tree {
            EitherWidth::Four(tree) => Ok(tree),
            other => Err(other),
        }
    }
}

impl TryFrom<EitherWidth> for Bvh8 {
    type Error = EitherWidth;

    fn try_from(tree: EitherWidth) -> Result<Self, EitherWidth> {
        match tree {
            EitherWidth::Eight(tree) => Ok(tree),
            other => Err(other),
        }
    }
}

impl EitherWidth {
    /// Its SAH cost.
    pub fn sah_cost(&self) -> f64 {
        match self {
            Self::Four(tree) => sah_cost(tree),
            Self::Eight(tree) => sah_cost(tree),
        }
    }

    /// Saves the tree, which `builder` built over `mesh`, and loads it again on `pool`.
    ///
    /// # Errors
    /// An unwritable place.
    pub fn save(
        &self,
        mesh: &Mesh,
        builder: &str,
        path: &Path,
        pool: &ThreadPool,
    ) -> Result<Saving, SavedError> {
        let start = Instant::now();
        pool.install(|| match self {
            Self::Four(tree) => tree.save(mesh, builder, path),
            Self::Eight(tree) => tree.save(mesh, builder, path),
        })?;
        let saved_ms = ms(start.elapsed());
        let start = Instant::now();
        let loaded: Result<Self, SavedError> = pool.install(|| match self {
            Self::Four(_) => Bvh4::load(mesh, path).map(Self::from),
            Self::Eight(_) => Bvh8::load(mesh, path).map(Self::from),
        });
        let elapsed = ms(start.elapsed());
        let loaded_ms = match loaded {
            Ok(_) => Some(elapsed),
            Err(SavedError::OutOfMemory { .. }) => None,
            Err(error) => return Err(error),
        };
        let bytes =
            std::fs::metadata(path).map_err(|source| SavedError::Io { path: path.to_owned(), source })?.len();
        Ok(Saving { saved_ms, loaded_ms, bytes })
    }
}

/// How long a tree took to its file and back, and the file's bytes.
#[derive(Clone, Copy, Debug)]
pub struct Saving {
    /// Milliseconds of saving, until it was on the disk.
    pub saved_ms: f64,
    /// Milliseconds of loading it again, checked; `None` without memory for the tree a second time.
    pub loaded_ms: Option<f64>,
    /// Bytes of the file.
    pub bytes: u64,
}

/// A tree as its contender built it.
pub struct BuiltTree<'a> {
    /// How long the builds took.
    pub times: BuildTimes,
    /// Facts of the tree, where they were asked for.
    pub facts: Option<TreeFacts>,
    /// The geometry.
    pub(super) mesh: &'a Mesh,
    /// The tree in our form, or why it is unavailable.
    pub(super) tree: Result<EitherWidth, String>,
    /// Embree's own scene, where Embree built it.
    pub(super) native: Option<Box<dyn Tracer + 'a>>,
}

impl<'a> BuiltTree<'a> {
    /// A tree over `mesh` that was built and timed elsewhere, or why it is unavailable; `native` is Embree's own
    /// scene where Embree built it.
    pub fn of(
        mesh: &'a Mesh,
        tree: Result<EitherWidth, String>,
        native: Option<Box<dyn Tracer + 'a>>,
    ) -> Self {
        Self { times: BuildTimes::default(), facts: None, mesh, tree, native }
    }

    /// The tree in our form, for whoever built it.
    ///
    /// # Errors
    /// Why it is unavailable.
    pub fn into_tree(self) -> Result<EitherWidth, String> {
        self.tree
    }

    /// The tree in our form.
    ///
    /// # Errors
    /// Why it is unavailable.
    pub fn tree(&self) -> Result<&EitherWidth, &str> {
        self.tree.as_ref().map_err(String::as_str)
    }
}
