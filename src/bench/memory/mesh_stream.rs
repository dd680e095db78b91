//! A mesh from one process to another: the numbers of vertices and triangles, then both, little endian. What is
//! read lies in memory of the right size, and loading leaves nothing behind.

use crate::geometry::Mesh;
use std::io::{BufReader, BufWriter, Read, Write};

/// Writes `mesh`.
///
/// # Errors
/// Those of `output`.
pub fn write(mesh: &Mesh, output: impl Write) -> std::io::Result<()> {
    let mut output = BufWriter::with_capacity(1 << 20, output);
    for len in [mesh.vertices().len(), mesh.len()] {
        output.write_all(&(len as u64).to_le_bytes())?;
    }
    for x in mesh.vertices().iter().flatten() {
        output.write_all(&x.to_le_bytes())?;
    }
    for i in mesh.triangles().iter().flatten() {
        output.write_all(&i.to_le_bytes())?;
    }
    output.flush()
}

/// Reads a mesh.
///
/// # Errors
/// One line: an end too early, or no mesh.
pub fn read(input: impl Read) -> Result<Mesh, String> {
    let mut input = BufReader::with_capacity(1 << 20, input);
    let mut read = || -> std::io::Result<_> {
        let (vertices, triangles) =
            (u64::from_le_bytes(next(&mut input)?), u64::from_le_bytes(next(&mut input)?));
        if vertices > u64::from(u32::MAX) || triangles > Mesh::MAX_TRIANGLES as u64 {
            return Err(std::io::Error::other("too many vertices or triangles"));
        }
        // One more, which a mesh appends.
        let mut points = Vec::with_capacity(vertices as usize + 1);
        for _ in 0..vertices {
            points.push(three(&mut input, f32::from_le_bytes)?);
        }
        let mut indices = Vec::with_capacity(triangles as usize);
        for _ in 0..triangles {
            indices.push(three(&mut input, u32::from_le_bytes)?);
        }
        Ok((points, indices))
    };
    let (vertices, triangles) = read().map_err(|error| format!("standard input: {error}; give a mesh"))?;
    Mesh::new(vertices, triangles).map(|(mesh, _)| mesh).map_err(|error| error.to_string())
}

fn next<const N: usize>(input: &mut impl Read) -> std::io::Result<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}

fn three<T: Default + Copy>(input: &mut impl Read, of: fn([u8; 4]) -> T) -> std::io::Result<[T; 3]> {
    let mut values = [T::default(); 3];
    for value in &mut values {
        *value = of(next(input)?);
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_arrive_as_they_were_sent() {
        let vertices = vec![[-0.0, 1.5, 1e-38], [2.0, 3.0, 1e18], [0.0; 3], [1.0; 3]];
        let (mesh, _) = Mesh::new(vertices, vec![[0, 1, 2], [3, 1, 0]]).unwrap();
        let mut bytes = Vec::new();
        write(&mesh, &mut bytes).unwrap();
        let read_again = read(&bytes[..]).unwrap();
        assert_eq!((read_again.vertices(), read_again.triangles()), (mesh.vertices(), mesh.triangles()));
        assert!(read(&bytes[..bytes.len() - 1]).unwrap_err().contains("standard input"));
        assert!(read(&[255; 16][..]).is_err());
    }
}
