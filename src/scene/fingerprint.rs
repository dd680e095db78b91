//! A name for the geometry: a 64-bit hash of vertices and triangles, the same on every platform and at
//! any number of threads. It tells meshes apart in records; it is no defence against forgery.

use crate::geometry::Mesh;
use crate::random::{GOLDEN, mix};
use rayon::prelude::*;

/// Triples hashed by one task.
const CHUNK: usize = 1 << 16;

/// 16 hex digits. The vertices' bits and then the triangles, each in chunks of 2^16 triples; a chunk is
/// hashed by rotate, xor and multiply over 64-bit words, and the chunks' hashes in turn.
pub fn of(mesh: &Mesh) -> String {
    format!("{:016x}", value(mesh))
}

/// The same as a number.
pub(crate) fn value(mesh: &Mesh) -> u64 {
    let vertices = mesh.vertices().par_chunks(CHUNK).map(|c| chunk(c.iter().map(|v| v.map(f32::to_bits))));
    let triangles = mesh.triangles().par_chunks(CHUNK).map(|c| chunk(c.iter().copied()));
    let hashes: Vec<u64> = vertices.chain(triangles).collect();
    let counts = [mesh.vertices().len() as u64, mesh.len() as u64];
    mix(counts.into_iter().chain(hashes).fold(0, step))
}

fn chunk(triples: impl Iterator<Item = [u32; 3]>) -> u64 {
    mix(triples.fold(0, |hash, [a, b, c]| step(step(hash, u64::from(a) | u64::from(b) << 32), u64::from(c))))
}

#[inline]
fn step(hash: u64, word: u64) -> u64 {
    (hash.rotate_left(29) ^ word).wrapping_mul(GOLDEN)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hash(vertices: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> String {
        of(&Mesh::new(vertices, triangles).unwrap().0)
    }

    #[test]
    fn any_change_is_seen() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let same = hash(vertices.clone(), vec![[0, 1, 2]]);
        assert_eq!(same, hash(vertices.clone(), vec![[0, 1, 2]]));
        assert_eq!(same.len(), 16);
        let mut moved = vertices.clone();
        moved[2][1] = 1.000_000_1;
        let others = [
            hash(vertices.clone(), vec![[0, 2, 1]]),
            hash(vertices.clone(), vec![[0, 1, 3]]),
            hash(vertices.clone(), vec![[0, 1, 2], [0, 1, 2]]),
            hash(vertices[..3].to_vec(), vec![[0, 1, 2]]),
            hash(moved, vec![[0, 1, 2]]),
        ];
        for (i, other) in others.iter().enumerate() {
            assert_ne!(*other, same, "change {i}");
            assert!(!others[..i].contains(other), "change {i}");
        }
    }
}
