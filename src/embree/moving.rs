//! A scene whose mesh moves: Embree builds its tree again, or fits the one it has to the moved vertices
//! (`RTC_BUILD_QUALITY_REFIT`). The scene is dynamic (`RTC_SCENE_FLAG_DYNAMIC`) and holds copies of the mesh's buffers.

#![allow(unsafe_code)]

use super::config::{Config, EmbreeBuilder, Width};
use super::scene::{EmbreeScene, GEOMETRY, Handle};
use super::{Device, EmbreeError};
use crate::geometry::{Hit, Mesh, Ray, Tracer};
use embree_sys as sys;

/// How Embree follows a mesh that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Following {
    /// A new tree, in the memory that Embree has kept.
    Rebuild(EmbreeBuilder),
    /// A tree built once, by binned SAH, whose boxes are then fitted to the vertices.
    Refit,
}

/// A scene that follows a mesh.
pub struct MovingScene {
    handle: Handle,
    /// The geometry's own vertices, of Embree's.
    vertices: *mut [f32; 3],
    /// Numbers of vertices and triangles.
    counts: [usize; 2],
    /// Whether the tree is that of the vertices.
    is_committed: bool,
    /// Released after the scene.
    device: Device,
}

// SAFETY: neither the scene nor its buffer is bound to a thread; the buffer is written through `&mut self` alone.
unsafe impl Send for MovingScene {}

/// The scene as last committed.
pub struct Committed<'a>(EmbreeScene<'a>);

impl MovingScene {
    /// A scene of `mesh`, to be committed first, that builds with `threads`.
    ///
    /// # Errors
    /// [`EmbreeError`] with Embree's text.
    pub fn new(mesh: &Mesh, following: Following, width: Width, threads: usize) -> Result<Self, EmbreeError> {
        let device = match following {
            Following::Rebuild(builder) => Device::new(&Config { builder, width, threads })?,
            Following::Refit => Device::refitting(width, threads)?,
        };
        // SAFETY: the device is live. Embree allocates both buffers, of the stride, format and count given, which
        // are those of the slices copied there; a null pointer is not written to. The scene keeps its own reference
        // to the geometry, which keeps the buffers.
        let (handle, vertices) = unsafe {
            let handle = Handle(sys::rtcNewScene(device.raw()));
            sys::rtcSetSceneFlags(handle.0, sys::RTC_SCENE_FLAG_DYNAMIC);
            let geometry = sys::rtcNewGeometry(device.raw(), sys::RTC_GEOMETRY_TYPE_TRIANGLE);
            if following == Following::Refit {
                sys::rtcSetGeometryBuildQuality(geometry, sys::RTC_BUILD_QUALITY_REFIT);
            }
            let new =
                |kind, format, count| sys::rtcSetNewGeometryBuffer(geometry, kind, 0, format, 12, count);
            let vertices: *mut [f32; 3] =
                new(sys::RTC_BUFFER_TYPE_VERTEX, sys::RTC_FORMAT_FLOAT3, mesh.vertices().len()).cast();
            let indices: *mut [u32; 3] =
                new(sys::RTC_BUFFER_TYPE_INDEX, sys::RTC_FORMAT_UINT3, mesh.len()).cast();
            let made = device.check("making a scene");
            if made.is_ok() && !vertices.is_null() && !indices.is_null() {
                vertices.copy_from_nonoverlapping(mesh.vertices().as_ptr(), mesh.vertices().len());
                indices.copy_from_nonoverlapping(mesh.triangles().as_ptr(), mesh.len());
            }
            if made.is_ok() {
                sys::rtcCommitGeometry(geometry);
                sys::rtcAttachGeometryByID(handle.0, geometry, GEOMETRY);
            }
            sys::rtcReleaseGeometry(geometry);
            made?;
            (handle, vertices)
        };
        device.check("attaching the mesh")?;
        let counts = [mesh.vertices().len(), mesh.len()];
        Ok(Self { handle, vertices, counts, is_committed: false, device })
    }

    /// Copies the vertices of `mesh`, the scene's own with vertices moved; to be committed.
    ///
    /// # Panics
    /// If it has another number of vertices or triangles.
    pub fn follow(&mut self, mesh: &Mesh) {
        assert_eq!(self.counts, [mesh.vertices().len(), mesh.len()], "the mesh that the scene was made of");
        self.is_committed = false;
        if self.vertices.is_null() {
            return;
        }
        // SAFETY: the buffer of as many vertices, which lives as long as the scene; nobody reads it, as whoever traces
        // borrows the scene.
        unsafe { self.vertices.copy_from_nonoverlapping(mesh.vertices().as_ptr(), mesh.vertices().len()) };
    }

    /// Marks the vertices as changed and builds or refits the tree: `rtcCommitGeometry`, `rtcCommitScene` and a look at
    /// the error code.
    ///
    /// # Errors
    /// [`EmbreeError::Call`] with Embree's text.
    pub fn commit(&mut self) -> Result<(), EmbreeError> {
        self.is_committed = false;
        // SAFETY: the scene is live and borrowed here alone; the geometry is the one attached when it was made.
        unsafe {
            let geometry = sys::rtcGetGeometry(self.handle.0, GEOMETRY);
            sys::rtcUpdateGeometryBuffer(geometry, sys::RTC_BUFFER_TYPE_VERTEX, 0);
            sys::rtcCommitGeometry(geometry);
            sys::rtcCommitScene(self.handle.0);
        }
        self.device.check("building the tree")?;
        self.is_committed = true;
        Ok(())
    }

    /// The scene as last committed, over `mesh`, whose vertices it has.
    ///
    /// # Panics
    /// If it was not committed, or not since it followed a mesh.
    pub fn committed<'a>(&'a self, mesh: &'a Mesh) -> Committed<'a> {
        assert!(self.is_committed, "a scene is committed before it is traced");
        Committed(EmbreeScene::shared(&self.handle, &self.device, mesh))
    }
}

impl<'a> std::ops::Deref for Committed<'a> {
    type Target = EmbreeScene<'a>;

    fn deref(&self) -> &EmbreeScene<'a> {
        &self.0
    }
}

impl Tracer for Committed<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.0.closest(rays, hits);
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.0.any(rays, occluded);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::test_meshes::{rays, soup};
    use crate::trace::verify;

    fn moved(mesh: &Mesh, by: f32) -> Mesh {
        let mut moved = mesh.clone();
        let wave = |&[x, y, z]: &[f32; 3]| [x + by * (7.0 * y).sin(), y + by * (5.0 * z).sin(), z];
        moved.move_vertices(&mesh.vertices().iter().map(wave).collect::<Vec<_>>()).unwrap();
        moved
    }

    fn hits(scene: &dyn Tracer, rays: &[Ray]) -> Vec<Hit> {
        let mut hits = vec![Hit::MISS; rays.len()];
        scene.closest(rays, &mut hits);
        hits
    }

    const ALL: [Following; 4] = [
        Following::Refit,
        Following::Rebuild(EmbreeBuilder::Morton),
        Following::Rebuild(EmbreeBuilder::Sah),
        Following::Rebuild(EmbreeBuilder::FastSpatial),
    ];

    #[test]
    fn moving_scenes_hit_what_new_ones_do() {
        let (mesh, rays) = (soup(3000), rays(2000));
        for (following, width) in ALL.into_iter().flat_map(|it| Width::ALL.map(|width| (it, width))) {
            let mut scene = MovingScene::new(&mesh, following, width, 2).unwrap();
            for by in [0.0, 0.05, 0.3, 0.0] {
                let moved = moved(&mesh, by);
                scene.follow(&moved);
                scene.commit().unwrap();
                let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 2 };
                let device = Device::new(&config).unwrap();
                let fresh = device.prepare(&moved).unwrap().commit().unwrap();
                let committed = scene.committed(&moved);
                assert_eq!(committed.bounds(), fresh.bounds());
                let verdict =
                    verify::compare_closest(&moved, &rays, &hits(&fresh, &rays), &hits(&committed, &rays));
                assert!(verdict.is_ok() && verdict.edge < 20, "{following:?} {width:?}: {verdict}");
            }
        }
    }

    /// The triangles of the leaves of Embree's tree, leaf by leaf, and its cost.
    #[cfg(feature = "graft")]
    fn leaves(scene: &MovingScene, mesh: &Mesh) -> (Vec<[u32; 4]>, f64) {
        let tree = crate::embree::native::read4(&scene.committed(mesh)).unwrap();
        assert_eq!(tree.validate(mesh), Ok(()));
        (tree.blocks.iter().map(|block| block.prims).collect(), crate::bvh::sah_cost(&tree))
    }

    #[test]
    #[cfg(feature = "graft")]
    fn a_refit_tree_keeps_its_leaves_and_a_rebuilt_one_does_not() {
        let mesh = soup(3000);
        let moved = moved(&mesh, 3.0);
        let mut found = Vec::new();
        for following in [Following::Refit, Following::Rebuild(EmbreeBuilder::Sah)] {
            let mut scene = MovingScene::new(&mesh, following, Width::Four, 2).unwrap();
            scene.commit().unwrap();
            let (before, _) = leaves(&scene, &mesh);
            scene.follow(&moved);
            scene.commit().unwrap();
            let (after, cost) = leaves(&scene, &moved);
            found.push((before == after, cost));
        }
        assert!(found[0].0 && !found[1].0);
        assert!(found[0].1 > 1.05 * found[1].1, "{found:?}");
    }

    #[test]
    #[should_panic = "committed before it is traced"]
    fn a_scene_that_is_not_committed_is_not_traced() {
        let mesh = soup(100);
        let mut scene = MovingScene::new(&mesh, Following::Refit, Width::Four, 1).unwrap();
        scene.commit().unwrap();
        assert!(!scene.committed(&mesh).bounds().is_empty());
        scene.follow(&mesh);
        scene.committed(&mesh);
    }

    #[test]
    fn an_empty_mesh_moves_too() {
        let mesh = soup(0);
        for following in ALL {
            let mut scene = MovingScene::new(&mesh, following, Width::Four, 1).unwrap();
            scene.follow(&mesh);
            scene.commit().unwrap();
            let rays = rays(10);
            assert!(hits(&scene.committed(&mesh), &rays).iter().all(|hit| !hit.is_hit()));
        }
    }
}
