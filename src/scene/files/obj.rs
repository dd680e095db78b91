//! OBJ through `tobj`, behind a filter that passes on positions and faces only.
//!
//! The filter bounds lines and memory and keeps the line number, none of which `tobj` does. It drops and counts
//! faces whose indices are out of range, where `tobj` would stop. It drops texture coordinates, normals, materials
//! and names, which need not be UTF-8, so that all objects become one mesh with shared vertices.

use super::error::Fault;
use super::guard::Guard;
use super::lines::Lines;
use super::raw_mesh::RawMesh;
use crate::scene::model::Contents;
use std::io::{self, BufRead, Read};

/// Bytes that `tobj` holds at most for a vertex or a triangle: coordinates and indices as read, a map of indices,
/// and the mesh that it makes of them.
const HELD: u64 = 128;

/// Reads `v` and `f` lines; indices may be negative (counted back from the last vertex given before). Faces with an
/// index out of range or without three vertices are left out and counted; points, lines, objects and groups are
/// counted.
pub(super) fn read<'a>(reader: &mut dyn BufRead, guard: &'a Guard) -> Result<RawMesh<'a>, Fault> {
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..tobj::LoadOptions::default() };
    let mut filter = Filter::new(reader, guard);
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let loaded = tobj::load_obj_buf(&mut filter, &options, no_materials);
    let (models, _) =
        loaded.map_err(|e| filter.fault.take().unwrap_or_else(|| filter.lines.fault(&e.to_string())))?;

    let mut raw = RawMesh::new(guard);
    (raw.out_of_range, raw.contents) = (filter.out_of_range, filter.contents);
    raw.first_out_of_range = filter.first_out_of_range;
    raw.contents.objects = raw.contents.objects.max(1);
    if filter.free_forms > 0 {
        raw.contents
            .remarks
            .push(format!("{} free-form curves and surfaces are not read", filter.free_forms));
    }
    for tobj::Model { mesh, .. } in models {
        let first = raw.vertices.len() as u32;
        for vertex in mesh.positions.as_chunks().0 {
            raw.push_vertex(*vertex)?;
        }
        for triangle in mesh.indices.as_chunks().0 {
            // Beyond 2^32 vertices no triangle is accepted anyway.
            raw.push_triangle(triangle.map(|index: u32| first.saturating_add(index)))?;
        }
    }
    Ok(raw)
}

/// True for the first words of comments and names, such as folders, whose backslash at the end continues nothing.
fn is_text(word: &[u8]) -> bool {
    word.starts_with(b"#") || matches!(word, b"o" | b"g" | b"usemtl" | b"mtllib")
}

/// The lines of an OBJ file that say `v` with three numbers or `f` with positive indices in range.
struct Filter<'a> {
    lines: Lines<'a>,
    guard: &'a Guard,
    /// The part of a line that is passed on, and how much of that is consumed.
    kept: Vec<u8>,
    consumed: usize,
    /// `v` lines so far.
    vertices: i64,
    /// Triangles passed on so far.
    triangles: u64,
    /// Triangles of faces left out.
    out_of_range: usize,
    /// The line of the first such face.
    first_out_of_range: Option<String>,
    contents: Contents,
    /// Curves and surfaces that are given by control points.
    free_forms: usize,
    fault: Option<Fault>,
}

impl<'a> Filter<'a> {
    fn new(reader: &'a mut dyn BufRead, guard: &'a Guard) -> Self {
        Self {
            lines: Lines::new(reader),
            guard,
            kept: Vec::new(),
            consumed: 0,
            vertices: 0,
            triangles: 0,
            out_of_range: 0,
            first_out_of_range: None,
            contents: Contents::default(),
            free_forms: 0,
            fault: None,
        }
    }

    /// Puts the part of the next line that is passed on into `kept`; false at the end of the file.
    fn next(&mut self) -> Result<bool, Fault> {
        self.kept.clear();
        self.consumed = 0;
        if !self.lines.next_joined(is_text)? {
            return Ok(false);
        }
        let mut words = self.lines.words();
        match words.next() {
            Some(b"v") => {
                self.lines.check_whole()?;
                self.kept.push(b'v');
                for word in words.take(3) {
                    self.kept.push(b' ');
                    self.kept.extend(word.iter().map(|byte| if byte.is_ascii() { *byte } else { b'?' }));
                }
                self.kept.push(b'\n');
                self.vertices += 1;
            }
            Some(b"f") => {
                self.lines.check_whole()?;
                let (mut corners, mut in_range) = (0, true);
                self.kept.push(b'f');
                for word in words {
                    let index = position_index(word)
                        .ok_or_else(|| self.lines.fault("a face's index is no number"))?;
                    let index = if index < 0 { self.vertices + 1 + index } else { index };
                    in_range &= (1..=self.vertices).contains(&index);
                    corners += 1;
                    self.kept.extend_from_slice(format!(" {index}").as_bytes());
                }
                self.kept.push(b'\n');
                if corners < 3 {
                    self.contents.empty += 1;
                    self.kept.clear();
                } else if in_range {
                    self.triangles += corners as u64 - 2;
                } else {
                    self.out_of_range += corners - 2;
                    self.first_out_of_range.get_or_insert_with(|| self.lines.place());
                    self.kept.clear();
                }
            }
            Some(b"p") => self.contents.points += 1,
            Some(b"l") => self.contents.lines += 1,
            Some(b"o" | b"g") => self.contents.objects += 1,
            Some(b"surf" | b"curv" | b"curv2") => self.free_forms += 1,
            _ => {}
        }
        self.guard.allow((self.vertices as u64 + self.triangles) * HELD)?;
        self.guard.allow_triangles(self.triangles)?;
        Ok(true)
    }
}

/// The first number of `position/texture/normal`, all of which must be numbers where given.
fn position_index(word: &[u8]) -> Option<i64> {
    let mut numbers = std::str::from_utf8(word).ok()?.split('/');
    let position = numbers.next()?.parse::<i32>().ok()?;
    numbers.all(|n| n.is_empty() || n.parse::<i32>().is_ok()).then_some(i64::from(position))
}

impl BufRead for Filter<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.consumed == self.kept.len() {
            match self.next() {
                Ok(true) => {}
                Ok(false) => break,
                Err(fault) => {
                    self.fault = Some(fault);
                    return Err(io::Error::other("stopped by the filter"));
                }
            }
        }
        Ok(self.kept.get(self.consumed..).unwrap_or_default())
    }

    fn consume(&mut self, amount: usize) {
        self.consumed += amount;
    }
}

impl Read for Filter<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(buffer)?;
        self.consume(read);
        Ok(read)
    }
}
