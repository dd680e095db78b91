//! The distribution's Embree 3 behind safe types: devices, scenes, its three builders at both widths, and
//! what it says about the trees it built. None of Embree's own types leave this module.
//!
//! ```no_run
//! # fn main() -> Result<(), phr::embree::EmbreeError> {
//! use phr::embree::{Config, Device, EmbreeBuilder, Width};
//! # let mesh = phr::geometry::Mesh::new(vec![], vec![]).unwrap().0;
//! let device = Device::new(&Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 2 })?;
//! let scene = device.prepare(&mesh)?.commit()?;
//! println!("{:?}, {} bytes", scene.bounds(), device.memory().live_bytes);
//! # Ok(()) }
//! ```

mod capture;
mod config;
mod device;
mod error;
#[cfg(feature = "graft")]
pub mod graft;
mod inspect;
#[cfg(feature = "graft")]
mod layout;
#[cfg(feature = "graft")]
pub mod native;
#[cfg(feature = "graft")]
mod node_image;
mod packets;
#[cfg(feature = "graft")]
mod pages;
mod query;
pub mod rtcbuild;
mod scene;
#[cfg(test)]
mod test_meshes;

pub use config::{Config, EmbreeBuilder, Width};
pub use device::{Device, Memory, version};
pub use error::EmbreeError;
pub use inspect::{Inspection, inspect};
#[cfg(feature = "graft")]
pub use layout::Unavailable;
pub use packets::Packets;
pub use scene::{EmbreeScene, Prepared};
