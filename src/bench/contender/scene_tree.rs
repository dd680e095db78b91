//! A scene's tree in our form: read where its layout is known, else built over the same triangles by the public
//! `rtcBuildBVH`; and any tree of ours under Embree's kernel.

use super::built_tree::EitherWidth;
use crate::bvh::WideBvh;
#[cfg(feature = "graft")]
use crate::embree::{Config, graft::Graft, native};
use crate::embree::{Device, EmbreeBuilder, EmbreeScene, Width};
use crate::geometry::{Mesh, Tracer};

#[cfg(not(feature = "graft"))]
const NO_GRAFT: &str = "this program was built without the feature graft";

/// Whether the trees of the scenes of `device` can be read.
#[cfg(feature = "graft")]
pub fn is_readable(device: &Device) -> bool {
    native::known(device).is_ok()
}

/// Not without the feature.
#[cfg(not(feature = "graft"))]
pub fn is_readable(_: &Device) -> bool {
    false
}

/// A tree over the triangles of `scene`, which `builder` built, by `rtcBuildBVH`.
///
/// # Errors
/// Embree's message.
pub fn build_instead(
    scene: &EmbreeScene<'_>,
    builder: EmbreeBuilder,
    width: Width,
) -> Result<EitherWidth, String> {
    let (device, mesh) = (scene.device(), scene.mesh());
    let tree = match width {
        Width::Four => device.build_bvh(builder, mesh).map(EitherWidth::Four),
        Width::Eight => device.build_bvh(builder, mesh).map(EitherWidth::Eight),
    };
    tree.map_err(|error| error.to_string())
}

/// The tree of `scene` in our form, or why it cannot be read.
///
/// # Errors
/// Why not.
#[cfg(feature = "graft")]
pub fn read(scene: &EmbreeScene<'_>, width: Width) -> Result<EitherWidth, String> {
    let tree = match width {
        Width::Four => native::read4(scene).map(EitherWidth::Four),
        Width::Eight => native::read8(scene).map(EitherWidth::Eight),
    };
    tree.map_err(|unavailable| unavailable.why)
}

/// Not without the feature.
///
/// # Errors
/// Always.
#[cfg(not(feature = "graft"))]
pub fn read(_: &EmbreeScene<'_>, _: Width) -> Result<EitherWidth, String> {
    Err(NO_GRAFT.into())
}

/// Puts `tree` under Embree's kernel, laid out by the one routine for all trees. The scene whose root it
/// replaces is built by Morton codes, the quickest.
///
/// # Errors
/// Why that cannot be done here.
#[cfg(feature = "graft")]
pub fn graft<'a, const N: usize>(
    mesh: &'a Mesh,
    tree: &WideBvh<N>,
    threads: usize,
) -> Result<Box<dyn Tracer + 'a>, String> {
    let width = if N == 8 { Width::Eight } else { Width::Four };
    let config = Config { builder: EmbreeBuilder::Morton, width, threads };
    let host = || Device::new(&config)?.prepare(mesh)?.commit();
    let host = host().map_err(|error| error.to_string())?;
    let graft = Graft::new(host, tree).map_err(|unavailable| unavailable.why)?;
    Ok(Box::new(graft))
}

/// Not without the feature.
///
/// # Errors
/// Always.
#[cfg(not(feature = "graft"))]
pub fn graft<'a, const N: usize>(
    _: &'a Mesh,
    _: &WideBvh<N>,
    _: usize,
) -> Result<Box<dyn Tracer + 'a>, String> {
    Err(NO_GRAFT.into())
}
