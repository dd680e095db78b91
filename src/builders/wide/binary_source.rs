//! Subtrees all of whose binary splits are known, widened at once.

use super::open_largest::{Priority, open_largest, replace};
use super::treelet::{WideRoot, WideTreelet};
use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::NodeRun;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::bvh::Link;
use crate::bvh::limits::{BLOCK, MAX_LEAF};
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;

/// A source of binary splits.
pub(crate) trait BinarySource {
    /// The children of a subtree that is no [`Kind::Leaf`].
    fn children(&self, run: &NodeRun) -> [NodeRun; 2];

    /// The primitive at a position.
    fn prim(&self, position: usize) -> u32;

    /// The link of a leaf that is finished; `None` of others.
    #[inline(always)]
    fn finished(&self, _: &NodeRun) -> Option<Link> {
        None
    }

    /// What becomes of a subtree.
    #[inline(always)]
    fn kind(&self, run: &NodeRun, max_leaf: u32) -> Kind {
        Kind::of(&run.node, max_leaf, || self.children(run).map(|child| child.node))
    }

    /// The children of a subtree that is split, as children of a wide node; `None` if it may not be split any more.
    #[inline(always)]
    fn open(&self, run: &NodeRun, levels: u32, max_leaf: u32) -> Option<[OpenChild; 2]> {
        let below = levels.checked_sub(1)?;
        // Not by `map`, which is not always inlined.
        let [left, right] = self.children(run);
        let child = |run: NodeRun| OpenChild::new(run, self.kind(&run, max_leaf), below);
        Some([child(left), child(right)])
    }

    /// Appends the wide nodes and leaf blocks of a subtree, as [`open_largest`] forms them. `None` if there are splits
    /// below `levels` others: the treelet is then to be rolled back. Counts binary splits.
    fn emit<G: Geometry, const N: usize>(
        &self,
        (run, kind): (&NodeRun, Kind),
        levels: u32,
        leaves: &Leaves<'_, G>,
        treelet: &mut WideTreelet<N, G::Block>,
        splits: &mut u64,
    ) -> Option<WideRoot> {
        if kind != Kind::Inner {
            let finished = self.finished(run).map(|link| (run.node.bounds(), link));
            return Some(finished.or_else(|| leaves.emit(self, run, treelet)));
        }
        let mut children = ArrayVec::<OpenChild, N>::new();
        children.extend(self.open(run, levels, leaves.max_leaf)?);
        open_largest(
            &mut children,
            #[inline(always)]
            |child| child.priority,
            #[inline(always)]
            |children, next| {
                let child = &children[next];
                let opened = self.open(&child.run, child.levels, leaves.max_leaf)?;
                replace(children, next, opened);
                Some(())
            },
        )?;
        let mut built = ArrayVec::<(Aabb, Link), N>::new();
        for OpenChild { run, kind, levels, .. } in &children {
            built.extend(self.emit((run, *kind), *levels, leaves, treelet, splits)?);
        }
        *splits += children.len() as u64 - 1;
        Some(treelet.node(&built))
    }

    /// The same, but of what is too deep nothing is left in the treelet.
    fn emit_or_roll_back<G: Geometry, const N: usize>(
        &self,
        subtree: (&NodeRun, Kind),
        levels: u32,
        leaves: &Leaves<'_, G>,
        treelet: &mut WideTreelet<N, G::Block>,
        splits: &mut u64,
    ) -> Option<WideRoot> {
        let before = [treelet.nodes.len(), treelet.blocks.len()];
        let emitted = self.emit(subtree, levels, leaves, treelet, splits);
        if emitted.is_none() {
            treelet.rollback(before);
        }
        emitted
    }
}

impl BinarySource for Subtrees {
    #[inline(always)]
    fn children(&self, run: &NodeRun) -> [NodeRun; 2] {
        let [left, right] = self.children(&run.node);
        NodeRun::in_a_row([left, right], run.first)
    }

    #[inline(always)]
    fn prim(&self, position: usize) -> u32 {
        self.prims[position]
    }
}

/// How leaves are made.
pub(crate) struct Leaves<'a, G = Mesh> {
    /// The primitives.
    pub geometry: &'a G,
    /// Most primitives of a leaf of several blocks.
    pub max_leaf: u32,
    /// Whether parts of one primitive may meet in a leaf.
    pub may_repeat: bool,
}

impl<'a, G: Geometry> Leaves<'a, G> {
    /// Of references each of which is in one leaf.
    pub fn of(refs: &PrimRefs<'a, G>, max_leaf: u32) -> Self {
        Self { geometry: refs.geometry, max_leaf, may_repeat: !refs.fragments.is_empty() }
    }

    /// Appends the leaf of a subtree's primitives.
    #[inline]
    pub fn emit<const N: usize>(
        &self,
        source: &(impl BinarySource + ?Sized),
        run: &NodeRun,
        treelet: &mut WideTreelet<N, G::Block>,
    ) -> WideRoot {
        let positions = run.first as usize..(run.first + run.node.count()) as usize;
        let bounds = run.node.bounds();
        if positions.len() <= BLOCK as usize {
            let prim = |lane: usize| source.prim((positions.start + lane).min(positions.end - 1));
            let prims = std::array::from_fn(prim);
            let (count, prims) =
                if self.may_repeat { without_repeats(prims) } else { (positions.len(), prims) };
            return Some((bounds, treelet.block(self.geometry, count, prims)));
        }
        let mut prims: ArrayVec<u32, { MAX_LEAF as usize }> =
            positions.map(|position| source.prim(position)).collect();
        if self.may_repeat {
            // Parts of one triangle may meet in a leaf.
            prims.sort_unstable();
            let mut last = None;
            prims.retain(|prim| last.replace(*prim) != Some(*prim));
        }
        treelet.leaf(self.geometry, &prims).map(|link| (bounds, link))
    }
}

/// In ascending order, each once, and how many they are; the last fills the places left. No branch depends on them.
#[inline]
fn without_repeats(mut prims: [u32; BLOCK as usize]) -> (usize, [u32; BLOCK as usize]) {
    for [a, b] in [[0, 1], [2, 3], [0, 2], [1, 3], [1, 2]] {
        (prims[a], prims[b]) = (prims[a].min(prims[b]), prims[a].max(prims[b]));
    }
    let [first, .., last] = prims;
    let mut once = [first, last, last, last];
    let mut count = 1;
    for i in 1..prims.len() {
        once[count] = prims[i];
        count += usize::from(prims[i] > prims[i - 1]);
    }
    (count, once)
}

/// A child of a wide node in the making.
pub(crate) struct OpenChild {
    run: NodeRun,
    kind: Kind,
    priority: Priority,
    /// Splits that there may be below, one below the other.
    levels: u32,
}

impl OpenChild {
    #[inline(always)]
    fn new(run: NodeRun, kind: Kind, levels: u32) -> Self {
        Self { run, kind, priority: Priority::new(kind, run.node.bounds().half_area()), levels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_primitive_is_once_in_a_block() {
        for number in 0..256 {
            let prims = [0, 2, 4, 6].map(|shift| number >> shift & 3);
            let mut expected = prims.to_vec();
            expected.sort_unstable();
            expected.dedup();
            let (count, once) = without_repeats(prims);
            assert_eq!(once[..count], expected);
            assert!(once[count..].iter().all(|prim| Some(prim) == expected.last()));
        }
    }
}
