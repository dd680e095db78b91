//! One treelet of the builder `lbvh`, widened at once. As [`crate::builders::lbvh::treelet`], but its leaves are
//! full blocks and nobody opens it: corners are fetched once, for leaf blocks and boxes together.

use super::full_leaves::FullLeaves;
use crate::builders::lbvh::cartesian::cartesian_tree;
use crate::builders::lbvh::deltas::Deltas;
use crate::builders::lbvh::equal_codes::EqualCodes;
use crate::builders::lbvh::key::{MortonKey, reference};
use crate::builders::lbvh::prefetch;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::builders::wide::branchless::{Slot, Widen};
use crate::builders::wide::treelet::{WideRoot, WideTreelet};
use crate::bvh::limits::BLOCK;
use crate::geometry::Aabb;
use crate::simd::Isa;
use arrayvec::ArrayVec;

/// Memory of a task that builds one treelet.
#[derive(Default)]
pub(crate) struct DirectTreelet<I, const N: usize> {
    /// The primitives: of triangles, corners as vertex indices, and the triangle.
    items: Vec<I>,
    copied_items: Vec<I>,
    pub deltas: Deltas,
    pub equal_codes: EqualCodes,
    full_leaves: FullLeaves,
    /// Where the leaves begin, and where the last one ends.
    pub leaves: Vec<u32>,
    /// The leaves.
    pub slots: Vec<Slot>,
    pub widen: Widen<N>,
}

impl<I: Copy + Default, const N: usize> DirectTreelet<I, N> {
    /// Builds the subtree over `keys`, whole primitives that have been partitioned by the middle `depth` times.
    pub fn build<G: Geometry<Item = I>>(
        &mut self,
        isa: Isa,
        refs: &PrimRefs<'_, G>,
        keys: &[MortonKey],
        depth: u32,
        treelet: &mut WideTreelet<N, G::Block>,
    ) -> WideRoot {
        self.make_leaves(isa, refs, (keys, depth), |_| true, &mut treelet.blocks);
        let Self { deltas, leaves, slots, widen, .. } = self;
        widen.pairs.clear();
        let leaves = slots.iter().zip(&*leaves).map(|(&slot, &begin)| (slot, deltas.before(begin as usize)));
        let root = cartesian_tree(Slot::NONE, leaves, |children| {
            widen.pairs.push(children);
            Slot::inner::<N>(&children, widen.pairs.len() - 1)
        });
        let nodes = &mut treelet.nodes;
        let link = isa.run(
            #[inline(always)]
            || widen.write(&root, nodes),
        );
        Some((root.bounds(), link))
    }

    /// Makes the leaves over `keys`, likewise, and the blocks of those whose box `has_block`, the first of `blocks`.
    /// Leaves with pieces of needles are made as if the needles were whole ([`Self::fit_pieces`]).
    pub fn make_leaves<G: Geometry<Item = I>>(
        &mut self,
        isa: Isa,
        refs: &PrimRefs<'_, G>,
        (keys, depth): (&[MortonKey], u32),
        has_block: impl Fn(Aabb) -> bool,
        blocks: &mut Vec<G::Block>,
    ) {
        let Self { items, copied_items, deltas, equal_codes, full_leaves, leaves, slots, .. } = self;
        let geometry = refs.geometry;
        items.clear();
        items.extend(keys.iter().enumerate().map(|(i, &key)| {
            prefetch::far_ahead(geometry, keys, i);
            geometry.item(refs.prim(reference(key)))
        }));
        deltas.of_codes(keys);
        equal_codes.partition(deltas, keys.len(), [depth, BLOCK], |i| {
            let whole = || geometry.bounds_of_item(&items[i]);
            refs.fragment(reference(keys[i])).map_or_else(whole, |piece| piece.bounds).center2()
        });
        equal_codes.reorder(items, copied_items);
        isa.run(
            #[inline(always)]
            || {
                full_leaves.find(deltas, leaves);
                emit_leaves(geometry, items, leaves, has_block, (slots, blocks));
            },
        );
    }

    /// Gives leaves with pieces of needles, which were made as if the needles were whole, the boxes of the pieces; some
    /// have a block then. A triangle is once in a block. The keys are in the order of the leaves.
    pub fn fit_pieces<G: Geometry<Item = I>>(
        &mut self,
        refs: &PrimRefs<'_, G>,
        keys: &[MortonKey],
        has_block: impl Fn(Aabb) -> bool,
        blocks: &mut Vec<G::Block>,
    ) {
        let Self { items, leaves, slots, .. } = self;
        let piece = |i: usize| refs.fragment(reference(keys[i]));
        for (slot, leaf) in slots.iter_mut().zip(leaves.windows(2)) {
            let leaf = || leaf[0] as usize..leaf[1] as usize;
            if leaf().all(|i| piece(i).is_none()) {
                continue;
            }
            let bounds_of =
                |i: usize| piece(i).map_or_else(|| refs.geometry.bounds_of_item(&items[i]), |p| p.bounds);
            let bounds: Aabb = leaf().map(bounds_of).collect();
            let mut prims = ArrayVec::<u32, { BLOCK as usize }>::new();
            for prim in leaf().map(|i| refs.prim(reference(keys[i]))) {
                if !prims.contains(&prim) {
                    prims.push(prim);
                }
            }
            *slot = if !has_block(bounds) {
                Slot::bare(bounds)
            } else if slot.is_bare() {
                blocks.push(refs.geometry.block_of(&prims));
                Slot::leaf(bounds, blocks.len() - 1)
            } else {
                if prims.len() < leaf().len() {
                    blocks[slot.index()] = refs.geometry.block_of(&prims);
                }
                Slot::leaf(bounds, slot.index())
            };
        }
    }
}

/// Makes slots of the primitives between `leaves`, and leaf blocks of those whose box `has_block`.
#[inline(always)]
fn emit_leaves<G: Geometry>(
    geometry: &G,
    items: &[G::Item],
    leaves: &[u32],
    has_block: impl Fn(Aabb) -> bool,
    (slots, blocks): (&mut Vec<Slot>, &mut Vec<G::Block>),
) {
    slots.clear();
    slots.reserve(leaves.len());
    blocks.reserve(leaves.len());
    for leaf in leaves.windows(2) {
        let [begin, end] = [leaf[0] as usize, leaf[1] as usize];
        // Some may be fetched twice: a branch on the number of primitives could not be predicted.
        let at = |i: usize| &items[(begin + i).min(end - 1)];
        let (bounds, block) = geometry.block_of_items(end - begin, [at(0), at(1), at(2), at(3)]);
        if has_block(bounds) {
            slots.push(Slot::leaf(bounds, blocks.len()));
            blocks.push(block);
        } else {
            slots.push(Slot::bare(bounds));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;

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
        emit_leaves(&mesh, &triangles, &leaves, |_| true, (&mut expected_slots, &mut expected));
        for isa in Isa::available() {
            made.clear();
            isa.run(
                #[inline(always)]
                || emit_leaves(&mesh, &triangles, &leaves, |_| true, (&mut slots, &mut made)),
            );
            assert_eq!(format!("{slots:?}{made:?}"), format!("{expected_slots:?}{expected:?}"), "{isa:?}");
        }
        for ((leaf, block), slot) in leaves.windows(2).zip(&made).zip(&slots) {
            assert!(block.ids().eq(leaf[0]..leaf[1]));
            let prims: Vec<u32> = block.ids().collect();
            assert_eq!(*block, mesh.block_of(&prims));
            let bounds: Aabb = prims.iter().map(|&prim| mesh.bounds_of(prim)).collect();
            assert_eq!(format!("{:?}", slot.bounds()), format!("{bounds:?}"));
        }
    }
}
