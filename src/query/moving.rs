//! Trees of meshes that move: built again in their memory, or fitted.

use super::BvhError;
use super::bvh::{Bvh, Tree};
use super::widths::at_width;
use crate::builders::RefitError;
use crate::bvh::{Bvh4, Bvh8};
use crate::geometry::Mesh;

impl Bvh {
    /// Builds the tree anew over `mesh`, another one or the same that moved, by the [builder](Bvh::builder) and of the
    /// [width](Bvh::width) of this one, in its memory, on the current rayon pool. From the first call on the builder's
    /// memory is kept too, which [`Bvh::bytes`] does not count.
    ///
    /// ```
    /// let animation = phr::scene::animated_by_name("wrung").expect("a name of the list").generate(5000);
    /// let mut mesh = animation.scene.mesh.clone();
    /// let mut bvh = phr::Bvh::build(&mesh, &phr::BvhConfig::new("phr-turbo", 8))?;
    /// for frame in 1..=3u8 {
    ///     mesh.move_vertices(&animation.vertices(f32::from(frame) / 3.0))?;
    ///     bvh.rebuild(&mesh)?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BvhError::NoBuilder`] of a tree that `Bvh::try_from` was given (there keep the builder, and give it the tree
    /// of [`Bvh::into_bvh8`] to recycle) or whose file holds but the beginning of a long name,
    /// [`BvhError::NoSuchBuilder`] or [`BvhError::Changes`] of one whose file names a builder that is not known here;
    /// the tree is as before then.
    /// [`BvhError::OutOfMemory`]; it is of no triangle then, every ray misses, and it may be rebuilt.
    pub fn rebuild(&mut self, mesh: &Mesh) -> Result<(), BvhError> {
        at_width!(&mut self.tree, built => built.rebuild(mesh, &self.builder, &mut self.places))
    }

    /// Fits the tree to `mesh`, the one it was built over with vertices moved, on the current rayon pool: faster than
    /// [`Bvh::rebuild`], but rays take the longer the farther vertices moved. Any tree may be fitted.
    ///
    /// # Errors
    /// [`RefitError::Triangles`] of a mesh of another number of triangles, [`RefitError::Malformed`] of a foreign tree
    /// that has leaf blocks with gaps, [`RefitError::OutOfMemory`]; the tree is as before then.
    pub fn refit(&mut self, mesh: &Mesh) -> Result<(), RefitError> {
        at_width!(&mut self.tree, built => built.tree.refit(mesh))
    }

    /// The tree of nodes of four children, where it has these: for a program that keeps a
    /// [`Builder`](crate::builders::Builder) of its own, which may [recycle](crate::builders::Builder::recycle) it.
    ///
    /// # Errors
    /// A tree of the other width is given back.
    #[expect(clippy::result_large_err, reason = "the error is the tree itself")]
    pub fn into_bvh4(self) -> Result<Bvh4, Self> {
        match self.tree {
            Tree::Four(built) => Ok(built.tree.into_inner()),
            tree => Err(Self { tree, ..self }),
        }
    }

    /// The tree of nodes of eight children, likewise.
    ///
    /// # Errors
    /// As of [`Bvh::into_bvh4`].
    #[expect(clippy::result_large_err, reason = "the error is the tree itself")]
    pub fn into_bvh8(self) -> Result<Bvh8, Self> {
        match self.tree {
            Tree::Eight(built) => Ok(built.tree.into_inner()),
            tree => Err(Self { tree, ..self }),
        }
    }
}
