//! A name for the geometry: a 64-bit hash of vertices and triangles, the same on every platform and at
//! any number of threads. It tells meshes apart in records; it is no defence against forgery.

use super::Mesh;
use crate::random::{GOLDEN, mix};
use rayon::prelude::*;

/// Triples that are hashed one after the other.
const CHUNK: usize = 1 << 16;
/// Chunks that a task hashes side by side, for each word has to wait for the one before it in its chunk.
const ABREAST: usize = 4;

impl Mesh {
    /// A hash of the vertices' bits, those in no triangle too, and of the triangles, in their order: the number by
    /// which a saved tree names its mesh ([`Header::mesh`](crate::bvh::saved::Header::mesh)). Computed anew at each
    /// call, on the current rayon pool.
    ///
    /// Vertices and then triangles are cut into chunks of 2^16 triples; a chunk is hashed by rotate, xor and multiply
    /// over 64-bit words, and the chunks' hashes in turn.
    pub fn fingerprint(&self) -> u64 {
        let vertices =
            self.vertices().par_chunks(ABREAST * CHUNK).flat_map_iter(|v| chunks(v, |v| v.map(f32::to_bits)));
        let triangles = self.triangles().par_chunks(ABREAST * CHUNK).flat_map_iter(|t| chunks(t, |t| *t));
        let hashes: Vec<u64> = vertices.chain(triangles).collect();
        let counts = [self.vertices().len() as u64, self.len() as u64];
        mix(counts.into_iter().chain(hashes).fold(0, step))
    }
}

/// The hashes of [`ABREAST`] chunks, or of those that are left.
fn chunks<T>(triples: &[T], bits: impl Fn(&T) -> [u32; 3]) -> impl Iterator<Item = u64> {
    let mut chunks = triples.chunks(CHUNK);
    let chunks: [&[T]; ABREAST] = std::array::from_fn(|_| chunks.next().unwrap_or_default());
    let mut hashes = [0; ABREAST];
    for i in 0..chunks[0].len() {
        for (hash, chunk) in hashes.iter_mut().zip(chunks) {
            if let Some([a, b, c]) = chunk.get(i).map(&bits) {
                *hash = step(step(*hash, u64::from(a) | u64::from(b) << 32), u64::from(c));
            }
        }
    }
    hashes.into_iter().map(mix).take(triples.len().div_ceil(CHUNK))
}

#[inline]
fn step(hash: u64, word: u64) -> u64 {
    (hash.rotate_left(29) ^ word).wrapping_mul(GOLDEN)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hash(vertices: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> u64 {
        Mesh::new(vertices, triangles).unwrap().0.fingerprint()
    }

    /// Of one chunk, of some, and of more than are hashed side by side.
    #[test]
    fn chunks_are_hashed_by_themselves() {
        for len in [0, 1, CHUNK, CHUNK + 1, ABREAST * CHUNK, (ABREAST + 1) * CHUNK + 7] {
            let triples: Vec<[u32; 3]> = (0..len as u32).map(|i| [i, 3 * i, i ^ 77]).collect();
            let one = |chunk: &[[u32; 3]]| {
                let words =
                    chunk.iter().flat_map(|&[a, b, c]| [u64::from(a) | u64::from(b) << 32, u64::from(c)]);
                mix(words.fold(0, step))
            };
            let expected: Vec<u64> = triples.chunks(CHUNK).map(one).collect();
            let found: Vec<u64> = triples.chunks(ABREAST * CHUNK).flat_map(|t| chunks(t, |t| *t)).collect();
            assert_eq!(found, expected, "{len} triples");
        }
    }

    #[test]
    fn any_change_is_seen() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let same = hash(vertices.clone(), vec![[0, 1, 2]]);
        assert_eq!(same, hash(vertices.clone(), vec![[0, 1, 2]]));
        // By it trees that were saved before find their mesh.
        assert_eq!(same, 0x084a_1a3f_45bb_4a6e);
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
