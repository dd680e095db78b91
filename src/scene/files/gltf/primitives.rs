//! The primitives of placed meshes: first how much they are, then their triangles.

use super::accessor::{accessor, indices, positions};
use super::buffers::Buffers;
use super::nodes::PlacedMesh;
use crate::scene::files::error::Fault;
use crate::scene::files::raw_mesh::RawMesh;
use crate::scene::model::Contents;
use glam::{DMat4, DVec3};
use gltf::json::Root;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use std::collections::BTreeSet;

/// How much the scene is.
#[derive(Default)]
pub(super) struct Plan {
    pub vertices: u64,
    pub triangles: u64,
    /// The accessors in use.
    pub accessors: BTreeSet<usize>,
}

/// Sums the sizes that the file declares, and counts what is no triangle.
pub(super) fn plan(root: &Root, placed: &[PlacedMesh], contents: &mut Contents) -> Result<Plan, Fault> {
    let mut plan = Plan::default();
    let mut morphed = 0;
    for placed in placed {
        let mut seen = BTreeSet::new();
        for primitive in primitives(root, placed)? {
            contents.objects += 1;
            let Some(faces) = Faces::of(root, primitive)? else {
                match &primitive.mode {
                    Checked::Valid(Mode::Points) => contents.points += 1,
                    Checked::Valid(Mode::Lines | Mode::LineLoop | Mode::LineStrip) => contents.lines += 1,
                    _ => contents.empty += 1,
                }
                continue;
            };
            contents.empty += usize::from(!faces.are_whole());
            morphed += usize::from(primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()));
            if seen.insert(faces.positions) {
                plan.vertices = plan.vertices.saturating_add(accessor(root, faces.positions)?.0.count.0);
            }
            plan.triangles = plan.triangles.saturating_add(faces.triangles());
            plan.accessors.extend([faces.positions].into_iter().chain(faces.indices));
        }
    }
    if morphed > 0 {
        contents.remarks.push(format!("{morphed} primitives with morph targets have their base shape"));
    }
    Ok(plan)
}

/// Appends the triangles of all placed meshes, in the scene's space.
pub(super) fn append(
    root: &Root,
    placed: &[PlacedMesh],
    buffers: &Buffers,
    raw: &mut RawMesh<'_>,
) -> Result<(), Fault> {
    let mut corners = Vec::new();
    for placed in placed {
        // Primitives of a mesh often share their vertices.
        let mut known: Vec<(usize, u32, u32)> = Vec::new();
        for primitive in primitives(root, placed)? {
            let Some(faces) = Faces::of(root, primitive)? else { continue };
            let found = known.iter().find(|(accessor, ..)| *accessor == faces.positions);
            let (first, count) = match found {
                Some(&(_, first, count)) => (first, count),
                None => {
                    let begin = raw.vertices.len();
                    append_vertices(root, buffers, faces.positions, &placed.transform, raw)?;
                    let range = u32::try_from(begin).ok().zip(u32::try_from(raw.vertices.len()).ok());
                    let (first, end) = range.ok_or_else(|| {
                        Fault::new("its size", "more than 2^32 vertices", "split the scene")
                    })?;
                    known.push((faces.positions, first, end - first));
                    (first, end - first)
                }
            };
            corners.clear();
            match faces.indices {
                Some(accessor) => {
                    let room = usize::try_from(faces.corners).unwrap_or(usize::MAX);
                    raw.reserve_beside(&mut corners, room)?;
                    indices(root, buffers, accessor, &mut corners)?;
                }
                None => {
                    raw.reserve_beside(&mut corners, count as usize)?;
                    corners.extend(0..count);
                }
            }
            let is_mirrored = placed.transform.determinant() < 0.0;
            for triangle in 0..faces.triangles() as usize {
                let [a, b, c] = faces.corners_of(triangle).map(|corner| match corners.get(corner) {
                    Some(&index) if index < count => first + index,
                    _ => RawMesh::NO_VERTEX,
                });
                raw.push_triangle(if is_mirrored { [a, c, b] } else { [a, b, c] })?;
            }
        }
    }
    Ok(())
}

fn append_vertices(
    root: &Root,
    buffers: &Buffers,
    accessor: usize,
    transform: &DMat4,
    raw: &mut RawMesh<'_>,
) -> Result<(), Fault> {
    let moved = |position: [f32; 3]| -> [f32; 3] {
        if *transform == DMat4::IDENTITY {
            return position;
        }
        transform.transform_point3(DVec3::from(position.map(f64::from))).as_vec3().to_array()
    };
    let begin = raw.vertices.len();
    let replaced = positions(root, buffers, accessor, |position| Ok(raw.push_vertex(moved(position))?))?;
    for (place, position) in replaced {
        if let Some(vertex) = raw.vertices.get_mut(begin + place) {
            *vertex = moved(position);
        }
    }
    Ok(())
}

fn primitives<'a>(root: &'a Root, placed: &PlacedMesh) -> Result<&'a [Primitive], Fault> {
    let fault = || Fault::new(format!("mesh {}", placed.mesh), "there is no such mesh", Fault::DAMAGED);
    root.meshes.get(placed.mesh).map(|mesh| &mesh.primitives[..]).ok_or_else(fault)
}

/// The faces of a primitive.
struct Faces {
    mode: Mode,
    /// Accessors.
    positions: usize,
    indices: Option<usize>,
    /// Indices, or vertices where there are none.
    corners: u64,
}

impl Faces {
    /// `None` for points, lines and what has no triangle.
    fn of(root: &Root, primitive: &Primitive) -> Result<Option<Self>, Fault> {
        let mode = match &primitive.mode {
            Checked::Valid(mode) => *mode,
            Checked::Invalid => return Err(Fault::new("a primitive", "of unknown mode", Fault::DAMAGED)),
        };
        let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let Some(positions) = positions.filter(|_| mode as u8 >= Mode::Triangles as u8) else {
            return Ok(None);
        };
        let (positions, indices) = (positions.value(), primitive.indices.map(|index| index.value()));
        let corners = accessor(root, indices.unwrap_or(positions))?.0.count.0;
        let faces = Self { mode, positions, indices, corners };
        Ok((faces.triangles() > 0).then_some(faces))
    }

    fn triangles(&self) -> u64 {
        if self.mode == Mode::Triangles { self.corners / 3 } else { self.corners.saturating_sub(2) }
    }

    /// False if some corners at the end make no triangle.
    fn are_whole(&self) -> bool {
        self.mode != Mode::Triangles || self.corners.is_multiple_of(3)
    }

    /// Which corners make a triangle, as the specification orders them.
    fn corners_of(&self, triangle: usize) -> [usize; 3] {
        match self.mode {
            Mode::TriangleStrip => [triangle, triangle + 1 + triangle % 2, triangle + 2 - triangle % 2],
            Mode::TriangleFan => [triangle + 1, triangle + 2, 0],
            _ => [3 * triangle, 3 * triangle + 1, 3 * triangle + 2],
        }
    }
}
