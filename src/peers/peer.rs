//! What the builder of another crate supplies to be measured.

use crate::builders::ForeignTree;
use crate::geometry::Mesh;

/// A builder of another crate.
pub trait Peer {
    /// The crate's own form of a mesh.
    type Input;
    /// What the crate builds.
    type Built: Send;
    /// The binary tree of it.
    type Tree<'a>: ForeignTree;

    /// The name used in commands and records.
    fn name(&self) -> &'static str;

    /// Crate and version, as `obvhs 0.4.0`.
    fn engine(&self) -> String;

    /// The parameters, for the records.
    fn config(&self) -> serde_json::Value;

    /// A mesh in the crate's own form; not timed.
    fn input(&self, mesh: &Mesh) -> Self::Input;

    /// Builds on the current rayon pool: this is timed.
    fn build(&self, input: &mut Self::Input) -> Self::Built;

    /// The binary tree that was built; not timed.
    fn tree<'a>(&self, built: &'a Self::Built) -> Self::Tree<'a>;
}
