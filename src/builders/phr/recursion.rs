//! Building from cuts (paper 3.2, Figure 3): split a cut of the auxiliary BVH, refine both sides, recurse.

use super::clip::is_whole;
use super::config::PhrConfig;
use super::cut::{Cut, CutLevel, OwnedCut};
use super::initial_cut::initial_cut;
use super::memory::CutScratch;
use super::policy::CutPolicy;
use super::ref_order::RefOrder;
use crate::builders::binary::kind::Kind;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::lbvh::prefetch;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::top_down::{BinarySplits, TopDown, grain};
use crate::builders::wide::treelet::{WideRoot, WideTreelet};
use crate::bvh::Link;
use crate::bvh::limits::{CUT_DEPTH, FINISHED_CUT_DEPTH, MAX_REFERENCES_PER_TRIANGLE};
use crate::geometry::{Aabb, Mesh};
use crate::simd::Isa;
use arrayvec::ArrayVec;

/// The recursion over cuts of an auxiliary BVH.
pub(crate) struct CutRecursion<'a, P, G = Mesh> {
    /// The auxiliary BVH.
    pub tree: &'a BinaryTree,
    /// What its leaves hold.
    pub order: RefOrder<'a, G>,
    /// The parameters.
    pub config: &'a PhrConfig,
    /// How cuts are refined.
    pub policy: P,
    /// Instructions to use.
    pub isa: Isa,
    /// Whether the auxiliary BVH has finished leaves.
    pub has_finished_leaves: bool,
    /// From this depth on, cuts are halved by count.
    pub cut_depth: u32,
    /// Spatial splits are tried in nodes of a larger half area.
    spatial_above: f32,
}

impl<'a, P: CutPolicy, G: Geometry> CutRecursion<'a, P, G> {
    /// Over the auxiliary BVH of `geometry`.
    pub fn new(
        auxiliary: &'a Auxiliary,
        geometry: &'a G,
        config: &'a PhrConfig,
        policy: P,
        isa: Isa,
    ) -> Self {
        let above = auxiliary.scale.relative_to * config.spatial_threshold;
        Self {
            tree: &auxiliary.tree,
            order: RefOrder { keys: &auxiliary.order.keys, refs: auxiliary.order.refs(geometry) },
            config,
            policy,
            isa,
            has_finished_leaves: auxiliary.has_finished_leaves,
            cut_depth: if auxiliary.has_finished_leaves { FINISHED_CUT_DEPTH } else { CUT_DEPTH },
            spatial_above: if geometry.splits() { above } else { f32::INFINITY },
        }
    }

    /// The recursion with the initial cut that it begins with (paper 4.1), if there is anything: nodes of a half area
    /// of more than `threshold` are opened, up to a length of the cut.
    pub fn with_initial_cut(self, (threshold, len): (f32, usize)) -> (Self, Option<OwnedCut>) {
        let cut = self.tree.root.map(|root| {
            let nodes = initial_cut(self.tree, root, threshold, len);
            let most = self.order.refs.geometry.len() * MAX_REFERENCES_PER_TRIANGLE;
            Cut::whole(nodes, self.config.max_references, most)
        });
        (self, cut)
    }

    /// Whether spatial splits are tried in a cut. If not, they are not in any below it.
    #[inline]
    pub fn splits_in_space(&self, cut: &Cut) -> bool {
        cut.area > self.spatial_above
    }
}

impl<P: CutPolicy, G: Geometry> BinarySplits for CutRecursion<'_, P, G> {
    fn kind(&self, cut: &Cut) -> Kind {
        cut.kind
    }

    fn half_area(&self, cut: &Cut) -> f32 {
        cut.area
    }

    fn split(&self, cut: &Cut, scratch: &mut CutScratch) -> [Option<Cut>; 2] {
        // Shortcuts: splits that are found in one go, or known already.
        if let Some(sides) = self.split_down_sides(cut, scratch) {
            return sides;
        }
        if let Some(node) = self.single_node(cut, &scratch.arena) {
            return self.split_single_node(cut, &node, scratch);
        }
        self.split_cut(cut, scratch)
    }
}

impl<P: CutPolicy, G: Geometry> TopDown for CutRecursion<'_, P, G> {
    type Task = OwnedCut;
    type Part = Cut;
    type Scratch = CutScratch;
    type Block = G::Block;

    fn import(&self, owned: OwnedCut, scratch: &mut CutScratch) -> Cut {
        let (cut, from) = owned.import(&mut scratch.arena);
        if cut.level == CutLevel::SplitDown {
            let node = &mut scratch.arena[cut.range().start];
            *node = scratch.subtrees.copy(node, &from);
        }
        cut
    }

    fn export(&self, cut: &Cut, scratch: &CutScratch) -> OwnedCut {
        let mut owned = cut.export(&scratch.arena);
        if cut.level == CutLevel::SplitDown {
            owned.nodes[0] = owned.subtrees.copy(&owned.nodes[0], &scratch.subtrees);
        }
        owned
    }

    fn prefetch(&self, cut: &Cut, scratch: &CutScratch) {
        // Of finished leaves nothing is needed but their links.
        if cut.level != CutLevel::SplitDown && !self.has_finished_leaves {
            let leaf = self.config.extensions.auxiliary.max_leaf();
            for node in &scratch.arena[cut.range()] {
                prefetch::subtree(self.tree, self.order.keys, &self.order.refs, node, leaf);
            }
        }
    }

    fn grain(&self, n: usize) -> usize {
        // A finished leaf of hundreds of references is no more work than another.
        if self.has_finished_leaves { (n / 32).clamp(1 << 12, 1 << 15) } else { grain(n) }
    }

    fn count(&self, cut: &Cut) -> u32 {
        cut.count
    }

    fn is_leaf(&self, cut: &Cut) -> bool {
        cut.kind != Kind::Inner
    }

    fn children<const N: usize>(&self, cut: &Cut, scratch: &mut CutScratch, children: &mut ArrayVec<Cut, N>) {
        self.split_largest(cut, scratch, children);
    }

    fn leaf(&self, cut: &Cut, prims: &mut Vec<u32>, scratch: &mut CutScratch) -> Aabb {
        self.gather(cut, prims, scratch, |_, bounds| Some(bounds))
    }

    fn try_emit<const N: usize>(
        &self,
        cut: &Cut,
        treelet: &mut WideTreelet<N, G::Block>,
        scratch: &mut CutScratch,
    ) -> Option<WideRoot> {
        if let Some(subtree) = self.finished(cut, scratch) {
            return Some(Some(subtree));
        }
        if let Some(costs) = &self.config.extensions.collapse {
            return Some(self.collapse(cut, costs, treelet, scratch));
        }
        if let Some(subtree) = self.emit_split_down(cut, treelet, scratch) {
            return Some(subtree);
        }
        let node = self.single_node(cut, &scratch.arena)?;
        self.emit_single_node(cut, &node, treelet, &mut scratch.counts)
    }
}

impl<P: CutPolicy, G: Geometry> CutRecursion<'_, P, G> {
    /// The subtree of a cut of a single node that is finished.
    #[inline]
    fn finished(&self, cut: &Cut, scratch: &CutScratch) -> Option<(Aabb, Link)> {
        let node = &scratch.arena[cut.range().start];
        (self.has_finished_leaves && cut.len == 1 && node.is_finished())
            .then(|| (cut.bounds, self.order.link(node)))
    }

    /// Appends the primitives of a leaf; returns their box. Of one that is not wholly inside the clip box,
    /// `visible` tells the box that the leaf sees, given the box of its part.
    pub fn gather(
        &self,
        cut: &Cut,
        prims: &mut Vec<u32>,
        scratch: &CutScratch,
        visible: impl Fn(u32, Aabb) -> Option<Aabb>,
    ) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for node in &scratch.arena[cut.range()] {
            if cut.level == CutLevel::SplitDown {
                bounds = node.bounds();
                prims.extend(scratch.subtrees.prims_below(node));
            } else if is_whole(node, &cut.clip) {
                bounds = bounds.union(node.bounds());
                prims.extend(self.tree.run(node).map(|position| self.order.prim(position)));
            } else {
                self.order.open_all(self.tree, node, &cut.clip, &mut |reference| {
                    let prim = self.order.prim(reference.run().start);
                    if let Some(part) = visible(prim, reference.bounds()) {
                        bounds = bounds.union(part);
                        prims.push(prim);
                    }
                });
            }
        }
        if !self.order.refs.fragments.is_empty() {
            // Parts of one primitive may meet in a leaf.
            prims.sort_unstable();
            prims.dedup();
        }
        bounds
    }
}
