//! A mesh from one process to another: the numbers of vertices and triangles, then both, little endian. What is
//! read lies in memory of the right size, and loading leaves nothing behind.

use crate::geometry::Mesh;
use crate::memory::huge_pages;
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
/// One line: an end too early, no mesh, or no memory for as much as is announced.
pub fn read(input: impl Read) -> Result<Mesh, String> {
    let mut input = BufReader::with_capacity(1 << 20, input);
    let mut len = || next(&mut input).map(u64::from_le_bytes).map_err(wrong);
    let (vertices, triangles) = (len()?, len()?);
    if vertices > u64::from(u32::MAX) || triangles > Mesh::MAX_TRIANGLES as u64 {
        return Err(wrong(std::io::Error::other("too many vertices or triangles")));
    }
    let vertices = list(&mut input, vertices, f32::from_le_bytes, "vertices")?;
    let triangles = list(&mut input, triangles, u32::from_le_bytes, "triangles")?;
    Mesh::new(vertices, triangles).map(|(mesh, _)| mesh).map_err(|error| error.to_string())
}

fn wrong(error: std::io::Error) -> String {
    format!("standard input: {error}; give a mesh")
}

/// So many threes, with room for one more: a mesh appends a vertex.
fn list<T: Default + Copy>(
    input: &mut impl Read,
    len: u64,
    of: fn([u8; 4]) -> T,
    what: &'static str,
) -> Result<Vec<[T; 3]>, String> {
    let mut list = Vec::new();
    huge_pages::try_reserve(&mut list, len as usize + 1, what).map_err(|error| error.to_string())?;
    for _ in 0..len {
        list.push(three(input, of).map_err(wrong)?);
    }
    Ok(list)
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
        // As much as may be announced: there is no memory for that, or it ends too early.
        let most = [u64::from(u32::MAX), Mesh::MAX_TRIANGLES as u64].map(u64::to_le_bytes);
        assert_eq!(read(most.as_flattened()).unwrap_err().lines().count(), 1);
    }
}
