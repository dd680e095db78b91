//! glTF 2: `.gltf` with buffers in files or data URIs, and `.glb`. The crate `gltf` reads the JSON; bytes are taken
//! from the buffers here, each access checked, because the crate's own readers trust counts and offsets.
//!
//! A file is read in this order: [`container`], what it requires ([`extensions`]), where its meshes stand ([`nodes`]),
//! how much that is, the [`buffers`] in use, and the [`primitives`] through [`accessor`].

mod accessor;
mod buffers;
mod container;
mod extensions;
mod faces;
mod nodes;
mod primitives;

use super::error::Fault;
use super::guard::Guard;
use super::raw_mesh::RawMesh;
use container::Container;
use gltf::json::Root;
use std::io::BufRead;
use std::path::Path;

/// Reads a `.gltf` file; `path` is where its buffers are looked for.
pub(super) fn read_json<'a>(
    reader: &mut dyn BufRead,
    path: &Path,
    guard: &'a Guard,
) -> Result<RawMesh<'a>, Fault> {
    read(Container::of_json(reader, guard)?, path, guard)
}

/// Reads a `.glb` file.
pub(super) fn read_binary<'a>(
    reader: &mut dyn BufRead,
    path: &Path,
    guard: &'a Guard,
) -> Result<RawMesh<'a>, Fault> {
    read(Container::of_binary(reader, guard)?, path, guard)
}

/// Bytes that an object takes once parsed, at most, in a list that doubles when it grows.
const OBJECT: u64 = 512;
/// The same of a number in a list.
const ELEMENT: u64 = 32;

fn read<'a>(container: Container, path: &Path, guard: &'a Guard) -> Result<RawMesh<'a>, Fault> {
    const REMEDY: &str = "export it as glTF 2.0";
    let Container { json, binary } = container;
    // What it is parsed into is larger than its text by far where most of it is empty objects.
    let count = |wanted: u8| json.iter().filter(|&&byte| byte == wanted).count() as u64;
    guard.allow(json.len() as u64 + OBJECT * count(b'{') + ELEMENT * count(b','))?;
    let root: Root = gltf::json::deserialize::from_slice(&json).map_err(|error| {
        let place = format!("JSON, line {} column {}", error.line(), error.column());
        let problem = error.to_string();
        Fault::new(place, problem.split(" at line ").next().unwrap_or_default(), REMEDY)
    })?;
    if !root.asset.version.starts_with("2.") {
        return Err(Fault::new("asset", &format!("version {}", root.asset.version), REMEDY));
    }
    let mut raw = RawMesh::new(guard);
    raw.up = Some(glam::Vec3::Y);
    raw.cameras = root.cameras.len();
    extensions::check(&root, &mut raw.contents)?;
    let length = json.len() as u64;
    drop(json);

    let placed = nodes::placed_meshes(&root, &mut raw.contents)?;
    let plan = primitives::plan(&root, &placed, &mut raw.contents)?;
    raw.announce(plan.vertices, plan.triangles)?;
    if plan.vertices > u64::from(u32::MAX) {
        return Err(Fault::new(
            "its size",
            &format!("{} vertices, of at most 2^32", plan.vertices),
            "split the scene",
        ));
    }
    let buffers = buffers::Buffers::load(&root, &plan.accessors, binary, path, guard)?;
    raw.held = buffers.bytes();
    guard.allow_unwritten(plan.unwritten, length.saturating_add(buffers.bytes()))?;
    raw.announce(plan.vertices, plan.triangles)?;
    primitives::append(&root, &placed, &plan, &buffers, &mut raw)?;
    Ok(raw)
}
