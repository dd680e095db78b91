//! A tree over anything that has a box.

use super::widths::{OfWidth, at_width};
use super::{BvhConfig, BvhError};
use crate::builders::{BoxBuilder, Boxes, Primitives, over_boxes};
use crate::bvh::{IdBlock, WideBvh};
use crate::geometry::{Aabb, Ray};
use crate::simd::Isa;
use crate::trace::ProvenTree;
use std::fmt;
use std::panic::AssertUnwindSafe;

/// A tree over primitives of the caller, who tests them; leaves hold their numbers. Boxes are tested as in
/// [`Bvh`](super::Bvh), with the best instructions of the machine, and the caller's test is compiled into the
/// traversal.
///
/// Builders are made for triangles, of which a test is cheap: `phr-quality` and `phr-best` make leaves of up to eight,
/// and may call a test of yours twice as often as `phr-fast` and `phr-draft`. Where it is costly, count its calls.
///
/// ```
/// use phr::geometry::{Aabb, Ray};
/// use phr::{BvhConfig, PrimitiveBvh};
///
/// let centres = [[0.0f32, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, -4.0]];
/// let boxes: Vec<Aabb> =
///     centres.iter().map(|c| Aabb::new(c.map(|x| x - 1.0).into(), c.map(|x| x + 1.0).into())).collect();
/// let bvh = PrimitiveBvh::build(&boxes, &BvhConfig::default())?;
///
/// // Spheres of radius 1; directions are units.
/// let sphere = |id: u32, ray: &Ray| {
///     let to = ray.org - phr::glam::Vec3::from(centres[id as usize]);
///     let (b, c) = (to.dot(ray.dir), to.dot(to) - 1.0);
///     let root = (b * b - c).sqrt(); // NaN, which is no hit, where the line misses
///     [-b - root, -b + root].into_iter().find(|&t| ray.tnear < t && t <= ray.tfar)
/// };
/// let down = Ray::new([0.0, 0.0, 9.0], [0.0, 0.0, -1.0]);
/// let hit = bvh.intersect_with(&down, sphere).expect("a hit");
/// assert_eq!((hit.id, hit.t), (0, 8.0));
/// assert!(!bvh.occluded_with(&Ray { tfar: 7.0, ..down }, |id, ray| sphere(id, ray).is_some()));
/// # Ok::<(), phr::query::BvhError>(())
/// ```
pub struct PrimitiveBvh(Tree);

/// A tree of either width.
type Tree = OfWidth<Built<4>, Built<8>>;

/// A tree and what builds it.
struct Built<const N: usize> {
    tree: ProvenTree<N, IdBlock>,
    /// The builder's name with its changes.
    name: String,
    /// From the first rebuild on, with its memory. A panic leaves none half used: it is put back after a build that
    /// went well.
    builder: Option<AssertUnwindSafe<Box<BoxBuilder<N>>>>,
}

/// The closest hit of a ray by the caller's test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimitiveHit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// The primitive.
    pub id: u32,
}

impl PrimitiveBvh {
    /// Builds a tree over `primitives` on the current rayon pool. Those that [may be split](Primitives::splits) are
    /// by builders of spatial splits.
    ///
    /// # Errors
    /// [`BvhError::Boxes`], [`BvhError::NoSuchBuilder`], [`BvhError::Changes`], [`BvhError::NoSuchWidth`],
    /// [`BvhError::OutOfMemory`].
    pub fn build<P: Primitives + ?Sized>(primitives: &P, config: &BvhConfig<'_>) -> Result<Self, BvhError> {
        let boxes = Boxes::of(&primitives)?;
        match config.width {
            4 => Ok(Self(Tree::Four(Built::new(&boxes, config.builder)?))),
            8 => Ok(Self(Tree::Eight(Built::new(&boxes, config.builder)?))),
            width => Err(BvhError::NoSuchWidth(width)),
        }
    }

    /// Builds the tree anew over other `primitives`, or the same ones that moved, in the memory of this one. From the
    /// first call on the builder's memory is kept too, some 40 to 80 bytes per primitive that [`PrimitiveBvh::bytes`]
    /// does not count; boxes are asked for anew each time.
    ///
    /// # Errors
    /// [`BvhError::Boxes`]; the tree is then as before. [`BvhError::OutOfMemory`]; it is then empty or as before, and
    /// may be rebuilt.
    pub fn rebuild<P: Primitives + ?Sized>(&mut self, primitives: &P) -> Result<(), BvhError> {
        let boxes = Boxes::of(&primitives)?;
        at_width!(&mut self.0, built => built.rebuild(&boxes))
    }

    /// The closest hit of `ray`. `test` is given a primitive and the ray, which ends (`tfar`) at the closest hit so
    /// far; it returns the distance at which the ray hits the primitive. Only a distance in the ray's interval,
    /// `tnear < t <= tfar` and finite, is a hit. Primitives come about nearest first, all of a leaf (three to five
    /// in the mean) where the ray meets its box (always where the tree is one leaf), so that some come whose own boxes
    /// it misses; one that was split may come more than once.
    #[inline]
    pub fn intersect_with(
        &self,
        ray: &Ray,
        test: impl FnMut(u32, &Ray) -> Option<f32>,
    ) -> Option<PrimitiveHit> {
        let hit = at_width!(&self.0, built => built.tree.closest_with(Isa::best(), ray, test));
        hit.is_hit().then_some(PrimitiveHit { t: hit.t, id: hit.prim })
    }

    /// Whether `test` says of any primitive that the ray hits it, within the ray's interval: unlike a distance, that is
    /// not checked again. Primitives come in no order, else as in [`PrimitiveBvh::intersect_with`].
    #[inline]
    pub fn occluded_with(&self, ray: &Ray, test: impl FnMut(u32, &Ray) -> bool) -> bool {
        at_width!(&self.0, built => built.tree.any_with(Isa::best(), ray, test))
    }

    /// The box of all primitives; [empty](Aabb::is_empty) without any.
    pub fn bounds(&self) -> Aabb {
        at_width!(&self.0, built => built.tree.get().bounds)
    }

    /// Bytes of the tree.
    pub fn bytes(&self) -> usize {
        at_width!(&self.0, built => built.tree.get().bytes())
    }

    /// The tree of nodes of four children, where it has these: for a traversal of your own, or to upload it.
    pub fn as_bvh4(&self) -> Option<&WideBvh<4, IdBlock>> {
        self.0.four().map(|built| built.tree.get())
    }

    /// The tree of nodes of eight children, where it has these.
    pub fn as_bvh8(&self) -> Option<&WideBvh<8, IdBlock>> {
        self.0.eight().map(|built| built.tree.get())
    }
}

impl<const N: usize> Built<N> {
    fn new(boxes: &Boxes<'_>, name: &str) -> Result<Self, BvhError> {
        let tree = builder(name)?.try_build(boxes)?.tree;
        let tree = ProvenTree::proven(tree)?.map_err(BvhError::Malformed)?;
        Ok(Self { tree, name: name.to_owned(), builder: None })
    }

    fn rebuild(&mut self, boxes: &Boxes<'_>) -> Result<(), BvhError> {
        let mut builder = self.builder.take().map_or_else(|| builder(&self.name), |kept| Ok(kept.0))?;
        let old = std::mem::take(&mut self.tree);
        builder.recycle(old.into_inner());
        let built = builder.try_build(boxes)?.tree;
        // One that failed is of no use any more.
        self.builder = Some(AssertUnwindSafe(builder));
        self.tree = ProvenTree::proven(built)?.map_err(BvhError::Malformed)?;
        Ok(())
    }
}

/// The builder called `name`.
fn builder<const N: usize>(name: &str) -> Result<Box<BoxBuilder<N>>, BvhError> {
    over_boxes(name).ok_or_else(|| BvhError::of_name(name))
}

impl fmt::Debug for PrimitiveBvh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        at_width!(&self.0, built => f.debug_tuple("PrimitiveBvh").field(built.tree.get()).finish())
    }
}
