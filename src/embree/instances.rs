//! Scenes of instances: what two levels of ours are held to.

#![allow(unsafe_code)]

use super::arguments::Arguments;
use super::query::{embree_ray, found};
use super::scene::Handle;
use super::{Device, EmbreeError, EmbreeScene};
use crate::geometry::{Hit, Ray};
use embree_sys as sys;
use glam::Affine3A;

/// A committed scene of instances of other scenes, traced by `rtcIntersect1` and `rtcOccluded1`.
pub struct InstanceScene<'a> {
    handle: Handle,
    /// Released after the scene.
    _device: Device,
    /// Their meshes are read by rays.
    _objects: Vec<&'a EmbreeScene<'a>>,
}

impl Device {
    /// A scene of `instances`, each a scene of this device and where it is: from its own space to the world's.
    ///
    /// # Errors
    /// [`EmbreeError::OtherDevice`], [`EmbreeError::Transform`], [`EmbreeError::Call`] with Embree's text.
    pub fn instances<'a>(
        &self,
        instances: &[(&'a EmbreeScene<'a>, Affine3A)],
    ) -> Result<InstanceScene<'a>, EmbreeError> {
        // Embree would take it.
        if let Some(other) = instances.iter().position(|(object, _)| object.device().raw() != self.raw()) {
            return Err(EmbreeError::OtherDevice(other));
        }
        let is_usable = |transform: &Affine3A| transform.is_finite() && transform.inverse().is_finite();
        if let Some(useless) = instances.iter().position(|(_, transform)| !is_usable(transform)) {
            return Err(EmbreeError::Transform(useless));
        }
        // SAFETY: the device is live.
        let handle = Handle(unsafe { sys::rtcNewScene(self.raw()) });
        self.check("making a scene")?;
        for (id, (object, transform)) in (0..).zip(instances) {
            let columns = transform.to_cols_array();
            // SAFETY: device, scene and object are live. Embree copies the twelve floats of the transform and keeps
            // its own references to geometry and object; the object's mesh lives as long as `'a`, which the scene
            // does not outlive.
            unsafe {
                let geometry = sys::rtcNewGeometry(self.raw(), sys::RTC_GEOMETRY_TYPE_INSTANCE);
                sys::rtcSetGeometryInstancedScene(geometry, object.raw());
                let format = sys::RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR;
                sys::rtcSetGeometryTransform(geometry, 0, format, columns.as_ptr().cast());
                sys::rtcCommitGeometry(geometry);
                sys::rtcAttachGeometryByID(handle.0, geometry, id);
                sys::rtcReleaseGeometry(geometry);
            }
            self.check("attaching an instance")?;
        }
        // SAFETY: the scene is live and owned here alone.
        unsafe { sys::rtcCommitScene(handle.0) };
        self.check("building the tree over instances")?;
        let objects = instances.iter().map(|(object, _)| *object).collect();
        Ok(InstanceScene { handle, _device: self.clone(), _objects: objects })
    }
}

impl InstanceScene<'_> {
    /// The closest hit of a ray, with the number of the instance. An invalid ray misses.
    pub fn closest(&self, ray: &Ray) -> Option<(u32, Hit)> {
        if !ray.is_valid() {
            return None;
        }
        let mut query = sys::RTCRayHit { ray: embree_ray(ray), ..Default::default() };
        query.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
        query.hit.instID = [sys::RTC_INVALID_GEOMETRY_ID; _];
        // SAFETY: the scene is committed and live; the query is whole and aligned by its type; the ray is valid.
        unsafe { Arguments::new().intersect1(self.handle.0, &mut query) };
        let hit = Hit { t: query.ray.tfar, u: query.hit.u, v: query.hit.v, prim: query.hit.primID };
        let hit = found(query.hit.geomID, hit);
        hit.is_hit().then_some((query.hit.instID[0], hit))
    }

    /// Whether a ray hits anything. An invalid ray hits nothing.
    pub fn any(&self, ray: &Ray) -> bool {
        let mut query = embree_ray(ray);
        // SAFETY: as in `closest`.
        ray.is_valid()
            && unsafe {
                Arguments::new().occluded1(self.handle.0, &mut query);
                query.tfar < 0.0 && ray.tfar >= 0.0
            }
    }
}
