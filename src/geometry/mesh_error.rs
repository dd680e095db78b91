//! What is wrong with vertices and triangles, and which of them a mesh leaves out.

use crate::memory::OutOfMemory;

/// Why a mesh could not be made.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// More triangles than every builder is sure to hold.
    #[error("{0} triangles are more than the 2^26 that any tree is sure to hold; split the mesh")]
    TooLarge(usize),
    /// No memory for it.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

/// Why vertices could not be moved.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum MoveError {
    /// Not as many vertices as the mesh has.
    #[error("{given} vertices for a mesh of {vertices}; give one for each, in their order")]
    Count {
        /// Vertices given.
        given: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A vertex of a triangle would have a NaN, infinite or larger coordinate than
    /// [`Ray::LARGEST`](super::Ray::LARGEST).
    #[error("vertex {0} is not finite or too large; move it elsewhere")]
    NotFinite(u32),
}

/// Triangles left out of a mesh because Embree would drop them silently, counted by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dropped {
    /// A vertex has a NaN, infinite or larger coordinate than [`Ray::LARGEST`](super::Ray::LARGEST).
    pub non_finite: usize,
    /// A vertex index lies beyond the vertices.
    pub out_of_range: usize,
}

impl Dropped {
    /// All triangles left out.
    pub fn total(&self) -> usize {
        self.non_finite + self.out_of_range
    }
}

impl std::fmt::Display for Dropped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let noun = if self.total() == 1 { "triangle" } else { "triangles" };
        write!(f, "{} {noun} dropped", self.total())?;
        let reasons =
            [(self.non_finite, "non-finite or huge vertices"), (self.out_of_range, "indices out of range")];
        let mut before = ":";
        for (count, reason) in reasons.into_iter().filter(|(count, _)| *count > 0) {
            write!(f, "{before} {count} with {reason}")?;
            before = ",";
        }
        Ok(())
    }
}
