//! A tree that answers rays.

use super::built::Built;
use super::places::{places, triangles};
use super::widths::{OfWidth, at_width};
use super::{BvhConfig, BvhError, Hit};
use crate::builders;
use crate::bvh::saved::{SavedError, SavedTree};
use crate::bvh::{Bvh4, Bvh8, TriangleBlock, WideBvh};
use crate::geometry::{self, Aabb, Mesh, Ray, Tracer};
use crate::trace::ProvenTree;
use glam::Vec3;
use rayon::prelude::*;
use std::path::Path;
use std::slice::{from_mut, from_ref};

/// A tree over a mesh, of which it keeps what rays need: the mesh may be dropped. The module's page has the
/// conventions.
///
/// ```
/// use phr::geometry::{Mesh, Ray};
/// use phr::query::{Bvh, BvhConfig};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let (mesh, _) = Mesh::new(corners, vec![[0, 1, 2]])?;
/// let bvh = Bvh::build(&mesh, &BvhConfig::default())?;
/// let down = Ray::new([0.2, 0.3, 2.0], [0.0, 0.0, -1.0]);
/// let hit = bvh.intersect(&down).expect("a hit");
/// assert_eq!((hit.prim, hit.normal.to_array()), (0, [0.0, 0.0, 1.0]));
/// assert!(bvh.occluded(&down) && !bvh.occluded(&Ray { tfar: 1.0, ..down }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Bvh {
    pub(super) tree: Tree,
    /// By triangle: four times its block, plus its lane in it.
    pub(super) places: Vec<u32>,
    /// Name of the builder; empty where nobody has told it.
    pub(super) builder: String,
}

/// A tree of either width.
pub(super) type Tree = OfWidth<Built<4>, Built<8>>;

impl Tree {
    fn blocks(&self) -> &[TriangleBlock] {
        at_width!(self, built => &built.tree.get().blocks)
    }
}

impl Bvh {
    /// Builds a tree over `mesh` on the current rayon pool. While it lasts, threads of that pool take up parts of it,
    /// those too that wait for other work there: a build in the background, beside frames, wants a pool of its own. A
    /// mesh that moves is built over again by [`Bvh::rebuild`]. To build with parameters of your own, use a
    /// [`builders::Builder`] and make a `Bvh` of its tree.
    ///
    /// # Errors
    /// [`BvhError::NoSuchBuilder`], [`BvhError::Changes`], [`BvhError::NoSuchWidth`], [`BvhError::OutOfMemory`].
    pub fn build(mesh: &Mesh, config: &BvhConfig<'_>) -> Result<Self, BvhError> {
        let (bvh, builder) = match config.width {
            4 => {
                let (tree, builder) = tree::<4>(mesh, config.builder)?;
                (Self::try_from(tree)?, builder)
            }
            8 => {
                let (tree, builder) = tree::<8>(mesh, config.builder)?;
                (Self::try_from(tree)?, builder)
            }
            width => return Err(BvhError::NoSuchWidth(width)),
        };
        Ok(Self { builder, ..bvh })
    }

    /// The closest hit of `ray`.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let mut hit = geometry::Hit::MISS;
        self.trace(|tracer| tracer.closest(from_ref(ray), from_mut(&mut hit)));
        self.with_normal(&hit)
    }

    /// Whether `ray` hits anything.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut occluded = false;
        self.trace(|tracer| tracer.any(from_ref(ray), from_mut(&mut occluded)));
        occluded
    }

    /// The closest hit of each of `rays`, in whatever order they are; it helps if rays that go alike are neighbours.
    ///
    /// # Panics
    /// If there are not as many `hits` as `rays`.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        hits.fill(None);
        let answer = |place: usize, hit: geometry::Hit| hits[place] = self.with_normal(&hit);
        at_width!(&self.tree, built => built.tree.batch_tracer().closest_hits(rays, answer))
    }

    /// Whether each of `rays` hits anything, likewise.
    ///
    /// # Panics
    /// If there are not as many places in `occluded` as `rays`.
    pub fn occluded_batch(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        at_width!(&self.tree, built => built.tree.batch_tracer().any(rays, occluded))
    }

    /// Saves the tree, which was built over `mesh`, at `path`: [`saved`](crate::bvh::saved) describes the format, which
    /// has room for 32 bytes of the builder's name. Whether it is of `mesh` is told by its triangles alone;
    /// [`Bvh::load`] asks for the mesh that was given here, to its last vertex.
    ///
    /// # Errors
    /// Another mesh, or one that was moved since; a foreign tree that lacks a triangle or holds nodes that nothing
    /// leads to; an unwritable place, or one that is no regular file.
    pub fn save(&self, mesh: &Mesh, path: impl AsRef<Path>) -> Result<(), SavedError> {
        self.write(mesh, path.as_ref())
    }

    fn write(&self, mesh: &Mesh, path: &Path) -> Result<(), SavedError> {
        if !self.is_of(mesh) {
            return Err(SavedError::NotOfMesh { path: path.to_owned() });
        }
        // A foreign tree may answer rays and be none that can be loaded.
        at_width!(&self.tree, built => built.tree.get().validate_links(mesh.len()))
            .map_err(SavedError::invalid(path))?;
        at_width!(&self.tree, built => built.tree.get().save(mesh, &self.builder, path))
    }

    /// Whether it was built over `mesh` as it is now.
    pub(super) fn is_of(&self, mesh: &Mesh) -> bool {
        self.places.len() == mesh.len() && self.tree.blocks().par_iter().all(|block| block.is_of(mesh))
    }

    /// Loads the tree of either width that was saved at `path` for `mesh`, on the current rayon pool.
    ///
    /// # Errors
    /// A missing file ([`SavedError::Io`]), one that is damaged or holds the tree of another mesh, no memory.
    pub fn load(mesh: &Mesh, path: impl AsRef<Path>) -> Result<Self, SavedError> {
        Self::read(mesh, path.as_ref())
    }

    fn read(mesh: &Mesh, path: &Path) -> Result<Self, SavedError> {
        let saved = SavedTree::open(path)?;
        let builder = saved.header.builder.clone();
        let tree = match saved.header.width {
            4 => Tree::Four(ProvenTree::read(mesh, saved)?.into()),
            _ => Tree::Eight(ProvenTree::read(mesh, saved)?.into()),
        };
        let places = places(tree.blocks(), mesh.len(), Vec::new())
            .map_err(|source| SavedError::OutOfMemory { path: path.to_owned(), source })?;
        Ok(Self { tree, places, builder })
    }

    /// Name of the builder, as [`by_name`](builders::by_name) knows it; of a loaded tree what its file says, which may
    /// be the beginning of a long one. `None` of a tree that somebody else has built.
    pub fn builder(&self) -> Option<&str> {
        Some(&self.builder[..]).filter(|name| !name.is_empty())
    }

    /// Most children of a node: 4 or 8.
    pub fn width(&self) -> usize {
        self.tree.width()
    }

    /// Number of triangles of the mesh.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The box of all triangles; [empty](Aabb::is_empty) without any.
    pub fn bounds(&self) -> Aabb {
        at_width!(&self.tree, built => built.tree.get().bounds)
    }

    /// The tree of nodes of four children, where it has these: to upload it, or for a traversal of your own.
    pub fn as_bvh4(&self) -> Option<&Bvh4> {
        self.tree.four().map(|built| built.tree.get())
    }

    /// The tree of nodes of eight children, where it has these.
    pub fn as_bvh8(&self) -> Option<&Bvh8> {
        self.tree.eight().map(|built| built.tree.get())
    }

    /// Bytes of the tree and of what finds a triangle in it.
    pub fn bytes(&self) -> usize {
        let tree = at_width!(&self.tree, built => built.tree.get().bytes());
        tree + size_of_val(&self.places[..])
    }

    /// Hands our kernel over the tree to `f`.
    #[inline]
    fn trace<R>(&self, f: impl FnOnce(&dyn Tracer) -> R) -> R {
        at_width!(&self.tree, built => f(&built.tree.tracer()))
    }

    /// A kernel's hit with its normal, from the block that the kernel has just read.
    #[inline]
    pub(super) fn with_normal(&self, hit: &geometry::Hit) -> Option<Hit> {
        let &geometry::Hit { t, u, v, prim } = hit;
        let &place = self.places.get(prim as usize)?;
        let (block, lane) = (&self.tree.blocks()[(place / 4) as usize], (place % 4) as usize);
        let edge = |edges: &[[f32; 4]; 3]| Vec3::from_array(edges.map(|axis| axis[lane]));
        Some(Hit { t, u, v, prim, normal: edge(&block.e2).cross(edge(&block.e1)) })
    }
}

impl Tracer for Bvh {
    /// As [`Bvh::intersect_batch`], without normals.
    fn closest(&self, rays: &[Ray], hits: &mut [geometry::Hit]) {
        at_width!(&self.tree, built => built.tree.batch_tracer().closest(rays, hits))
    }

    /// As [`Bvh::occluded_batch`].
    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.occluded_batch(rays, occluded);
    }
}

/// The tree of the builder called `name`, and how it calls itself.
fn tree<const N: usize>(mesh: &Mesh, name: &str) -> Result<(WideBvh<N>, String), BvhError> {
    let mut builder = builders::by_name(name).ok_or_else(|| BvhError::of_name(name))?;
    Ok((builder.try_build(mesh)?.tree, builder.name().to_owned()))
}

impl TryFrom<Bvh4> for Bvh {
    type Error = BvhError;

    /// Proves that a builder's tree is sound, and that its box holds those of the root's children. Boxes below, and
    /// that corners are in them, are trusted. Its builder is not known then ([`Bvh::builder`]).
    fn try_from(tree: Bvh4) -> Result<Self, BvhError> {
        let (built, places) = built(tree)?;
        Ok(Self { tree: Tree::Four(built), places, builder: String::new() })
    }
}

impl TryFrom<Bvh8> for Bvh {
    type Error = BvhError;

    /// As from a 4-wide tree.
    fn try_from(tree: Bvh8) -> Result<Self, BvhError> {
        let (built, places) = built(tree)?;
        Ok(Self { tree: Tree::Eight(built), places, builder: String::new() })
    }
}

/// A tree that is proven sound, and the places of its triangles.
fn built<const N: usize>(tree: WideBvh<N>) -> Result<(Built<N>, Vec<u32>), BvhError> {
    let places = places(&tree.blocks, triangles(&tree.blocks)?, Vec::new())?;
    let tree = ProvenTree::proven(tree)?.map_err(BvhError::Malformed)?;
    if !tree.get().is_bounded() {
        return Err(BvhError::Malformed("its box does not hold those of its root".into()));
    }
    Ok((tree.into(), places))
}
