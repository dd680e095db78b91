//! Rays for which the caller decides what they hit, hit by hit.

use super::widths::at_width;
use super::{Bvh, Hit, InstanceBvh, InstanceHit};
use crate::geometry::{self, Ray};
use crate::simd::Isa;
use std::borrow::Borrow;

impl Bvh {
    /// The closest hit of `ray` for which `accepts` returns true, as where a texture cuts holes into a triangle: the
    /// ray goes through what is turned down. The closure is asked about hits as they are found, not by distance, and
    /// maybe more than once about one: what it answers should depend on the hit alone. It may trace rays itself.
    ///
    /// ```
    /// use phr::{Bvh, BvhConfig, geometry::{Mesh, Ray}};
    ///
    /// let corners = [0.0, 1.0].into_iter().flat_map(|z| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]]).collect();
    /// let (mesh, _) = Mesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?;
    /// let bvh = Bvh::build(&mesh, &BvhConfig::default())?;
    /// let down = Ray::new([0.2, 0.3, 2.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(bvh.intersect(&down).map(|hit| hit.prim), Some(1));
    /// // The upper triangle has a hole where u and v are less than a half.
    /// let hit = bvh.intersect_filtered(&down, |hit| hit.prim == 0 || hit.u.max(hit.v) >= 0.5);
    /// assert_eq!(hit.map(|hit| hit.prim), Some(0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn intersect_filtered(&self, ray: &Ray, mut accepts: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let isa = Isa::best();
        let accepts = |hit: &geometry::Hit| self.with_normal(hit).is_some_and(|hit| accepts(&hit));
        let hit = at_width!(&self.tree, built => built.tree.closest_filtered(isa, ray, accepts));
        self.with_normal(&hit)
    }

    /// Whether `ray` has a hit for which `accepts` returns true, likewise. A hit without a distance counts for none,
    /// as of [`Bvh::intersect`].
    #[inline]
    pub fn occluded_filtered(&self, ray: &Ray, mut accepts: impl FnMut(&Hit) -> bool) -> bool {
        let isa = Isa::best();
        let accepts = |hit: &geometry::Hit| self.with_normal(hit).is_some_and(|hit| accepts(&hit));
        at_width!(&self.tree, built => built.tree.any_filtered(isa, ray, accepts))
    }
}

impl<B: Borrow<Bvh> + Sync> InstanceBvh<B> {
    /// The closest hit of `ray` for which `accepts` returns true, as of [`Bvh::intersect_filtered`]: the closure is
    /// given the instance, and distance and normal in the world.
    #[inline]
    pub fn intersect_filtered(
        &self,
        ray: &Ray,
        mut accepts: impl FnMut(&InstanceHit) -> bool,
    ) -> Option<InstanceHit> {
        self.closest(ray, |instance, placed, local| {
            let accepts = |hit: &Hit| accepts(&InstanceHit { instance, hit: placed.to_world(*hit) });
            placed.bvh.borrow().intersect_filtered(local, accepts)
        })
    }

    /// Whether `ray` has a hit for which `accepts` returns true, likewise.
    #[inline]
    pub fn occluded_filtered(&self, ray: &Ray, mut accepts: impl FnMut(&InstanceHit) -> bool) -> bool {
        self.any(ray, |instance, placed, local| {
            let accepts = |hit: &Hit| accepts(&InstanceHit { instance, hit: placed.to_world(*hit) });
            placed.bvh.borrow().occluded_filtered(local, accepts)
        })
    }
}
