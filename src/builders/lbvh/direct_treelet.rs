//! The LBVH over a run of sorted codes that fits the cache, made wide at once. As [`crate::builders::lbvh::treelet`], for trees whose
//! leaves are quartets and that nobody opens: corners are fetched but once, for leaf blocks and boxes together.

#![allow(unsafe_code)]

use crate::builders::lbvh::cartesian::Waiting;
use crate::builders::lbvh::deltas::Heights;
use crate::builders::lbvh::equal_codes::SameCode;
use crate::builders::lbvh::prefetch;
use crate::builders::lbvh::sort::{Key, reference};
use crate::builders::wide::branchless::{Slot, Widen};
use crate::builders::wide::top_down::QUARTET;
use crate::builders::wide::treelet::{Piece, Subtree};
use crate::bvh::TriangleBlock;
use crate::geometry::{Aabb, Mesh};

/// Memory of a task that builds the subtree over one run.
#[derive(Default)]
pub(crate) struct WideRun {
    /// Corners of the references' triangles, as indices, and the triangles.
    triangles: Vec<[u32; 4]>,
    copied_triangles: Vec<[u32; 4]>,
    heights: Heights,
    same_code: SameCode,
    /// Where the leaves begin, and where the last ends.
    leaves: Vec<u32>,
    /// The leaves.
    slots: Vec<Slot>,
    widen: Widen,
}

impl WideRun {
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        (self.triangles.capacity() + self.copied_triangles.capacity()) * size_of::<[u32; 4]>()
            + self.heights.bytes()
            + self.same_code.bytes()
            + self.leaves.capacity() * size_of::<u32>()
            + self.slots.capacity() * size_of::<Slot>()
            + self.widen.bytes()
    }

    /// Number of inner nodes of the binary tree.
    pub fn pairs(&self) -> usize {
        self.widen.pairs.len()
    }

    /// Builds the subtree over `keys`, whole triangles of `mesh`, which have been parted by the middle `depth` times.
    pub fn build(&mut self, mesh: &Mesh, keys: &[Key], depth: u32, piece: &mut Piece) -> Subtree {
        self.triangles.clear();
        self.triangles.extend(keys.iter().enumerate().map(|(i, &key)| {
            prefetch::indices(mesh, keys, i);
            let prim = reference(key);
            let [a, b, c] = mesh.triangles()[prim as usize];
            prefetch::corners(mesh, [a, b, c]);
            [a, b, c, prim]
        }));
        self.heights.of_codes(keys);
        self.part_equal_codes(mesh, depth);
        self.heights.leaves(QUARTET, &mut self.leaves);
        self.blocks(mesh, piece);
        let root = self.unite();
        Some((root.bounds(), self.widen.write(&root, &mut piece.nodes)))
    }

    fn part_equal_codes(&mut self, mesh: &Mesh, depth: u32) {
        let Self { triangles, copied_triangles, heights, same_code, .. } = self;
        same_code.begin(triangles.len());
        let mut begin = 0;
        while let Some(equal) = heights.equal_codes(begin) {
            begin = equal.end;
            if equal.len() > QUARTET as usize {
                let center =
                    |&[a, b, c, _]: &[u32; 4]| Aabb::of_triangle(mesh.corners_of(&[a, b, c])).center2();
                same_code.add(equal.clone(), triangles[equal].iter().map(center));
            }
        }
        same_code.part([depth, QUARTET], heights);
        same_code.reorder(triangles, copied_triangles);
    }

    /// Makes the leaves.
    fn blocks(&mut self, mesh: &Mesh, piece: &mut Piece) {
        let Self { triangles, leaves, slots, .. } = self;
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has the instructions.
            return unsafe { blocks_avx2(mesh, triangles, leaves, slots, &mut piece.blocks) };
        }
        blocks(mesh, triangles, leaves, slots, &mut piece.blocks);
    }

    /// Makes the binary tree over the leaves; returns the root.
    fn unite(&mut self) -> Slot {
        let Self { heights, leaves, slots, widen, .. } = self;
        widen.pairs.clear();
        let mut waiting = Waiting::new(Slot::NONE);
        let mut unite = |children: [Slot; 2]| {
            widen.pairs.push(children);
            Slot::inner(&children, widen.pairs.len() - 1)
        };
        for (&begin, &slot) in leaves.iter().zip(&*slots) {
            let height = heights.before(begin as usize);
            waiting.unite_below(height, &mut unite);
            waiting.push(slot, height);
        }
        waiting.unite_below(u8::MAX, &mut unite);
        waiting.last()
    }
}

/// Makes leaf blocks and leaves of the triangles between `leaves`.
#[inline(always)]
fn blocks(
    mesh: &Mesh,
    triangles: &[[u32; 4]],
    leaves: &[u32],
    slots: &mut Vec<Slot>,
    blocks: &mut Vec<TriangleBlock>,
) {
    slots.clear();
    slots.reserve(leaves.len());
    blocks.reserve(leaves.len());
    for (number, leaf) in leaves.windows(2).enumerate() {
        let [begin, end] = [leaf[0] as usize, leaf[1] as usize];
        // Some may be fetched twice: the number of triangles cannot be foreseen.
        let at = |i: usize| &triangles[(begin + i).min(end - 1)];
        let [p, q, r, s] = [at(0), at(1), at(2), at(3)];
        let corners = |&[a, b, c, _]: &[u32; 4]| mesh.corners_of(&[a, b, c]);
        let prims = [p[3], q[3], r[3], s[3]];
        let [p, q, r, s] = [corners(p), corners(q), corners(r), corners(s)];
        let halves = [
            Aabb::of_triangle(p).union(Aabb::of_triangle(q)),
            Aabb::of_triangle(r).union(Aabb::of_triangle(s)),
        ];
        slots.push(Slot::leaf(halves[0].union(halves[1]), number));
        blocks.push(TriangleBlock::of_corners(end - begin, prims, [p, q, r, s]));
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn blocks_avx2(
    mesh: &Mesh,
    triangles: &[[u32; 4]],
    leaves: &[u32],
    slots: &mut Vec<Slot>,
    out: &mut Vec<TriangleBlock>,
) {
    blocks(mesh, triangles, leaves, slots, out);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn leaves_are_the_same_with_any_instructions() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            return;
        }
        // Zeros of either sign tell in which order corners are compared.
        let vertex = |i: u32| [(i % 3) as f32 - 1.0, if i % 5 < 3 { -0.0 } else { 0.0 }, (i * 7 % 11) as f32];
        let triangles = (0..40).map(|i| [i, (i * 3 + 1) % 40, (i * 17 + 5) % 40]).collect();
        let mesh = Mesh::new((0..40).map(vertex).collect(), triangles).unwrap().0;
        let triangles: Vec<[u32; 4]> =
            mesh.triangles().iter().zip(0..).map(|(&[a, b, c], prim)| [a, b, c, prim]).collect();
        let leaves = [0, 1, 3, 6, 10, 14, 17, 20, 24, 25, 29, 32, 36, 40];
        let [mut slots, mut expected_slots] = [Vec::new(), Vec::new()];
        let [mut made, mut expected] = [Vec::new(), Vec::new()];
        blocks(&mesh, &triangles, &leaves, &mut expected_slots, &mut expected);
        // SAFETY: the processor has the instructions, as was just found.
        unsafe { blocks_avx2(&mesh, &triangles, &leaves, &mut slots, &mut made) };
        assert_eq!(format!("{slots:?}{made:?}"), format!("{expected_slots:?}{expected:?}"));
        for ((leaf, block), slot) in leaves.windows(2).zip(&made).zip(&slots) {
            assert!(block.ids().eq(leaf[0]..leaf[1]));
            let prims: Vec<u32> = block.ids().collect();
            assert_eq!(*block, TriangleBlock::of(&mesh, &prims));
            let bounds: Aabb = prims.iter().map(|&prim| mesh.bounds_of(prim)).collect();
            assert_eq!(format!("{:?}", slot.bounds()), format!("{bounds:?}"));
        }
    }
}
