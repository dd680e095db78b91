//! A tree through which no ray slips.

use super::widths::at_width;
use super::{Bvh, BvhError, Hit};
use crate::geometry::{self, Mesh, Ray, Tracer};
use crate::memory::catch_out_of_memory;
use crate::trace::Corners;
use std::slice::{from_mut, from_ref};

/// A [`Bvh`] whose rays slip through no edge and no vertex that triangles share, as with Embree's
/// `RTC_SCENE_FLAG_ROBUST`. Its conventions are those of the [module](crate::query); distances differ from those of the
/// `Bvh` by rounding, and rays take longer. It answers batches as a [`Tracer`], without normals. Sound for meshes and
/// origins within 1e12 of the scene's origin and for triangles of 1e-12 and larger.
///
/// ```
/// use phr::geometry::{Mesh, Ray};
/// use phr::{Bvh, BvhConfig, WatertightBvh};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let (mesh, _) = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])?;
/// let bvh = WatertightBvh::new(Bvh::build(&mesh, &BvhConfig::default())?, &mesh)?;
/// for i in 1..1000u16 {
///     let at = f32::from(i) * 1e-3; // on the edge that both triangles have
///     let ray = Ray::new([0.3, 0.9, 2.0], [at - 0.3, at - 0.9, -2.0]);
///     assert!(bvh.occluded(&ray) && bvh.intersect(&ray).is_some());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct WatertightBvh {
    bvh: Bvh,
    corners: Corners,
}

impl WatertightBvh {
    /// Copies the corners of the triangles of `mesh`, over which `bvh` was built, on the current rayon pool: 160 bytes
    /// for each leaf block. After the `Bvh` was rebuilt or fitted, make it anew.
    ///
    /// # Errors
    /// [`BvhError::NotOfMesh`], [`BvhError::OutOfMemory`].
    pub fn new(bvh: Bvh, mesh: &Mesh) -> Result<Self, BvhError> {
        if !bvh.is_of(mesh) {
            return Err(BvhError::NotOfMesh);
        }
        let corners =
            catch_out_of_memory(|| at_width!(&bvh.tree, built => Corners::of(built.tree.get(), mesh)))?;
        Ok(Self { corners: corners.map_err(BvhError::Malformed)?, bvh })
    }

    /// The closest hit of `ray`.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let mut hit = geometry::Hit::MISS;
        self.closest(from_ref(ray), from_mut(&mut hit));
        self.bvh.with_normal(&hit)
    }

    /// Whether `ray` hits anything.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut occluded = false;
        self.any(from_ref(ray), from_mut(&mut occluded));
        occluded
    }

    /// The tree, for rays that need not be watertight.
    pub fn get(&self) -> &Bvh {
        &self.bvh
    }

    /// The tree, given back.
    pub fn into_inner(self) -> Bvh {
        self.bvh
    }

    /// Bytes of the tree, of what finds a triangle in it, and of the corners.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + self.corners.bytes()
    }
}

impl Tracer for WatertightBvh {
    fn closest(&self, rays: &[Ray], hits: &mut [geometry::Hit]) {
        at_width!(&self.bvh.tree, built => built.tree.watertight_tracer(&self.corners).closest(rays, hits));
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        at_width!(&self.bvh.tree, built => built.tree.watertight_tracer(&self.corners).any(rays, occluded));
    }
}
