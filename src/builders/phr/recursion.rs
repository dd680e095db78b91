//! Building from a hierarchy: split a cut of the auxiliary BVH, refine both sides, recurse (paper 3.2, Figure 3).
//! How a side is refined is all in which PHR and the method of Hunt et al. differ.

use crate::builders::binary::subtrees::Subtrees;
use crate::builders::binary::{BinaryTree, Node};
use crate::builders::builder::Counts;
use crate::builders::lbvh::prefetch::warm;
use crate::builders::phr::cut::{Cut, Growing, Order, OwnCut, Stage, open};
use crate::builders::phr::extensions::collapse::Cheapest;
use crate::builders::phr::initial_cut::initial_cut;
use crate::builders::phr::policy::{Refine, Rules};
use crate::builders::phr::side::Side;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::lanes::Isa;
use crate::builders::split::object::{ObjectSplit, Sweep};
use crate::builders::split::spatial::{SpatialSplit, SpatialSweep};
use crate::builders::split::sweep_sah::SubtreeSweep;
use crate::builders::wide::top_down::{Kind, QUARTET, TopDown};
use crate::builders::wide::treelet::{Piece, Subtree};
use crate::geometry::Aabb;
use crate::geometry::triangle_split::{split_reference, visible};

/// From this many binary splits on, the references left are halved by count: no input makes the tree deeper
/// than traversal stacks allow.
pub(crate) const MAX_DEPTH: u32 = 50;

/// The recursion over cuts.
pub(crate) struct CutRecursion<'a, R> {
    /// The auxiliary BVH.
    pub tree: &'a BinaryTree,
    /// What its leaves hold.
    pub order: Order<'a>,
    /// What to do.
    pub rules: Rules<R>,
    /// Instructions for it.
    pub isa: Isa,
}

/// Memory and counts of a thread.
#[derive(Default)]
pub(crate) struct Scratch {
    /// What was counted since it was last taken.
    pub counts: Counts,
    /// The nodes of all cuts in use.
    pub arena: Vec<Node>,
    sweep: Sweep,
    spatial_sweep: SpatialSweep,
    sides: [Side; 2],
    /// For small cuts.
    pub subtree_sweep: SubtreeSweep,
    /// Those swept.
    pub subtrees: Subtrees,
    /// For subtrees that are made wide at once.
    pub cheapest: Cheapest,
}

impl<R: Refine> CutRecursion<'_, R> {
    /// The whole scene as a cut.
    pub fn root(&self) -> Option<(OwnCut, Subtrees)> {
        let root = self.tree.root?;
        let nodes = initial_cut(self.tree, root, self.rules.initial_threshold, self.rules.initial_len);
        Some((Cut::whole(nodes, self.rules.max_references), Subtrees::default()))
    }

    /// Opens what must be before a cut can be split: a lone node, whatever the threshold; all nodes, near the
    /// leaves or where the tree gets too deep.
    fn open_for_split(&self, cut: &Cut, arena: &mut Vec<Node>) -> Cut {
        let mut cut = *cut;
        while cut.len == 1 {
            let node = arena[cut.places().start];
            if node.is_leaf() {
                break;
            }
            let mut opened = Growing::new(arena);
            open(self.tree, &node, &cut.clip, |child| {
                self.tree.prefetch(&child);
                opened.push(child);
            });
            cut = opened.finish(&cut);
        }
        let is_lone_leaf = cut.len == 1 && arena[cut.places().start].is_leaf();
        let is_small = cut.count <= self.rules.leaf_sweep || is_lone_leaf;
        if cut.stage == Stage::Nodes && (is_small || cut.depth >= MAX_DEPTH) {
            let mut opened = Growing::new(arena);
            for place in cut.places() {
                let node = opened.arena[place];
                self.order.each(self.tree, &node, &cut.clip, &mut |child| opened.push(child));
            }
            return opened.finish(&Cut { stage: Stage::References, ..cut });
        }
        cut
    }

    /// Whether a leaf costs no more than a node with the two sides as leaves, in the cost model of Table 1: a
    /// leaf costs its quartets, a node one.
    fn leaf_is_cheaper(&self, cut: &Cut, sides: &[Side; 2]) -> bool {
        if cut.count > self.rules.max_leaf {
            return false;
        }
        let leaf = |area: f32, count: u32| area * count.div_ceil(QUARTET) as f32;
        let side_cost = |side: &Side| {
            let bounds: Aabb = side.nodes.iter().map(Node::bounds).collect();
            leaf(bounds.half_area(), side.count)
        };
        leaf(cut.area, cut.count) <= cut.area + (side_cost(&sides[0]) + side_cost(&sides[1]))
    }

    /// A spatial split, if the rules allow one and prefer it to `object`.
    fn spatial_split(
        &self,
        cut: &Cut,
        nodes: &[Node],
        object: &ObjectSplit,
        weight: Weight,
        sweep: &Sweep,
        spatial_sweep: &mut SpatialSweep,
    ) -> Option<SpatialSplit> {
        if !self.splits_in_space(cut) {
            return None;
        }
        if self.rules.overlap_above.is_some_and(|least| object.overlap(nodes).half_area() <= least) {
            return None;
        }
        let limit = (object.cost * self.rules.spatial_bias).min(cut.area * weight.of(nodes.len()));
        let planes = |axis, limit| sweep.planes_below(axis, limit, weight);
        let split = spatial_sweep.below(self.isa, limit, nodes, cut.bounds, weight, planes);
        if split == SpatialSplit::NONE {
            return None;
        }
        let references: u64 = nodes
            .iter()
            .map(|node| {
                let sides =
                    u64::from(split.on_left(node.bounds())) + u64::from(split.on_right(node.bounds()));
                u64::from(node.count()) * sides
            })
            .sum();
        // What is dearer than the object split has to pay for the references that it makes.
        let growth = references as f32 / cut.count as f32;
        let is_preferred =
            split.cost < object.cost || split.cost * growth < object.cost * self.rules.spatial_bias;
        (is_preferred && references <= u64::from(cut.capacity)).then_some(split)
    }

    /// Whether spatial splits are tried in a cut. If not, they are not in any below it.
    #[inline]
    pub(crate) fn splits_in_space(&self, cut: &Cut) -> bool {
        cut.area > self.rules.spatial_above
    }

    /// The parts of a node on both sides of a spatial split.
    fn parts(&self, node: &Node, split: &SpatialSplit) -> [Option<Node>; 2] {
        let bounds = node.bounds();
        let sides = [split.on_left(bounds), split.on_right(bounds)];
        let parts = if self.rules.clip_triangles && node.is_leaf() && node.count() == 1 && sides == [true; 2]
        {
            let prim = self.order.prim(node.run().start);
            let corners = self.order.references.mesh.corners(prim);
            split_reference(&corners, bounds, split.axis, split.plane)
        } else {
            [split.left_of(bounds), split.right_of(bounds)]
        };
        // The triangle may be on one side only of a plane through its box.
        [0, 1].map(|side| (sides[side] && !parts[side].is_empty()).then(|| node.with_bounds(parts[side])))
    }

    /// Refines one side of a split into a cut of its own; both sides hold `references` in all.
    #[inline]
    fn side(
        &self,
        parent: &Cut,
        clip: Aabb,
        references: u32,
        side: &Side,
        arena: &mut Vec<Node>,
    ) -> Option<Cut> {
        let depth = parent.depth + 1;
        // Room for duplicates is handed down in proportion to what each side holds.
        let capacity = if self.splits_in_space(parent) {
            (f64::from(parent.capacity) * f64::from(side.count) / f64::from(references)) as u32
        } else {
            0
        };
        let mut cut = Growing::new(arena);
        if parent.stage == Stage::References {
            side.nodes.iter().for_each(|node| cut.push(*node));
        } else {
            self.rules.refine.refine(self.tree, &clip, depth, side, &mut cut);
        }
        let cut = cut.finish(&Cut { clip, capacity: capacity.max(side.count), depth, ..*parent });
        (cut.len > 0).then_some(cut)
    }
}

impl<R: Refine> TopDown for CutRecursion<'_, R> {
    type Seed = (OwnCut, Subtrees);
    type Part = Cut;
    type Scratch = Scratch;
    type Mark = (usize, [usize; 2]);

    fn plant(&self, (seed, from): (OwnCut, Subtrees), scratch: &mut Scratch) -> Cut {
        let cut = seed.plant(&mut scratch.arena);
        if cut.stage == Stage::Swept {
            let node = &mut scratch.arena[cut.places().start];
            *node = scratch.subtrees.graft(node, &from);
        }
        cut
    }

    fn lift(&self, cut: &Cut, scratch: &Scratch) -> (OwnCut, Subtrees) {
        let mut own = cut.lift(&scratch.arena);
        let mut subtrees = Subtrees::default();
        if cut.stage == Stage::Swept {
            own.nodes[0] = subtrees.graft(&own.nodes[0], &scratch.subtrees);
        }
        (own, subtrees)
    }

    fn approach(&self, cut: &Cut, scratch: &Scratch) {
        if cut.stage == Stage::Swept {
            return;
        }
        for node in &scratch.arena[cut.places()] {
            warm(self.tree, self.order.keys, &self.order.references, node, self.rules.auxiliary_leaf);
        }
    }

    fn count(&self, cut: &Cut) -> u32 {
        cut.count
    }

    fn half_area(&self, cut: &Cut) -> f32 {
        cut.area
    }

    fn kind(&self, cut: &Cut) -> Kind {
        cut.kind
    }

    fn split(&self, part: &Cut, scratch: &mut Scratch) -> [Option<Cut>; 2] {
        if part.stage == Stage::Swept {
            return self.children_swept(part, scratch.arena[part.places().start], scratch);
        }
        if let Some(parts) = self.split_subtree(part, scratch) {
            return parts;
        }
        if let Some(node) = self.settled(part, &scratch.arena) {
            return self.split_settled(part, &node, scratch);
        }
        let Scratch { counts, arena, sweep, spatial_sweep, sides, .. } = scratch;
        let cut = self.open_for_split(part, arena);
        if cut.len == 0 {
            return [None, None];
        }
        if cut.kind == Kind::Leaf {
            return [Some(cut), None];
        }
        counts.splits += 1;
        counts.swept += cut.len as u64;
        let nodes = &arena[cut.places()];
        let weight = if cut.stage == Stage::References { Weight::Quartets } else { Weight::Nodes };

        // Find: the cheapest object split, and a spatial one where it is cheaper still.
        let halve = cut.depth >= MAX_DEPTH;
        let object = if halve { ObjectSplit::NONE } else { sweep.best(self.isa, nodes, cut.bounds, weight) };
        let spatial =
            if halve { None } else { self.spatial_split(&cut, nodes, &object, weight, sweep, spatial_sweep) };

        // Reorder: the nodes to the left and to the right, clipped by the plane of a spatial split.
        sides.iter_mut().for_each(Side::clear);
        let mut clips = [cut.clip; 2];
        if let Some(split) = spatial {
            counts.spatial_splits += 1;
            for place in cut.places() {
                let parts = self.parts(&arena[place], &split);
                for (side, part) in sides.iter_mut().zip(parts) {
                    part.into_iter().for_each(|part| side.push(part));
                }
            }
            clips = [split.left_of(cut.clip), split.right_of(cut.clip)];
        } else if object.left > 0 {
            Side::part(sides, nodes, object.members(nodes));
        } else {
            // Nothing is gained by any split: halve in the order of the Morton codes.
            Side::part(sides, nodes, |i, _| i < nodes.len() / 2);
        }

        if part.kind != Kind::SoftLeaf && self.leaf_is_cheaper(&cut, sides) {
            return [Some(Cut { kind: Kind::SoftLeaf, ..cut }), None];
        }

        // Refine.
        let references = sides[0].count + sides[1].count;
        [0, 1].map(|i| self.side(&cut, clips[i], references, &sides[i], arena))
    }

    fn leaf(&self, cut: &Cut, prims: &mut Vec<u32>, scratch: &mut Scratch) -> Aabb {
        self.gather(cut, prims, scratch, |_, bounds| Some(bounds))
    }

    fn visible_leaf(&self, cut: &Cut, prims: &mut Vec<u32>, scratch: &mut Scratch) -> Aabb {
        let mesh = self.order.references.mesh;
        self.gather(cut, prims, scratch, |prim, bounds| visible(mesh, prim, bounds))
    }

    fn finish(&self, cut: &Cut, piece: &mut Piece, scratch: &mut Scratch) -> Option<Subtree> {
        if let Some(costs) = &self.rules.collapse {
            return Some(self.collapse(cut, costs, piece, scratch));
        }
        if cut.stage == Stage::Swept {
            let node = scratch.arena[cut.places().start];
            return Some(self.wide(&node, cut.kind, &scratch.subtrees, piece));
        }
        if let Some(subtree) = self.finish_subtree(cut, piece, scratch) {
            return Some(subtree);
        }
        let node = self.settled(cut, &scratch.arena)?;
        self.finish_settled(cut, &node, piece, &mut scratch.counts)
    }

    fn mark(&self, scratch: &Scratch) -> Self::Mark {
        (scratch.arena.len(), scratch.subtrees.mark())
    }

    fn release(&self, scratch: &mut Scratch, (arena, subtrees): Self::Mark) {
        scratch.arena.truncate(arena);
        scratch.subtrees.release(subtrees);
    }
}
