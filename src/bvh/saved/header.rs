//! The first 128 bytes of a saved tree.

#![allow(clippy::indexing_slicing, reason = "places in an array of fixed length, none of them from a file")]

use crate::bvh::limits::MAX_REFERENCES_PER_TRIANGLE;
use crate::bvh::{Link, MAX_DEPTH};
use crate::geometry::Aabb;
use crate::random::{GOLDEN, mix};
use glam::Vec3A;

/// Bytes of a header.
pub(super) const BYTES: usize = 128;
/// How every saved tree begins.
pub(super) const MAGIC: [u8; 8] = *b"PHRTREE\0";
const VERSION: u32 = 2;
/// Bytes of a builder's name.
const NAME: usize = 32;

/// What a file says of its tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Children per node.
    pub width: u32,
    /// The root.
    pub root: Link,
    /// Inner nodes.
    pub nodes: u64,
    /// Leaf blocks.
    pub blocks: u64,
    /// Box of everything.
    pub bounds: Aabb,
    /// [`Mesh::fingerprint`](crate::geometry::Mesh::fingerprint) of the mesh: by it the mesh of a file can be looked
    /// for.
    pub mesh: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Checksum of nodes and blocks.
    pub checksum: u64,
    /// Name of the builder, 32 bytes of it at most.
    pub builder: String,
}

/// Whether so many nodes and blocks are of a tree over so many triangles: builders make no more than
/// [`MAX_REFERENCES_PER_TRIANGLE`] leaves for each, nor do nodes lie deeper than [`MAX_DEPTH`].
pub(super) fn can_be_loaded(nodes: u64, blocks: u64, triangles: u64) -> bool {
    let most = triangles.saturating_mul(MAX_REFERENCES_PER_TRIANGLE as u64);
    blocks <= most && nodes <= most.saturating_mul(MAX_DEPTH as u64)
}

impl Header {
    pub(super) fn to_bytes(&self) -> [u8; BYTES] {
        let mut bytes = [0; BYTES];
        let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
        put(0, &MAGIC);
        put(8, &VERSION.to_le_bytes());
        put(12, &self.width.to_le_bytes());
        put(16, &self.root.bits().to_le_bytes());
        put(24, &self.nodes.to_le_bytes());
        put(32, &self.blocks.to_le_bytes());
        for (i, x) in self.bounds.min.to_array().into_iter().chain(self.bounds.max.to_array()).enumerate() {
            put(40 + 4 * i, &x.to_le_bytes());
        }
        put(64, &self.mesh.to_le_bytes());
        put(72, &self.triangles.to_le_bytes());
        put(80, &self.checksum.to_le_bytes());
        let mut end = self.builder.len().min(NAME);
        while !self.builder.is_char_boundary(end) {
            end -= 1;
        }
        put(96, &self.builder.as_bytes()[..end]);
        let own = own_checksum(&bytes);
        bytes[88..96].copy_from_slice(&own.to_le_bytes());
        bytes
    }

    /// The header after [`MAGIC`], or what is wrong with it.
    pub(super) fn of_bytes(bytes: &[u8; BYTES]) -> Result<Self, String> {
        let u32_at = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        let u64_at = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        if u32_at(8) != VERSION {
            return Err(format!("version {}, this program reads {VERSION}", u32_at(8)));
        }
        if u64_at(88) != own_checksum(bytes) {
            return Err("a damaged header".into());
        }
        let corner =
            |at: usize| Vec3A::from_array(std::array::from_fn(|axis| f32::from_bits(u32_at(at + 4 * axis))));
        let name = bytes[96..].split(|byte| *byte == 0).next().unwrap_or_default();
        Ok(Self {
            width: u32_at(12),
            root: Link::from_bits(u32_at(16)),
            nodes: u64_at(24),
            blocks: u64_at(32),
            bounds: Aabb::new(corner(40), corner(52)),
            mesh: u64_at(64),
            triangles: u64_at(72),
            checksum: u64_at(80),
            builder: String::from_utf8_lossy(name).into_owned(),
        })
    }
}

/// Of all of a header but itself.
fn own_checksum(bytes: &[u8; BYTES]) -> u64 {
    checksum(&bytes[..88]) ^ checksum(&bytes[96..]).rotate_left(1)
}

/// Of bytes, filled up with zeros. Four sums, for each word has to wait for the one before it in its sum.
pub(super) fn checksum(bytes: &[u8]) -> u64 {
    // What is made up must get past it, to what checks the links.
    if cfg!(phr_fuzzing) {
        return 0;
    }
    let (rows, rest) = bytes.as_chunks::<32>();
    let mut last = [0; 32];
    last[..rest.len()].copy_from_slice(rest);
    let mut sums = [bytes.len() as u64, 1, 2, 3];
    for row in rows.iter().chain([&last]) {
        for (sum, word) in sums.iter_mut().zip(row.as_chunks::<8>().0) {
            *sum = step(*sum, u64::from_le_bytes(*word));
        }
    }
    mix(sums.into_iter().fold(0, step))
}

/// `sum` with another word.
pub(super) fn step(sum: u64, word: u64) -> u64 {
    (sum.rotate_left(29) ^ word).wrapping_mul(GOLDEN)
}
