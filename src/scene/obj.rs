//! OBJ through `tobj`, behind a filter that passes on positions and faces only.
//!
//! The filter keeps the line number, which `tobj`'s errors lack. It drops and counts faces whose indices are out of
//! range, where `tobj` would stop. It drops texture coordinates, normals, materials, groups and names, which need not
//! be UTF-8, so that all objects become one mesh with shared vertices.

use super::error::Fault;
use super::raw_mesh::RawMesh;
use std::io::{self, BufRead, Read};

/// Reads `v` and `f` lines; indices may be negative (counted back from the last vertex given before).
pub(super) fn read(reader: &mut dyn BufRead) -> Result<RawMesh, Fault> {
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..tobj::LoadOptions::default() };
    let mut filter = Filter::new(reader);
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let loaded = tobj::load_obj_buf(&mut filter, &options, no_materials);
    let place = format!("line {}", filter.line_number);
    let (models, _) = loaded.map_err(|e| match filter.fault.take() {
        Some(fault) => fault,
        None => Fault::new(place, &e.to_string(), Fault::DAMAGED),
    })?;

    let mut raw = RawMesh { vertices: Vec::new(), triangles: Vec::new(), out_of_range: filter.out_of_range };
    for tobj::Model { mesh, .. } in models {
        let first = raw.vertices.len() as u32;
        raw.vertices.extend_from_slice(mesh.positions.as_chunks().0);
        raw.triangles.extend(mesh.indices.as_chunks().0.iter().map(|t: &[u32; 3]| t.map(|i| first + i)));
    }
    Ok(raw)
}

/// The lines of an OBJ file that say `v` with three numbers or `f` with positive indices in range.
struct Filter<'a> {
    inner: &'a mut dyn BufRead,
    /// The line as read.
    line: Vec<u8>,
    /// The part of it that is passed on, and how much of that is consumed.
    kept: Vec<u8>,
    consumed: usize,
    /// From 1.
    line_number: usize,
    /// `v` lines so far.
    vertices: i64,
    /// Triangles of faces left out.
    out_of_range: usize,
    fault: Option<Fault>,
}

impl<'a> Filter<'a> {
    fn new(inner: &'a mut dyn BufRead) -> Self {
        Self {
            inner,
            line: Vec::new(),
            kept: Vec::new(),
            consumed: 0,
            line_number: 0,
            vertices: 0,
            out_of_range: 0,
            fault: None,
        }
    }

    /// Reads a line with its continuation lines (backslash at the end); false at the end of the file.
    fn next_line(&mut self) -> io::Result<bool> {
        self.line.clear();
        loop {
            if self.inner.read_until(b'\n', &mut self.line)? == 0 {
                return Ok(!self.line.is_empty());
            }
            self.line_number += 1;
            let end = self.line.trim_ascii_end().len();
            if end == 0 || self.line[end - 1] != b'\\' {
                return Ok(true);
            }
            self.line.truncate(end - 1);
            self.line.push(b' ');
        }
    }

    /// Puts the part of the line that is passed on into `kept`.
    fn filter_line(&mut self) -> Result<(), &'static str> {
        let Self { line, kept, vertices, out_of_range, .. } = self;
        kept.clear();
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                kept.push(b'v');
                for word in words.take(3) {
                    kept.push(b' ');
                    kept.extend(word.iter().map(|byte| if byte.is_ascii() { *byte } else { b'?' }));
                }
                kept.push(b'\n');
                *vertices += 1;
            }
            Some(b"f") => {
                let (mut corners, mut in_range) = (0, true);
                kept.push(b'f');
                for word in words {
                    let index = position_index(word).ok_or("a face's index is no number")?;
                    let index = if index < 0 { *vertices + 1 + index } else { index };
                    in_range &= (1..=*vertices).contains(&index);
                    corners += 1;
                    kept.extend_from_slice(format!(" {index}").as_bytes());
                }
                kept.push(b'\n');
                if corners < 3 {
                    return Err("a face with fewer than three vertices");
                }
                if !in_range {
                    *out_of_range += corners - 2;
                    kept.clear();
                }
            }
            _ => {}
        }
        Ok(())
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
            self.consumed = 0;
            self.kept.clear();
            let result = match self.next_line() {
                Ok(false) => break,
                Ok(true) => self.filter_line().map_err(ToOwned::to_owned),
                Err(e) => Err(e.to_string()),
            };
            if let Err(problem) = result {
                let place = format!("line {}", self.line_number);
                self.fault = Some(Fault::new(place, &problem, Fault::DAMAGED));
                return Err(io::Error::other(problem));
            }
        }
        Ok(&self.kept[self.consumed..])
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
