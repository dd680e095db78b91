//! Below a cut of a single node the splits are known: to be split the node is opened into its two children,
//! whatever the threshold, and either side is a single node again. The binary splits are those of the auxiliary
//! BVH. In scenes of much detail that is most of them, and nothing has to be refined.

use crate::builders::api::builder::Counts;
use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::{Node, NodeRun};
use crate::builders::binary::tree::BinaryTree;
use crate::builders::phr::clip::is_whole;
use crate::builders::phr::cut::{Cut, CutLevel};
use crate::builders::phr::memory::CutScratch;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::phr::ref_order::RefOrder;
use crate::builders::prims::geometry::Geometry;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::split::ObjectSplit;
use crate::builders::wide::binary_source::{BinarySource, Leaves};
use crate::builders::wide::treelet::{WideRoot, WideTreelet};
use crate::bvh::Link;
use crate::bvh::limits::BLOCK;

/// The splits of an auxiliary BVH over its leaves.
struct SingleNodes<'a, G> {
    tree: &'a BinaryTree,
    order: &'a RefOrder<'a, G>,
}

impl<G: Geometry> BinarySource for SingleNodes<'_, G> {
    #[inline(always)]
    fn children(&self, run: &NodeRun) -> [NodeRun; 2] {
        let [a, b] = self.tree.children(&run.node);
        let children = NodeRun::in_a_row([*a, *b], run.first);
        let split = ObjectSplit::of_two(a, b, Weight::Nodes.limit(run.node.bounds().half_area(), 2));
        // Without a gain they are halved in the order of the Morton codes.
        let is_swapped = split.left == 1 && split.last == 1;
        if is_swapped { [children[1], children[0]] } else { children }
    }

    #[inline(always)]
    fn prim(&self, position: usize) -> u32 {
        self.order.prim(position)
    }

    #[inline(always)]
    fn finished(&self, run: &NodeRun) -> Option<Link> {
        run.node.is_finished().then(|| self.order.link(&run.node))
    }
}

impl<P: CutPolicy, G: Geometry> CutRecursion<'_, P, G> {
    fn single_nodes(&self) -> SingleNodes<'_, G> {
        SingleNodes { tree: self.tree, order: &self.order }
    }

    /// The node of a cut of a single node that is not split spatially and not clipped.
    #[inline]
    pub(in crate::builders::phr) fn single_node(&self, cut: &Cut, arena: &[Node]) -> Option<Node> {
        if !(P::KEEPS_SINGLE_NODES
            && cut.len == 1
            && cut.level == CutLevel::Subtrees
            && cut.kind != Kind::Leaf)
        {
            return None;
        }
        let node = arena[cut.range().start];
        let is_known = !node.is_leaf()
            && cut.depth < self.cut_depth
            && !self.splits_in_space(cut)
            && is_whole(&node, &cut.clip);
        is_known.then_some(node)
    }

    /// The sides of such a cut.
    pub(in crate::builders::phr) fn split_single_node(
        &self,
        cut: &Cut,
        node: &Node,
        scratch: &mut CutScratch,
    ) -> [Option<Cut>; 2] {
        let (source, run) = (self.single_nodes(), NodeRun { node: *node, first: 0 });
        if cut.kind == Kind::Inner && source.kind(&run, self.config.leaf_size()) == Kind::SoftLeaf {
            return [Some(Cut { kind: Kind::SoftLeaf, ..*cut }), None];
        }
        scratch.counts.splits += 1;
        scratch.counts.swept += 2;
        source.children(&run).map(|NodeRun { node: child, .. }| {
            scratch.arena.push(child);
            self.tree.prefetch(&child);
            let kind = Kind::of_lone(&child);
            let side = cut.of_last(&scratch.arena, CutLevel::Subtrees, kind);
            Some(Cut { capacity: child.count(), depth: cut.depth + 1, ..side })
        })
    }

    /// Appends the wide nodes below such a cut, if no extension applies to the parts of it either; `None`, and nothing
    /// appended, if that makes the tree too deep.
    pub(in crate::builders::phr) fn emit_single_node<const N: usize>(
        &self,
        cut: &Cut,
        node: &Node,
        treelet: &mut WideTreelet<N, G::Block>,
        counts: &mut Counts,
    ) -> Option<WideRoot> {
        let max_leaf = self.config.leaf_size();
        let opens_clusters = !self.has_finished_leaves && self.config.extensions.auxiliary.max_leaf() > BLOCK;
        if self.splits_down_small_cuts() || opens_clusters {
            return None;
        }
        let leaves = Leaves::of(&self.order.refs, max_leaf);
        let source = self.single_nodes();
        let run = NodeRun { node: *node, first: self.tree.run(node).start as u32 };
        let kind = if cut.kind == Kind::Inner { source.kind(&run, max_leaf) } else { cut.kind };
        let mut splits = 0;
        let levels = self.cut_depth - cut.depth;
        let subtree = source.emit_or_roll_back((&run, kind), levels, &leaves, treelet, &mut splits)?;
        counts.splits += splits;
        counts.swept += 2 * splits;
        Some(subtree)
    }
}
