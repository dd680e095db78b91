//! OBJ: positions and faces.
//!
//! Texture coordinates, normals, materials and names are passed over, and need not be UTF-8, so that all objects become
//! one mesh with shared vertices. No crate reads it: those there are hold several times the mesh, without a bound.

use super::error::Fault;
use super::guard::Guard;
use super::lines::{Lines, number};
use super::raw_mesh::RawMesh;
use std::io::BufRead;

/// Reads `v` and `f` lines; indices may be negative (counted back from the last vertex given before). Faces with an index
/// out of range are left out and counted; points, lines, objects and groups are counted.
pub(super) fn read<'a>(reader: &mut dyn BufRead, guard: &'a Guard) -> Result<RawMesh<'a>, Fault> {
    let mut raw = RawMesh::new(guard);
    let mut lines = Lines::new(reader);
    let mut corners = Vec::new();
    while lines.next(true)? {
        let mut words = lines.words();
        match words.next() {
            Some(b"v") => {
                lines.check_whole()?;
                let mut coordinate = || words.next().and_then(number);
                let (x, y, z) = (coordinate(), coordinate(), coordinate());
                let vertex = x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]);
                raw.push_vertex(vertex.ok_or_else(|| lines.fault("position parse error"))?)?;
            }
            Some(b"f") => {
                lines.check_whole()?;
                corners.clear();
                let vertices = raw.vertices.len() as i64;
                for word in words {
                    let index =
                        position_index(word).ok_or_else(|| lines.fault("a face's index is no number"))?;
                    let index = if index < 0 { vertices + index } else { index - 1 };
                    corners.push((0..vertices).contains(&index).then_some(index as u32));
                }
                if corners.len() < 3 {
                    return Err(lines.fault("a face with fewer than three vertices"));
                }
                push_fan(&mut raw, &corners)?;
            }
            Some(b"p") => raw.contents.points += 1,
            Some(b"l") => raw.contents.lines += 1,
            Some(b"o" | b"g") => raw.contents.objects += 1,
            _ => {}
        }
    }
    raw.contents.objects = raw.contents.objects.max(1);
    Ok(raw)
}

/// The triangles of a face around its first corner; none if a corner is out of range.
fn push_fan(raw: &mut RawMesh<'_>, corners: &[Option<u32>]) -> Result<(), Fault> {
    if corners.contains(&None) {
        raw.out_of_range += corners.len() - 2;
        return Ok(());
    }
    let mut corners = corners.iter().flatten();
    if let (Some(&first), Some(&second)) = (corners.next(), corners.next()) {
        let mut previous = second;
        for &corner in corners {
            raw.push_triangle([first, previous, corner])?;
            previous = corner;
        }
    }
    Ok(())
}

/// The first number of `position/texture/normal`, all of which must be numbers where given.
fn position_index(word: &[u8]) -> Option<i64> {
    let mut numbers = std::str::from_utf8(word).ok()?.split('/');
    let position = numbers.next()?.parse::<i32>().ok()?;
    numbers.all(|n| n.is_empty() || n.parse::<i32>().is_ok()).then_some(i64::from(position))
}
