//! A scene of one triangle mesh: made and committed, which builds the tree.

#![allow(unsafe_code)]

use super::{Device, EmbreeError};
use crate::geometry::{Aabb, Mesh};
use embree_sys as sys;
use glam::Vec3A;

/// The id under which every scene's one geometry is attached.
pub(super) const GEOMETRY: u32 = 0;

/// A reference to an Embree scene, released when dropped.
pub(super) struct Handle(pub(super) sys::RTCScene);

// SAFETY: a scene is not bound to a thread; its reference count is atomic.
unsafe impl Send for Handle {}
// SAFETY: through `&Handle` a committed scene is only traced and asked for its bounds, which Embree allows from
// any number of threads; what changes it has the only owner (`Prepared::commit`) or the only borrow (`MovingScene`).
unsafe impl Sync for Handle {}

impl Drop for Handle {
    fn drop(&mut self) {
        // Of none an error would be left to a later call.
        if !self.0.is_null() {
            // SAFETY: this owner's reference, released once.
            unsafe { sys::rtcReleaseScene(self.0) };
        }
    }
}

/// A scene ready to be built: one geometry, so that Morton order spans the whole mesh, over the mesh's own
/// buffers.
pub struct Prepared<'a> {
    handle: Handle,
    /// Released after the scene.
    device: Device,
    mesh: &'a Mesh,
}

impl Device {
    /// Makes a scene of one geometry that shares the mesh's buffers; building is left to
    /// [`Prepared::commit`].
    ///
    /// # Errors
    /// [`EmbreeError::Call`] with Embree's text.
    pub fn prepare<'a>(&self, mesh: &'a Mesh) -> Result<Prepared<'a>, EmbreeError> {
        let device = self;
        // SAFETY: the device is live. The buffers live as long as `'a`, which the scene does not outlive, and
        // are not written to meanwhile (`mesh` is borrowed); their strides, formats and counts are those of
        // `[f32; 3]` and `[u32; 3]`, and 16 bytes can be read from the last vertex on because of the padding
        // one. The scene keeps its own reference to the geometry.
        let handle = unsafe {
            let handle = Handle(sys::rtcNewScene(device.raw()));
            let geometry = sys::rtcNewGeometry(device.raw(), sys::RTC_GEOMETRY_TYPE_TRIANGLE);
            let made = device.check("making a scene");
            let share = |kind, format, pointer, count| {
                sys::rtcSetSharedGeometryBuffer(geometry, kind, 0, format, pointer, 0, 12, count);
            };
            if made.is_ok() {
                let vertices = mesh.padded_vertices().as_ptr().cast();
                share(sys::RTC_BUFFER_TYPE_VERTEX, sys::RTC_FORMAT_FLOAT3, vertices, mesh.vertices().len());
                let triangles = mesh.triangles().as_ptr().cast();
                share(sys::RTC_BUFFER_TYPE_INDEX, sys::RTC_FORMAT_UINT3, triangles, mesh.len());
                sys::rtcCommitGeometry(geometry);
                sys::rtcAttachGeometryByID(handle.0, geometry, GEOMETRY);
            }
            if !geometry.is_null() {
                sys::rtcReleaseGeometry(geometry);
            }
            made?;
            handle
        };
        device.check("attaching the mesh")?;
        Ok(Prepared { handle, device: device.clone(), mesh })
    }
}

impl<'a> Prepared<'a> {
    /// Says that the scene will change often, so that Embree keeps what the next commit can use.
    pub fn dynamic(self) -> Self {
        self.with(sys::RTC_SCENE_FLAG_DYNAMIC)
    }

    /// Asks for watertight kernels; for devices made by [`Device::robust`].
    pub fn robust(self) -> Self {
        self.with(sys::RTC_SCENE_FLAG_ROBUST)
    }

    /// Sets a flag besides those that are set.
    fn with(self, flag: sys::RTCSceneFlags) -> Self {
        // SAFETY: the scene is live and owned here alone.
        unsafe { sys::rtcSetSceneFlags(self.handle.0, sys::rtcGetSceneFlags(self.handle.0) | flag) };
        self
    }

    /// Builds the tree: `rtcCommitScene` and a look at the error code, nothing else.
    ///
    /// # Errors
    /// [`EmbreeError::Call`] with Embree's text.
    pub fn commit(self) -> Result<EmbreeScene<'a>, EmbreeError> {
        // SAFETY: the scene is live and owned here alone.
        unsafe { sys::rtcCommitScene(self.handle.0) };
        self.device.check("building the tree")?;
        Ok(EmbreeScene { handle: self.handle, device: self.device, mesh: self.mesh })
    }

    /// Sets the scene's build quality, as an application without a device string would.
    #[cfg(test)]
    pub(super) fn set_quality(&mut self, quality: sys::RTCBuildQuality) {
        // SAFETY: the scene is live and owned here alone.
        unsafe { sys::rtcSetSceneBuildQuality(self.handle.0, quality) };
    }
}

/// A committed scene: Embree's tree over a mesh, traced by `rtcIntersect1` and `rtcOccluded1`.
pub struct EmbreeScene<'a> {
    handle: Handle,
    /// Released after the scene.
    device: Device,
    mesh: &'a Mesh,
}

impl<'a> EmbreeScene<'a> {
    /// A committed scene that another owner has too, who must not change it while this one lives.
    pub(super) fn shared(handle: &'a Handle, device: &Device, mesh: &'a Mesh) -> Self {
        // SAFETY: the scene is live; the reference taken here is released when the new handle is dropped.
        unsafe { sys::rtcRetainScene(handle.0) };
        Self { handle: Handle(handle.0), device: device.clone(), mesh }
    }

    /// The box of all triangles; empty without any.
    pub fn bounds(&self) -> Aabb {
        let mut bounds = sys::RTCBounds::default();
        // SAFETY: the scene is live and committed, `bounds` is written.
        unsafe { sys::rtcGetSceneBounds(self.raw(), &mut bounds) };
        Aabb::new(
            Vec3A::new(bounds.lower_x, bounds.lower_y, bounds.lower_z),
            Vec3A::new(bounds.upper_x, bounds.upper_y, bounds.upper_z),
        )
    }

    /// The same scene with its geometry marked as changed, so that the next commit builds its tree again, in
    /// what memory Embree has kept.
    ///
    /// # Errors
    /// [`EmbreeError::Call`] with Embree's text.
    pub fn modified(self) -> Result<Prepared<'a>, EmbreeError> {
        // SAFETY: the scene is live and owned here alone; the geometry is the one attached when it was made,
        // which the scene keeps alive.
        unsafe { sys::rtcCommitGeometry(sys::rtcGetGeometry(self.raw(), GEOMETRY)) };
        self.device.check("marking the mesh as changed")?;
        Ok(Prepared { handle: self.handle, device: self.device, mesh: self.mesh })
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The device it was built with.
    pub fn device(&self) -> &Device {
        &self.device
    }

    pub(super) fn raw(&self) -> sys::RTCScene {
        self.handle.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::test_meshes::soup;
    use crate::embree::{Config, EmbreeBuilder, Width};

    #[test]
    fn flags_stand_beside_each_other() {
        let mesh = soup(10);
        let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 1 };
        let device = Device::robust(&config).unwrap();
        for is_robust_first in [false, true] {
            let prepared = device.prepare(&mesh).unwrap();
            let prepared =
                if is_robust_first { prepared.robust().dynamic() } else { prepared.dynamic().robust() };
            // SAFETY: the scene is live.
            let flags = unsafe { sys::rtcGetSceneFlags(prepared.handle.0) };
            assert_eq!(flags, sys::RTC_SCENE_FLAG_DYNAMIC | sys::RTC_SCENE_FLAG_ROBUST);
        }
    }
}
