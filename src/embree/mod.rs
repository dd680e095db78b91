//! The distribution's Embree 3 or 4 behind safe types: devices, scenes, its three builders at both widths, and
//! its reports of the trees it built. None of Embree's own types leave this module.
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

mod arguments;
mod build_bvh;
mod capture;
mod config;
mod device;
mod error;
mod inspect;
mod instances;
mod moving;
mod packets;
mod query;
mod scene;
#[cfg(not(embree4))]
mod streams;
#[cfg(test)]
mod test_meshes;
#[cfg(feature = "graft")]
mod tree;

pub use config::{Config, EmbreeBuilder, Width};
pub use device::{Device, Memory, version};
pub use error::EmbreeError;
pub use inspect::{Inspection, inspect};
pub use instances::InstanceScene;
pub use moving::{Committed, Following, MovingScene};
pub use packets::Packets;
pub use scene::{EmbreeScene, Prepared};
#[cfg(not(embree4))]
pub use streams::{PacketStream, Stream};
#[cfg(feature = "graft")]
pub use tree::{Unavailable, graft, native};
