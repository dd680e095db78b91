//! A proven tree over triangles, and the builder that builds it again.

use super::BvhError;
use super::places::places;
use crate::builders::{Builder, by_name};
use crate::geometry::Mesh;
use crate::trace::ProvenTree;
use std::mem::take;
use std::panic::AssertUnwindSafe;

/// A tree and its builder.
#[derive(Debug)]
pub(super) struct Built<const N: usize> {
    pub tree: ProvenTree<N>,
    /// From the first rebuild on, with its memory. A panic leaves none half used: it is put back after a build that
    /// went well.
    builder: Option<AssertUnwindSafe<Box<dyn Builder<N>>>>,
}

impl<const N: usize> From<ProvenTree<N>> for Built<N> {
    fn from(tree: ProvenTree<N>) -> Self {
        Self { tree, builder: None }
    }
}

impl<const N: usize> Built<N> {
    /// Builds the tree over `mesh` by the builder called `name`, in the memory of this one and of its places. Without
    /// such a builder all is as before, after any other error there is neither tree nor place.
    pub fn rebuild(&mut self, mesh: &Mesh, name: &str, found: &mut Vec<u32>) -> Result<(), BvhError> {
        let mut builder = match self.builder.take() {
            Some(kept) => kept.0,
            None if name.is_empty() => return Err(BvhError::NoBuilder),
            // A file has room for the beginning of a long name.
            None if name.contains('[') && !name.ends_with(']') => return Err(BvhError::NoBuilder),
            None => by_name(name).ok_or_else(|| BvhError::of_name(name))?,
        };
        let (tree, old) = (take(&mut self.tree), take(found));
        builder.recycle(tree.into_inner());
        let tree = builder.try_build(mesh)?.tree;
        let tree = ProvenTree::proven(tree)?.map_err(BvhError::Malformed)?;
        *found = places(&tree.get().blocks, mesh.len(), old)?;
        self.tree = tree;
        self.builder = Some(AssertUnwindSafe(builder));
        Ok(())
    }
}
