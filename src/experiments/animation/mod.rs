//! Animation (paper, 5.6 and 6, left open): what follows a moving scene best, frame by frame: a tree built again,
//! one that is refitted, or one refined again from a refitted auxiliary tree.
//!
//! [`entrant`] says what takes part, a [`contestant`] is one of [`ours`] or of Embree's, `measure` lets them follow
//! a scene and verifies every frame, `records` keeps what came of it, [`compared`] finds where refitting loses,
//! `findings` tells it and `draw` draws it.

pub mod compared;
pub mod contestant;
pub mod draw;
#[cfg(feature = "embree")]
pub mod embree;
pub mod entrant;
pub mod findings;
pub mod measure;
pub mod ours;
pub mod records;

pub use draw::draw;
pub use entrant::{Entrant, Update, entrants};
pub use findings::findings;
pub use measure::{AnimationSettings, measure};
pub use records::{ANIMATION, FrameRow};
