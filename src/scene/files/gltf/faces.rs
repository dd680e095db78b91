//! The faces of a primitive: which corners make its triangles.

use super::accessor::accessor;
use crate::scene::files::error::Fault;
use gltf::json::Root;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

/// The faces of a primitive.
pub(super) struct Faces {
    /// The primitive's place in its mesh.
    pub index: usize,
    mode: Mode,
    /// Accessors.
    pub positions: usize,
    pub indices: Option<usize>,
    /// Indices, or vertices where there are none.
    pub corners: u64,
}

impl Faces {
    /// `None` for points, lines and what has no triangle.
    pub fn of(root: &Root, primitive: &Primitive, [mesh, index]: [usize; 2]) -> Result<Option<Self>, Fault> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(Fault::new(place([mesh, index]), "of unknown mode", Fault::DAMAGED));
        };
        let Some(positions) = position_accessor(primitive).filter(|_| mode as u8 >= Mode::Triangles as u8)
        else {
            return Ok(None);
        };
        let indices = primitive.indices.map(|index| index.value());
        let corners = accessor(root, indices.unwrap_or(positions))?.0.count.0;
        let faces = Self { index, mode, positions, indices, corners };
        Ok((faces.triangles() > 0).then_some(faces))
    }

    pub fn accessors(&self) -> impl Iterator<Item = usize> {
        [self.positions].into_iter().chain(self.indices)
    }

    pub fn triangles(&self) -> u64 {
        if self.mode == Mode::Triangles { self.corners / 3 } else { self.corners.saturating_sub(2) }
    }

    /// False if some corners at the end make no triangle.
    pub fn are_whole(&self) -> bool {
        self.mode != Mode::Triangles || self.corners.is_multiple_of(3)
    }

    /// Which corners make a triangle, as the specification orders them.
    pub fn corners_of(&self, triangle: usize) -> [usize; 3] {
        match self.mode {
            Mode::TriangleStrip => [triangle, triangle + 1 + triangle % 2, triangle + 2 - triangle % 2],
            Mode::TriangleFan => [triangle + 1, triangle + 2, 0],
            _ => [3 * triangle, 3 * triangle + 1, 3 * triangle + 2],
        }
    }
}

/// Whether the elements of an accessor are zeros but for those replaced.
pub(super) fn is_unwritten(root: &Root, accessor: usize) -> bool {
    root.accessors.get(accessor).is_some_and(|accessor| accessor.buffer_view.is_none())
}

/// The accessor of a primitive's positions.
pub(super) fn position_accessor(primitive: &Primitive) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(Semantic::Positions)).map(|accessor| accessor.value())
}

/// A primitive of a mesh, in words.
pub(super) fn place([mesh, primitive]: [usize; 2]) -> String {
    format!("mesh {mesh}, primitive {primitive}")
}
