//! A tree as bytes, for the buffers of a graphics processor.

use super::WideBvh;
use super::record::Record;
use crate::memory::{OutOfMemory, catch_out_of_memory, huge_pages};
use rayon::prelude::*;

/// Records converted by a task.
const CHUNK: usize = 1 << 12;

impl<const N: usize, B: Record> WideBvh<N, B> {
    /// The nodes, little-endian, 128 bytes each in 4-wide trees and 256 in 8-wide ones: lower planes of the
    /// children's boxes (all x, all y, all z), upper planes likewise, links, and zeros.
    ///
    /// ```
    /// let tree = phr::builders::by_name::<4>("lbvh").unwrap().build(&phr::scene::scalable(1000, 1).mesh).tree;
    /// let bytes = tree.node_bytes();
    /// assert_eq!(bytes.len(), 128 * tree.nodes.len());
    /// assert_eq!(bytes[..4], tree.nodes[0].lower[0][0].to_le_bytes());
    /// assert_eq!(bytes[96..100], tree.nodes[0].links[0].bits().to_le_bytes());
    /// ```
    pub fn node_bytes(&self) -> Vec<u8> {
        bytes(&self.nodes)
    }

    /// The same where memory may not suffice.
    ///
    /// # Errors
    /// No memory for the bytes.
    pub fn try_node_bytes(&self) -> Result<Vec<u8>, OutOfMemory> {
        catch_out_of_memory(|| self.node_bytes())
    }

    /// The leaf blocks, little-endian. Of triangles, 160 bytes each: first corners, these less the second ones, the
    /// third ones less the first (each as all x, all y, all z of four triangles), and the triangles; of other
    /// primitives, 16 bytes: their numbers.
    pub fn block_bytes(&self) -> Vec<u8> {
        bytes(&self.blocks)
    }

    /// The same where memory may not suffice.
    ///
    /// # Errors
    /// As of [`WideBvh::try_node_bytes`].
    pub fn try_block_bytes(&self) -> Result<Vec<u8>, OutOfMemory> {
        catch_out_of_memory(|| self.block_bytes())
    }
}

fn bytes<R: Record>(records: &[R]) -> Vec<u8> {
    let mut bytes = huge_pages::filled(records.len() * R::BYTES, 0u8, "a tree's bytes");
    records.par_chunks(CHUNK).zip(bytes.par_chunks_mut(CHUNK * R::BYTES)).for_each(|(records, bytes)| {
        records.iter().zip(bytes.chunks_mut(R::BYTES)).for_each(|(record, to)| record.put(to));
    });
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{IdBlock, Link, TriangleBlock, WideNode};
    use crate::geometry::Aabb;
    use glam::Vec3A;

    #[test]
    fn bytes_are_those_in_memory_and_read_back() {
        let mut node = WideNode::<8>::EMPTY;
        node.set(3, Aabb::new(Vec3A::ZERO, Vec3A::ONE), Link::leaf(5, 2));
        let mut block = TriangleBlock::EMPTY;
        block.set(1, [Vec3A::X, Vec3A::Y, Vec3A::Z], 7);
        let ids = IdBlock::of_first(3, [9, 8, 7, 6]);
        let nodes = bytes(&[WideNode::<8>::EMPTY, node]);
        assert_eq!((nodes.len(), WideNode::<8>::get(&nodes[256..])), (512, node));
        assert_eq!(TriangleBlock::get(&bytes(&[block])), block);
        assert_eq!(IdBlock::get(&bytes(&[ids])), ids);
        assert_eq!(bytes(&[ids])[12..], [0xff; 4]);
    }
}
