//! STL, binary and ASCII. The format has no indices: each triangle has three vertices of its own. Normals, colours and
//! names are passed over. `stl_io` takes memory by the header's count before it has read a triangle.

use super::error::Fault;
use super::guard::Guard;
use super::lines::{BYTE_ORDER_MARK, Lines, number};
use super::raw_mesh::RawMesh;
use std::io::{BufRead, Cursor, Read};

/// The text before a binary file's triangles, bytes.
const TITLE: usize = 80;
/// A binary triangle: normal, three vertices, two bytes of attributes.
const TRIANGLE: usize = 50;
/// Bytes by which text and binary are told apart.
const HEAD: u64 = 1024;

/// Reads an ASCII file if it begins with `solid` and its first kilobyte is text (titles of binary files begin so, too),
/// else a binary one.
pub(super) fn read<'a>(reader: &mut dyn BufRead, guard: &'a Guard) -> Result<RawMesh<'a>, Fault> {
    let mut head = Vec::new();
    let read = (&mut *reader).take(HEAD).read_to_end(&mut head);
    read.map_err(|error| Fault::new("header", &error.to_string(), Fault::DAMAGED))?;
    let begin = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&head);
    let is_text = begin.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && !head.contains(&0);
    let mut reader = Cursor::new(head).chain(reader);
    if is_text { text(&mut reader, guard) } else { binary(&mut reader, guard) }
}

fn binary<'a>(reader: &mut dyn BufRead, guard: &'a Guard) -> Result<RawMesh<'a>, Fault> {
    let fault = |place: String, error: &std::io::Error| {
        let is_end = error.kind() == std::io::ErrorKind::UnexpectedEof;
        let problem = if is_end { "the data ends here".to_owned() } else { error.to_string() };
        Fault::new(place, &problem, Fault::DAMAGED)
    };
    let mut header = [0; TITLE + 4];
    reader.read_exact(&mut header).map_err(|error| fault("header".into(), &error))?;
    let [.., a, b, c, d] = header;
    let count = u32::from_le_bytes([a, b, c, d]);
    let mut raw = RawMesh::new(guard);
    raw.announce(3 * u64::from(count), u64::from(count))?;
    let mut bytes = [0; TRIANGLE];
    for triangle in 0..count {
        let place = || format!("triangle {triangle} of {count}");
        reader.read_exact(&mut bytes).map_err(|error| fault(place(), &error))?;
        // Behind the normal.
        let mut numbers = bytes.as_chunks().0.iter().skip(3).map(|word| f32::from_le_bytes(*word));
        let mut corner = || std::array::from_fn(|_| numbers.next().unwrap_or_default());
        push(&mut raw, [corner(), corner(), corner()])?;
    }
    raw.contents.objects = 1;
    let place = || "end of the last triangle".to_owned();
    match reader.read(&mut [0]).map_err(|error| fault(place(), &error))? {
        0 => Ok(raw),
        _ => Err(Fault::new(place(), "more data than the header's count announces", Fault::DAMAGED)),
    }
}

/// Reads the facets of all solids.
fn text<'a>(reader: &mut dyn BufRead, guard: &'a Guard) -> Result<RawMesh<'a>, Fault> {
    let mut raw = RawMesh::new(guard);
    let mut lines = Lines::new(reader);
    let (mut corners, mut in_solid) = (Vec::new(), false);
    while lines.next()? {
        let mut words = lines.words();
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        match &keyword[..] {
            b"solid" => {
                raw.contents.objects += 1;
                in_solid = true;
            }
            b"endsolid" => in_solid = false,
            b"vertex" => {
                lines.check_whole()?;
                let mut coordinate = || words.next().and_then(number);
                let (x, y, z) = (coordinate(), coordinate(), coordinate());
                let vertex = x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]);
                corners.push(vertex.ok_or_else(|| lines.fault("a vertex without three numbers"))?);
                if corners.len() > 3 {
                    return Err(lines.fault("a facet of more than three vertices"));
                }
            }
            b"endfacet" => {
                let [a, b, c] = corners[..] else {
                    return Err(lines.fault("a facet of fewer than three vertices"));
                };
                push(&mut raw, [a, b, c])?;
                corners.clear();
            }
            b"facet" | b"outer" | b"endloop" | b"" => {}
            other => {
                let problem =
                    format!("unknown word {}", String::from_utf8_lossy(other.get(..40).unwrap_or(other)));
                return Err(lines.fault(&problem));
            }
        }
    }
    if in_solid || !corners.is_empty() { Err(lines.fault("the data ends here, in a solid")) } else { Ok(raw) }
}

fn push(raw: &mut RawMesh<'_>, corners: [[f32; 3]; 3]) -> Result<(), Fault> {
    // Beyond 2^32 vertices no triangle is accepted anyway.
    let first = u32::try_from(raw.vertices.len()).unwrap_or(RawMesh::NO_VERTEX - 2);
    for corner in corners {
        raw.push_vertex(corner)?;
    }
    Ok(raw.push_triangle([first, first + 1, first + 2])?)
}
