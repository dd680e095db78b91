//! The primitives of placed meshes: first how much they are, then their triangles.

use super::accessor::{accessor, indices, positions};
use super::buffers::Buffers;
use super::faces::{Faces, is_unwritten, place, position_accessor};
use super::nodes::PlacedMesh;
use crate::geometry::Mesh;
use crate::scene::files::error::Fault;
use crate::scene::files::raw_mesh::RawMesh;
use crate::scene::model::Contents;
use glam::{DMat4, DVec3};
use gltf::json::Root;
use gltf::json::mesh::{Mode, Primitive};
use gltf::json::validation::Checked;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// How much the scene is, and what of its meshes is in it.
#[derive(Default)]
pub(super) struct Plan {
    pub vertices: u64,
    pub triangles: u64,
    /// Bytes of those of them that are zeros for want of data: accessors without a view, of which some elements are
    /// replaced.
    pub unwritten: u64,
    /// The accessors in use.
    pub accessors: BTreeSet<usize>,
    /// The primitives with triangles of each mesh that is placed. A mesh may stand in many places.
    meshes: BTreeMap<usize, MeshPlan>,
}

/// Bytes of a vertex, and of a triangle.
const BYTES: u64 = size_of::<[f32; 3]>() as u64;

/// What a mesh adds in each of its places.
#[derive(Default)]
struct MeshPlan {
    faces: Vec<Faces>,
    /// Vertices by accessor.
    vertices: BTreeMap<usize, u64>,
    triangles: u64,
    /// Those of accessors without a view.
    unwritten_triangles: u64,
    contents: Contents,
    morphed: usize,
    /// The primitives that say nothing of where their vertices are.
    without_positions: Vec<usize>,
}

/// Sums the sizes that the file declares, and counts what is no triangle.
pub(super) fn plan(root: &Root, placed: &[PlacedMesh], contents: &mut Contents) -> Result<Plan, Fault> {
    let mut plan = Plan::default();
    let mut morphed = 0;
    let mut without_positions: Vec<[usize; 2]> = Vec::new();
    let mut known = Known::nothing();
    for placed in placed {
        let mesh = match plan.meshes.entry(placed.mesh) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => {
                let mesh = MeshPlan::of(root, placed)?;
                plan.accessors.extend(mesh.faces.iter().flat_map(Faces::accessors));
                without_positions.extend(mesh.without_positions.iter().map(|&index| [placed.mesh, index]));
                place.insert(mesh)
            }
        };
        let known = known.at(&placed.transform);
        for (&accessor, &count) in &mesh.vertices {
            if known.insert(accessor, ()).is_none() {
                plan.vertices = plan.vertices.saturating_add(count);
                if is_unwritten(root, accessor) {
                    plan.unwritten = plan.unwritten.saturating_add(count.saturating_mul(BYTES));
                }
            }
        }
        plan.triangles = plan.triangles.saturating_add(mesh.triangles);
        plan.unwritten = plan.unwritten.saturating_add(mesh.unwritten_triangles.saturating_mul(BYTES));
        // Refused by their number, before more time goes into counting.
        if plan.triangles > Mesh::MAX_TRIANGLES as u64 {
            break;
        }
        contents.objects += mesh.contents.objects;
        contents.points += mesh.contents.points;
        contents.lines += mesh.contents.lines;
        contents.empty += mesh.contents.empty;
        morphed += mesh.morphed;
    }
    if morphed > 0 {
        contents.remarks.push(format!("{morphed} primitives with morph targets have their base shape"));
    }
    if let [first, others @ ..] = &without_positions[..] {
        let place = place(*first);
        if plan.triangles == 0 {
            return Err(Fault::new(place, "no POSITION", "export it with the positions of its vertices"));
        }
        let more =
            if others.is_empty() { String::new() } else { format!(", nor in {} others", others.len()) };
        contents.remarks.push(format!("{place}: no POSITION{more}"));
    }
    Ok(plan)
}

/// What is known of the accessors whose vertices are in the scene already, moved as those of the mesh at hand:
/// primitives of a mesh often share theirs, and in some files all meshes do.
struct Known<T> {
    transform: DMat4,
    accessors: HashMap<usize, T>,
}

impl<T> Known<T> {
    fn nothing() -> Self {
        Self { transform: DMat4::IDENTITY, accessors: HashMap::new() }
    }

    /// The accessors of a mesh placed by `transform`; forgets vertices that were moved otherwise.
    fn at(&mut self, transform: &DMat4) -> &mut HashMap<usize, T> {
        if self.transform != *transform {
            *self = Self { transform: *transform, ..Self::nothing() };
        }
        &mut self.accessors
    }
}

impl MeshPlan {
    fn of(root: &Root, placed: &PlacedMesh) -> Result<Self, Fault> {
        let mut mesh = Self::default();
        for (index, primitive) in primitives(root, placed)?.iter().enumerate() {
            mesh.contents.objects += 1;
            let Some(faces) = Faces::of(root, primitive, [placed.mesh, index])? else {
                match &primitive.mode {
                    Checked::Valid(Mode::Points) => mesh.contents.points += 1,
                    Checked::Valid(Mode::Lines | Mode::LineLoop | Mode::LineStrip) => {
                        mesh.contents.lines += 1
                    }
                    _ => {
                        mesh.contents.empty += 1;
                        if position_accessor(primitive).is_none() {
                            mesh.without_positions.push(index);
                        }
                    }
                }
                continue;
            };
            mesh.contents.empty += usize::from(!faces.are_whole());
            mesh.morphed +=
                usize::from(primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()));
            mesh.vertices.insert(faces.positions, accessor(root, faces.positions)?.0.count.0);
            mesh.triangles = mesh.triangles.saturating_add(faces.triangles());
            if is_unwritten(root, faces.indices.unwrap_or(faces.positions)) {
                mesh.unwritten_triangles = mesh.unwritten_triangles.saturating_add(faces.triangles());
            }
            mesh.faces.push(faces);
        }
        Ok(mesh)
    }
}

/// Appends the triangles of all placed meshes, in the scene's space.
pub(super) fn append(
    root: &Root,
    placed: &[PlacedMesh],
    plan: &Plan,
    buffers: &Buffers,
    raw: &mut RawMesh<'_>,
) -> Result<(), Fault> {
    let mut corners = Vec::new();
    // First vertex and number of vertices.
    let mut known: Known<(u32, u32)> = Known::nothing();
    for placed in placed {
        let known = known.at(&placed.transform);
        for faces in plan.meshes.get(&placed.mesh).into_iter().flat_map(|mesh| &mesh.faces) {
            let (first, count) = match known.get(&faces.positions) {
                Some(&range) => range,
                None => {
                    let begin = raw.vertices.len();
                    append_vertices(root, buffers, faces.positions, &placed.transform, raw)?;
                    let range = u32::try_from(begin).ok().zip(u32::try_from(raw.vertices.len()).ok());
                    let (first, end) = range.ok_or_else(|| {
                        Fault::new("its size", "more than 2^32 vertices", "split the scene")
                    })?;
                    known.insert(faces.positions, (first, end - first));
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
                if [a, b, c].contains(&RawMesh::NO_VERTEX) && raw.first_out_of_range.is_none() {
                    let of = place([placed.mesh, faces.index]);
                    raw.first_out_of_range = Some(format!("{of}, triangle {triangle}"));
                }
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
