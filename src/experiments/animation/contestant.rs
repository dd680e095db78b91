//! What those who follow a moving scene can do.

use crate::bench::contender::BuiltTree;
use crate::geometry::Mesh;
use rayon::ThreadPool;
use std::time::Duration;

/// Follows a moving scene.
pub trait Contestant {
    /// Brings the tree up to date with `mesh`, whose vertices have moved, on the threads of `pool`; returns how
    /// long that took. The first time it is built.
    ///
    /// # Errors
    /// Why it cannot, in one line.
    fn update(&mut self, mesh: &Mesh, pool: &ThreadPool) -> Result<Duration, String>;

    /// Shows the tree, which is up to date with `mesh`.
    ///
    /// # Errors
    /// Those of `see`.
    fn show(
        &mut self,
        mesh: &Mesh,
        see: &mut dyn FnMut(&BuiltTree<'_>) -> Result<(), String>,
    ) -> Result<(), String>;
}
