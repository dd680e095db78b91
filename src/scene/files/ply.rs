//! PLY, binary in both byte orders and ASCII, through the crate `serde-ply`.
//!
//! Faces are not collected as lists but fanned into triangles as they stream by: 9.4 M triangles with
//! 5.3 M vertices (185 MB, zstd) load in about two seconds on one core of a Zen 3, half of it decompression.

use super::error::Fault;
use super::guard::Guard;
use super::ply_header;
use super::ply_rows::{INDEX_LISTS, Skipped, Triangles, Vertices, explain, take};
use super::raw_mesh::RawMesh;
use serde_ply::{ElementDef, PlyFormat, PlyReader, PropertyType};
use std::cell::Cell;
use std::io::{self, BufRead, Read};

/// Reads the elements `vertex` and `face`; other elements and properties are skipped.
pub(super) fn read<'a>(reader: &mut dyn BufRead, guard: &'a Guard) -> Result<RawMesh<'a>, Fault> {
    let ascii = Cell::new(false);
    let header = io::Cursor::new(ply_header::take(reader)?);
    let mut input = Terminated { header, inner: reader, ascii: &ascii, ended: false, word: 0 };
    let mut ply = PlyReader::from_reader(&mut input).map_err(|e| {
        Fault::new("header", &explain(&e.0.to_string()), "this is no PLY file or its header is damaged")
    })?;
    ascii.set(ply.header().format == PlyFormat::Ascii);
    for name in ["vertex", "face"] {
        check_header(&ply.header().elem_defs, name)?;
    }

    let mut raw = RawMesh::new(guard);
    raw.contents.objects = 1;
    let count =
        |name: &str| ply.header().elem_defs.iter().find(|e| e.name == name).map_or(0, |e| e.count as u64);
    // A face has no triangle or many: its own size is not told.
    raw.announce(count("vertex"), 0)?;
    while let Some(element) = ply.current_element() {
        let (name, count) = (element.name.clone(), element.count);
        if element.properties.is_empty() && count > 0 {
            return Err(Fault::new(format!("header, element {name}"), "no property", Fault::DAMAGED));
        }
        if name == "edge" {
            raw.contents.lines = raw.contents.lines.saturating_add(count);
        }
        let stopped = match name.as_str() {
            "vertex" => take(&mut ply, Vertices(&mut raw)),
            "face" => take(&mut ply, Triangles(&mut raw)),
            _ => {
                if name != "edge" && count > 0 {
                    raw.contents.remarks.push(format!("{count} entries of the element {name} are not read"));
                }
                take(&mut ply, Skipped)
            }
        }
        .map_err(|e| Fault::new(format!("element {name}"), &e, Fault::DAMAGED))?;
        if let Some((row, why)) = stopped {
            return Err(Fault::new(format!("{name} {row} of {count}"), &explain(&why), Fault::DAMAGED));
        }
    }
    drop(ply);
    check_end(&mut input, ascii.get())?;
    Ok(raw)
}

/// One `vertex` with scalars x, y, z and one `face` with a list of vertices.
fn check_header(elements: &[ElementDef], name: &'static str) -> Result<(), Fault> {
    const REMEDY: &str = "export the scene as a mesh of vertices and faces";
    let fault = |problem: &str| Fault::new(format!("header, element {name}"), problem, REMEDY);
    let mut named = elements.iter().filter(|e| e.name == name);
    let element = named.next().ok_or_else(|| fault("missing"))?;
    if named.next().is_some() {
        return Err(fault("given twice"));
    }
    let list = |name: &&str| {
        element.get_property(name).is_some_and(|p| matches!(p.property_type, PropertyType::List { .. }))
    };
    let scalar = |name: &&str| {
        element.get_property(name).is_some_and(|p| matches!(p.property_type, PropertyType::Scalar(_)))
    };
    match name {
        "vertex" if !["x", "y", "z"].iter().all(scalar) => Err(fault("no properties x, y and z")),
        "face" if !INDEX_LISTS.iter().any(list) => Err(fault("no list vertex_indices")),
        _ => Ok(()),
    }
}

/// Refuses data after the last element: geometry that the header does not announce.
fn check_end(input: &mut impl Read, ascii: bool) -> Result<(), Fault> {
    let fault = |problem: &str| Err(Fault::new("end of the last element", problem, Fault::DAMAGED));
    let mut byte = [0];
    loop {
        match input.read(&mut byte) {
            Ok(0) => return Ok(()),
            Ok(_) if ascii && byte[0].is_ascii_whitespace() => {}
            Ok(_) => return fault("more data than the header's counts announce"),
            Err(e) => return fault(&e.to_string()),
        }
    }
}

/// The header and then the data. `serde-ply` expects white space after the last ASCII token; files may lack it, so
/// a line break is added. It holds an ASCII token whole, so a word without end is refused.
struct Terminated<'a> {
    header: io::Cursor<Vec<u8>>,
    inner: &'a mut dyn BufRead,
    ascii: &'a Cell<bool>,
    ended: bool,
    /// Bytes since the last white space.
    word: usize,
}

impl Terminated<'_> {
    /// Bytes of a number, by far.
    const LONGEST_WORD: usize = 1 << 10;

    fn is_past_header(&self) -> bool {
        self.header.position() == self.header.get_ref().len() as u64
    }
}

impl Read for Terminated<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if !self.is_past_header() {
            return self.header.read(buffer);
        }
        let read = self.inner.read(buffer)?;
        match buffer.first_mut() {
            Some(first) if read == 0 && self.ascii.get() && !self.ended => {
                self.ended = true;
                *first = b'\n';
                Ok(1)
            }
            _ => Ok(read),
        }
    }

    fn read_exact(&mut self, buffer: &mut [u8]) -> io::Result<()> {
        if !self.ascii.get() && self.is_past_header() {
            return self.inner.read_exact(buffer);
        }
        let mut filled = 0;
        while let Some(rest @ [_, ..]) = buffer.get_mut(filled..) {
            match self.read(rest)? {
                0 => return Err(io::ErrorKind::UnexpectedEof.into()),
                read => filled += read,
            }
        }
        // Tokens are read byte by byte.
        self.word = if buffer.iter().any(u8::is_ascii_whitespace) { 0 } else { self.word + filled };
        if self.word > Self::LONGEST_WORD {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a word of more than a kilobyte"));
        }
        Ok(())
    }
}

impl BufRead for Terminated<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.is_past_header() { self.inner.fill_buf() } else { self.header.fill_buf() }
    }

    fn consume(&mut self, amount: usize) {
        if self.is_past_header() {
            self.inner.consume(amount);
        } else {
            self.header.consume(amount);
        }
    }
}
