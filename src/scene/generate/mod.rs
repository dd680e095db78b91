//! Generated scenes: seeded, the same on every platform, with an exact number of triangles.

mod ancient;
mod city;
mod conference;
mod courtyard;
mod crown;
mod generator;
mod hair;
mod interior;
mod mixed;
mod parts;
mod plant;
mod sets;
mod statue;

pub use generator::Generator;
pub use mixed::{scalable, scalable_name, scalable_triangles};
pub use sets::{builtin, generator, generators};
