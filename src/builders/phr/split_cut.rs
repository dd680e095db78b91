//! One split of a cut: find the cheapest object or spatial split (paper 4.2, 4.4), partition the nodes, refine both
//! sides (4.3).

use super::clip::{self, open};
use super::cut::{Cut, CutBuilder, CutLevel, Side};
use super::memory::CutScratch;
use super::policy::{CutPolicy, SeenSplit};
use super::recursion::CutRecursion;
use crate::builders::binary::kind::{Kind, leaf_is_cheaper};
use crate::builders::binary::node::Node;
use crate::builders::prims::geometry::Geometry;
use crate::builders::split::by_triangles;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::split::ObjectSplit;
use crate::builders::split::object::strategy::ObjectSweep;
use crate::builders::split::spatial::split::SpatialSplit;
use crate::builders::split::spatial::strategy::SpatialSweep;
use crate::geometry::Aabb;

impl<P: CutPolicy, G: Geometry> CutRecursion<'_, P, G> {
    /// Splits a cut in two and refines both sides, either of which may be clipped away.
    pub(super) fn split_cut(&self, given: &Cut, scratch: &mut CutScratch) -> [Option<Cut>; 2] {
        let CutScratch { counts, arena, object: object_sweep, spatial: spatial_sweep, sides, .. } = scratch;
        let cut = self.open_for_split(given, arena);
        if cut.len == 0 {
            return [None, None];
        }
        if cut.kind == Kind::Leaf {
            return [Some(cut), None];
        }
        counts.splits += 1;
        counts.swept += cut.len as u64;
        let nodes = &arena[cut.range()];

        // Find: the cheapest object split, and a spatial one where it is cheaper still.
        let (object, spatial) = if cut.depth >= self.cut_depth {
            (ObjectSplit::NONE, None)
        } else {
            self.find(&cut, nodes, object_sweep, spatial_sweep)
        };

        // Partition: the nodes to the left and to the right, clipped by the plane of a spatial split.
        sides.iter_mut().for_each(Side::clear);
        let mut clips = [cut.clip; 2];
        let spatial = spatial.filter(|split| self.partition(nodes, split, sides));
        if let Some(split) = spatial {
            counts.spatial_splits += 1;
            clips = [split.left_of(cut.clip), split.right_of(cut.clip)];
        } else if object.left > 0 {
            Side::partition(sides, nodes, object.members(nodes));
        } else {
            // No split gains anything: halve in the order of the Morton codes.
            Side::partition(sides, nodes, |i, _| i < nodes.len() / 2);
        }

        // A leaf, where it costs no more than a node with the two sides as leaves.
        if given.kind != Kind::SoftLeaf
            && !self.has_finished_leaves
            && cut.count <= self.config.leaf_size()
            && leaf_is_cheaper((cut.area, cut.count), sides.each_ref().map(Side::measure))
        {
            return [Some(Cut { kind: Kind::SoftLeaf, ..cut }), None];
        }

        // Refine, which may change the sides: what is to be seen of them is copied.
        let references = sides[0].count + sides[1].count;
        let copies =
            if P::SEES { sides.each_ref().map(|side| side.nodes.clone()) } else { [const { Vec::new() }; 2] };
        // Not by `map`, which copies the cuts.
        let mut refine = |i: usize| self.refine(&cut, clips[i], references, &mut sides[i], arena);
        let refined = [refine(0), refine(1)];
        if P::SEES {
            let nodes = |cut: &Cut| &arena[cut.range()];
            self.policy.see(&SeenSplit {
                tree: self.tree,
                depth: cut.depth,
                axis: spatial.map_or(object.axis, |split| split.axis),
                plane: spatial.map(|split| split.plane),
                cut: nodes(&cut),
                sides: copies.each_ref().map(|nodes| &nodes[..]),
                clips,
                refined: refined.each_ref().map(|cut| cut.as_ref().map_or(&[][..], nodes)),
            });
        }
        refined
    }

    /// Opens what must be opened before a cut can be split: a lone node, whatever the threshold; all nodes, near the
    /// leaves or where the tree gets too deep.
    fn open_for_split(&self, cut: &Cut, arena: &mut Vec<Node>) -> Cut {
        let mut cut = *cut;
        while cut.len == 1 {
            let node = arena[cut.range().start];
            if node.is_leaf() {
                break;
            }
            let mut opened = CutBuilder::new(arena);
            open(self.tree, &node, &cut.clip, |child| {
                self.tree.prefetch(&child);
                opened.push(child);
            });
            cut = opened.finish(&cut);
        }
        let is_lone_leaf = cut.len == 1 && arena[cut.range().start].is_leaf();
        let opens_all = is_lone_leaf || cut.depth >= self.cut_depth;
        if cut.level == CutLevel::Subtrees && opens_all {
            let mut opened = CutBuilder::new(arena);
            for i in cut.range() {
                let node = opened.arena[i];
                self.order.open_all(self.tree, &node, &cut.clip, &mut |child| opened.push(child));
            }
            return opened.finish(&Cut { level: CutLevel::References, ..cut });
        }
        cut
    }

    /// The object split of least cost, and a spatial one that is preferred to it.
    #[inline]
    fn find(
        &self,
        cut: &Cut,
        nodes: &[Node],
        object_sweep: &mut ObjectSweep,
        spatial_sweep: &mut SpatialSweep,
    ) -> (ObjectSplit, Option<SpatialSplit>) {
        let weight = if cut.level == CutLevel::References { Weight::Blocks } else { Weight::Nodes };
        if self.config.extensions.triangle_counts && weight == Weight::Nodes {
            let object = by_triangles::object(nodes, cut.area);
            let whole = by_triangles::whole(cut.area, nodes);
            let find = |limit| by_triangles::spatial(nodes, cut.bounds, limit);
            return (object, self.find_spatial(cut, nodes, &object, whole, find));
        }
        let (object, bins) = object_sweep.find(self.isa, nodes, cut.bounds, weight);
        let whole = cut.area * weight.of(nodes.len());
        let find = |limit| spatial_sweep.find(self.isa, limit, (nodes, cut.bounds), weight, bins);
        (object, self.find_spatial(cut, nodes, &object, whole, find))
    }

    /// A spatial split, if the thresholds allow one and it costs less than `object`; `find` finds the one of least cost
    /// below a limit, and without a split the cut costs `whole`.
    #[inline]
    fn find_spatial(
        &self,
        cut: &Cut,
        nodes: &[Node],
        object: &ObjectSplit,
        whole: f32,
        find: impl FnOnce(f32) -> SpatialSplit,
    ) -> Option<SpatialSplit> {
        if !self.splits_in_space(cut) {
            return None;
        }
        let split = find(object.cost.min(whole));
        if split == SpatialSplit::NONE {
            return None;
        }
        let count = |node: &Node| {
            let sides = u64::from(split.on_left(node.bounds())) + u64::from(split.on_right(node.bounds()));
            u64::from(node.count()) * sides
        };
        let references: u64 = nodes.iter().map(count).sum();
        (references <= u64::from(cut.capacity)).then_some(split)
    }

    /// Puts the pieces of nodes on the sides of a spatial split. False, and nothing on either, if all are on one:
    /// finished leaves are not cut where they reach beyond the plane.
    fn partition(&self, nodes: &[Node], split: &SpatialSplit, sides: &mut [Side; 2]) -> bool {
        for node in nodes {
            for (side, piece) in sides.iter_mut().zip(self.pieces(node, split)) {
                piece.into_iter().for_each(|piece| side.push(piece));
            }
        }
        let is_split = !self.has_finished_leaves || sides.iter().all(|side| side.count > 0);
        if !is_split {
            sides.iter_mut().for_each(Side::clear);
        }
        is_split
    }

    /// The pieces of a node on both sides of a spatial split.
    fn pieces(&self, node: &Node, split: &SpatialSplit) -> [Option<Node>; 2] {
        let clips_primitive = self.config.extensions.clip_triangles && node.is_leaf() && node.count() == 1;
        let of_primitive = || {
            let prim = self.order.prim(node.run().start);
            self.order.refs.geometry.split(prim, node.bounds(), split.axis, split.plane)
        };
        clip::pieces(node, split, clips_primitive.then_some(of_primitive))
    }

    /// Refines one side of a split into a cut of its own; both sides hold `references` in all.
    #[inline]
    fn refine(
        &self,
        parent: &Cut,
        clip: Aabb,
        references: u32,
        side: &mut Side,
        arena: &mut Vec<Node>,
    ) -> Option<Cut> {
        let depth = parent.depth + 1;
        // Room for duplicates is handed down in proportion to the references of each side.
        let capacity = if self.splits_in_space(parent) {
            (f64::from(parent.capacity) * f64::from(side.count) / f64::from(references)) as u32
        } else {
            0
        };
        let mut cut = CutBuilder::new(arena);
        if parent.level == CutLevel::References {
            side.nodes.iter().for_each(|node| cut.push(*node));
        } else {
            self.policy.refine(self.tree, &clip, depth, side, &mut cut);
        }
        let cut = cut.finish(&Cut { clip, capacity: capacity.max(side.count), depth, ..*parent });
        (cut.len > 0).then_some(cut)
    }
}
