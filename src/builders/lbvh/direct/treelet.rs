//! One treelet of the builder `lbvh`, widened at once. As [`crate::builders::lbvh::treelet`], but its leaves are blocks and nobody opens
//! it: corners are fetched once, for leaf blocks and boxes together.

use crate::builders::lbvh::cartesian::cartesian_tree;
use crate::builders::lbvh::deltas::Deltas;
use crate::builders::lbvh::equal_codes::EqualCodes;
use crate::builders::lbvh::key::{MortonKey, reference};
use crate::builders::lbvh::prefetch;
use crate::builders::wide::branchless::{Slot, Widen};
use crate::builders::wide::treelet::{Subtree, WideTreelet};
use crate::bvh::TriangleBlock;
use crate::bvh::limits::BLOCK;
use crate::geometry::{Aabb, Mesh};
use crate::simd::Isa;

/// Memory of a task that builds one treelet.
#[derive(Default)]
pub(crate) struct DirectTreelet<const N: usize> {
    /// Corners of the triangles, as vertex indices, and the triangle.
    triangles: Vec<[u32; 4]>,
    copied_triangles: Vec<[u32; 4]>,
    deltas: Deltas,
    equal_codes: EqualCodes,
    /// Where the leaves begin, and where the last one ends.
    leaves: Vec<u32>,
    /// The leaves.
    slots: Vec<Slot>,
    widen: Widen<N>,
}

impl<const N: usize> DirectTreelet<N> {
    /// Builds the subtree over `keys`, whole triangles of `mesh` that have been partitioned by the middle `depth` times.
    /// Returns it with the number of its binary nodes' pairs.
    pub fn build(
        &mut self,
        isa: Isa,
        mesh: &Mesh,
        keys: &[MortonKey],
        depth: u32,
        treelet: &mut WideTreelet<N>,
    ) -> (Subtree, usize) {
        let Self { triangles, copied_triangles, deltas, equal_codes, leaves, slots, widen } = self;
        triangles.clear();
        triangles.extend(keys.iter().enumerate().map(|(i, &key)| {
            prefetch::indices(mesh, keys, i);
            let prim = reference(key);
            let [a, b, c] = mesh.triangles()[prim as usize];
            prefetch::corners(mesh, [a, b, c]);
            [a, b, c, prim]
        }));
        deltas.of_codes(keys);
        equal_codes.partition(deltas, keys.len(), [depth, BLOCK], |i| {
            let [a, b, c, _] = triangles[i];
            Aabb::of_triangle(mesh.corners_of(&[a, b, c])).center2()
        });
        equal_codes.reorder(triangles, copied_triangles);
        deltas.leaves(BLOCK, leaves);
        emit_leaves(isa, mesh, triangles, leaves, slots, &mut treelet.blocks);
        widen.pairs.clear();
        let leaves = slots.iter().zip(&*leaves).map(|(&slot, &begin)| (slot, deltas.before(begin as usize)));
        let root = cartesian_tree(Slot::NONE, leaves, |children| {
            widen.pairs.push(children);
            Slot::inner(&children, widen.pairs.len() - 1)
        });
        let nodes = &mut treelet.nodes;
        let link = match isa.avx2() {
            None => widen.write(&root, nodes),
            Some(token) => token.run(
                #[inline(always)]
                || widen.write(&root, nodes),
            ),
        };
        (Some((root.bounds(), link)), widen.pairs.len())
    }
}

/// Makes leaf blocks and slots of the triangles between `leaves`.
fn emit_leaves(
    isa: Isa,
    mesh: &Mesh,
    triangles: &[[u32; 4]],
    leaves: &[u32],
    slots: &mut Vec<Slot>,
    blocks: &mut Vec<TriangleBlock>,
) {
    match isa.avx2() {
        None => emit_leaves_with(mesh, triangles, leaves, slots, blocks),
        Some(token) => token.run(
            #[inline(always)]
            move || emit_leaves_with(mesh, triangles, leaves, slots, blocks),
        ),
    }
}

#[inline(always)]
fn emit_leaves_with(
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
        // Some may be fetched twice: a branch on the number of triangles could not be predicted.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_are_the_same_with_any_instructions() {
        // Zeros of either sign tell in which order corners are compared.
        let vertex = |i: u32| [(i % 3) as f32 - 1.0, if i % 5 < 3 { -0.0 } else { 0.0 }, (i * 7 % 11) as f32];
        let triangles = (0..40).map(|i| [i, (i * 3 + 1) % 40, (i * 17 + 5) % 40]).collect();
        let mesh = Mesh::new((0..40).map(vertex).collect(), triangles).unwrap().0;
        let triangles: Vec<[u32; 4]> =
            mesh.triangles().iter().zip(0..).map(|(&[a, b, c], prim)| [a, b, c, prim]).collect();
        let leaves = [0, 1, 3, 6, 10, 14, 17, 20, 24, 25, 29, 32, 36, 40];
        let [mut slots, mut expected_slots] = [Vec::new(), Vec::new()];
        let [mut made, mut expected] = [Vec::new(), Vec::new()];
        emit_leaves(Isa::Scalar, &mesh, &triangles, &leaves, &mut expected_slots, &mut expected);
        for isa in Isa::available() {
            made.clear();
            emit_leaves(isa, &mesh, &triangles, &leaves, &mut slots, &mut made);
            assert_eq!(format!("{slots:?}{made:?}"), format!("{expected_slots:?}{expected:?}"), "{isa:?}");
        }
        for ((leaf, block), slot) in leaves.windows(2).zip(&made).zip(&slots) {
            assert!(block.ids().eq(leaf[0]..leaf[1]));
            let prims: Vec<u32> = block.ids().collect();
            assert_eq!(*block, TriangleBlock::of(&mesh, &prims));
            let bounds: Aabb = prims.iter().map(|&prim| mesh.bounds_of(prim)).collect();
            assert_eq!(format!("{:?}", slot.bounds()), format!("{bounds:?}"));
        }
    }
}
