//! Nodes and blocks as bytes: little-endian, each as it lies in memory, with zeros for padding.

#![allow(clippy::indexing_slicing, reason = "all are of `Record::BYTES` bytes")]

use super::{IdBlock, Link, TriangleBlock, WideNode};

/// Something of a fixed number of bytes.
pub trait Record: Sized + Send + Sync {
    /// Bytes of one.
    const BYTES: usize;
    /// Writes it over as many zeros.
    fn put(&self, to: &mut [u8]);
    /// The record in as many bytes.
    fn get(from: &[u8]) -> Self;
}

fn put<'a>(to: &mut [u8], words: impl Iterator<Item = &'a f32>) {
    for (to, word) in to.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *to = word.to_le_bytes();
    }
}

/// Planes of `N` floats one after the other, from word `first` on.
fn planes<const N: usize>(from: &[u8], first: usize) -> [[f32; N]; 3] {
    let words = from.as_chunks::<4>().0;
    std::array::from_fn(|plane| std::array::from_fn(|i| f32::from_le_bytes(words[first + N * plane + i])))
}

impl<const N: usize> Record for WideNode<N> {
    const BYTES: usize = size_of::<Self>();

    #[inline]
    fn put(&self, to: &mut [u8]) {
        put(to, self.lower.as_flattened().iter().chain(self.upper.as_flattened()));
        for (to, link) in to[24 * N..].as_chunks_mut::<4>().0.iter_mut().zip(self.links) {
            *to = link.bits().to_le_bytes();
        }
    }

    #[inline]
    fn get(from: &[u8]) -> Self {
        let links = from[24 * N..].as_chunks::<4>().0;
        Self {
            lower: planes(from, 0),
            upper: planes(from, 3 * N),
            links: std::array::from_fn(|slot| Link::from_bits(u32::from_le_bytes(links[slot]))),
        }
    }
}

impl Record for TriangleBlock {
    const BYTES: usize = size_of::<Self>();

    #[inline]
    fn put(&self, to: &mut [u8]) {
        put(to, [&self.v0, &self.e1, &self.e2].into_iter().flat_map(|planes| planes.as_flattened()));
        for (to, prim) in to[144..].as_chunks_mut::<4>().0.iter_mut().zip(self.prims) {
            *to = prim.to_le_bytes();
        }
    }

    #[inline]
    fn get(from: &[u8]) -> Self {
        let prims = from[144..].as_chunks::<4>().0;
        Self {
            v0: planes(from, 0),
            e1: planes(from, 12),
            e2: planes(from, 24),
            prims: std::array::from_fn(|lane| u32::from_le_bytes(prims[lane])),
        }
    }
}

impl Record for IdBlock {
    const BYTES: usize = size_of::<Self>();

    #[inline]
    fn put(&self, to: &mut [u8]) {
        for (to, prim) in to.as_chunks_mut::<4>().0.iter_mut().zip(self.prims) {
            *to = prim.to_le_bytes();
        }
    }

    #[inline]
    fn get(from: &[u8]) -> Self {
        let prims = from.as_chunks::<4>().0;
        Self { prims: std::array::from_fn(|lane| u32::from_le_bytes(prims[lane])) }
    }
}
