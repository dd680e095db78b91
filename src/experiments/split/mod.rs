//! Figures 3 and 5 of the paper: a split of a cut as the builder made it. Figure 3 is an object split: the cut, its two
//! sides, both refined; Figure 5 a spatial one, with its plane and its clip boxes.
//!
//! `choose` finds splits worth a picture, `records` keeps their boxes, `draw` projects them.

pub mod choose;
pub mod draw;
pub mod records;

pub use choose::choose;
pub use draw::draw;
pub use records::{BoxRow, SPLITS, of_picture, pictures};

use crate::builders::steps::split_boxes::SplitBoxes;
use std::fmt::Display;

/// A figure of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Figure 3.
    Object,
    /// Figure 5.
    Spatial,
}

/// A split to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// What it shows.
    pub kind: Kind,
    /// Scene name.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Builder name.
    pub builder: String,
    /// The split.
    pub split: SplitBoxes,
}

impl Kind {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Object, Self::Spatial];

    /// The paper's number of the figure.
    pub fn figure(self) -> u32 {
        match self {
            Self::Object => 3,
            Self::Spatial => 5,
        }
    }

    /// Name of its file.
    pub fn file(self) -> &'static str {
        match self {
            Self::Object => "object-split",
            Self::Spatial => "spatial-split",
        }
    }
}

impl Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Object => "An object split",
            Self::Spatial => "A spatial split",
        })
    }
}
