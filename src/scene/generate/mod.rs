//! Generated scenes: seeded, the same on every platform, with an exact number of triangles.

mod ancient;
mod animated;
mod city;
mod conference;
mod courtyard;
mod crown;
mod generated_scene;
mod hair;
mod interior;
mod mixed;
mod parts;
mod plant;
mod sets;
mod statue;

pub use animated::{Animated, Animation, animated, animated_by_name};
pub use generated_scene::Generator;
pub use mixed::{scalable, scalable_name, scalable_triangles};
pub use sets::{builtin, generator, generators};
