//! Building from a hierarchy: split a cut of the auxiliary BVH, refine both sides, recurse (paper 3.2, Figure 3).
//! How a side is refined is all in which PHR and the method of Hunt et al. differ.

use super::Counts;
use super::binary::{BinaryTree, Node};
use super::cut::{Cut, Order, OwnCut, is_whole, open};
use super::object_split::{ObjectSplit, Sweep};
use super::prefetch::warm;
use super::reference_split::{split_reference, visible};
use super::small_sweep::Isa;
use super::spatial_split::{SpatialSplit, SpatialSweep};
use super::split_cost::Weight;
use super::top_down::{Kind, QUARTET, TopDown};
use crate::geometry::Aabb;

/// From this many binary splits on, the references left are halved by count: no input makes the tree deeper
/// than traversal stacks allow.
const MAX_DEPTH: u32 = 50;

/// How a cut is refined after a split.
pub(super) trait Refine: Sync {
    /// Appends the nodes of a side of a split at binary depth `depth` to `refined`, some of them opened
    /// ([`open`]).
    fn refine(
        &self,
        tree: &BinaryTree,
        clip: &Aabb,
        depth: u32,
        side: &mut Vec<Node>,
        refined: &mut Vec<Node>,
    );
}

/// What one builder over cuts does otherwise than another.
pub(super) struct Rules<R> {
    /// How cuts are refined.
    pub refine: R,
    /// Nodes of a larger half area are opened for the initial cut,
    pub initial_threshold: f32,
    /// while it has fewer nodes than this.
    pub initial_len: usize,
    /// Spatial splits are tried for nodes of a larger half area; infinite for none.
    pub spatial_above: f32,
    /// Most references per reference that spatial splits may make.
    pub max_references: f32,
    /// Most triangles of a leaf.
    pub max_leaf: u32,
    /// Cuts of at most so many references are opened down to them, and their splits count quartets.
    pub leaf_sweep: u32,
    /// Where a spatial split cuts a node of a single reference, its triangle is clipped and not only its box.
    pub clip_triangles: bool,
}

/// The recursion over cuts.
pub(super) struct CutRecursion<'a, R> {
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
pub(super) struct Scratch {
    /// What was counted since it was last taken.
    pub counts: Counts,
    /// The nodes of all cuts in use.
    arena: Vec<Node>,
    sweep: Sweep,
    spatial_sweep: SpatialSweep,
    sides: [Vec<Node>; 2],
}

impl<R: Refine> CutRecursion<'_, R> {
    /// The whole scene as a cut.
    pub fn root(&self) -> Option<OwnCut> {
        let root = self.tree.root?;
        let nodes = Cut::initial(self.tree, root, self.rules.initial_threshold, self.rules.initial_len);
        Some(Cut::whole(nodes, self.rules.max_references))
    }

    /// Opens what must be before a cut can be split: a lone node, whatever the threshold; all nodes, near the
    /// leaves or where the tree gets too deep.
    fn open_for_split(&self, cut: &Cut, arena: &mut Vec<Node>) -> Cut {
        let first = arena.len();
        let near_leaves = cut.count <= self.rules.leaf_sweep;
        if !cut.is_near_leaves && (near_leaves || cut.depth >= MAX_DEPTH) {
            for place in cut.places() {
                let node = arena[place];
                self.order.each(self.tree, &node, &cut.clip, &mut |child| arena.push(child));
            }
            let like = Cut { is_near_leaves: true, ..*cut };
            return Cut::of_arena(arena, first, like);
        }
        let mut cut = *cut;
        while cut.len == 1 {
            let node = arena[cut.places().start];
            if node.is_leaf() {
                break;
            }
            let first = arena.len();
            open(self.tree, &node, &cut.clip, |child| arena.push(child));
            cut = Cut::of_arena(arena, first, cut);
        }
        cut
    }

    /// Whether a leaf costs no more than a node with the two sides as leaves, in the cost model of Table 1: a
    /// leaf costs its quartets, a node one.
    fn leaf_is_cheaper(&self, cut: &Cut, sides: [&[Node]; 2]) -> bool {
        if cut.count > self.rules.max_leaf {
            return false;
        }
        let leaf = |bounds: Aabb, count: u32| bounds.half_area() * count.div_ceil(QUARTET) as f32;
        let side_cost = |side: &[Node]| {
            leaf(side.iter().map(Node::bounds).collect(), side.iter().map(|node| node.count).sum())
        };
        let area = cut.bounds.half_area();
        leaf(cut.bounds, cut.count) <= area + sides.map(side_cost).iter().sum::<f32>()
    }

    /// A spatial split, if the rules allow one that is cheaper than `object`.
    fn spatial_split(
        &self,
        cut: &Cut,
        nodes: &[Node],
        object: &ObjectSplit,
        weight: Weight,
        sweep: &mut SpatialSweep,
    ) -> Option<SpatialSplit> {
        let area = cut.bounds.half_area();
        if area <= self.rules.spatial_above {
            return None;
        }
        let limit = object.cost.min(area * weight.of(nodes.len()));
        let split = sweep.below(limit, nodes, cut.bounds, weight);
        if split == SpatialSplit::NONE {
            return None;
        }
        let references: u64 = nodes
            .iter()
            .map(|node| {
                let sides =
                    u64::from(split.on_left(node.bounds())) + u64::from(split.on_right(node.bounds()));
                u64::from(node.count) * sides
            })
            .sum();
        (references <= u64::from(cut.capacity)).then_some(split)
    }

    /// The parts of a node on both sides of a spatial split.
    fn parts(&self, node: &Node, split: &SpatialSplit) -> [Option<Node>; 2] {
        let bounds = node.bounds();
        let sides = [split.on_left(bounds), split.on_right(bounds)];
        let parts = if self.rules.clip_triangles && node.is_leaf() && node.count == 1 && sides == [true; 2] {
            let prim = self.order.prim(node.run().start);
            let corners = self.order.references.mesh.corners(prim);
            split_reference(&corners, bounds, split.axis, split.plane)
        } else {
            [split.left_of(bounds), split.right_of(bounds)]
        };
        // The triangle may be on one side only of a plane through its box.
        [0, 1].map(|side| (sides[side] && !parts[side].is_empty()).then(|| node.with_bounds(parts[side])))
    }

    /// Refines one side of a split into a cut of its own.
    fn side(
        &self,
        parent: &Cut,
        clip: Aabb,
        references: u32,
        side: &mut Vec<Node>,
        arena: &mut Vec<Node>,
    ) -> Option<Cut> {
        let own: u32 = side.iter().map(|node| node.count).sum();
        let depth = parent.depth + 1;
        // Room for duplicates is handed down in proportion to what each side holds.
        let capacity = (f64::from(parent.capacity) * f64::from(own) / f64::from(references)) as u32;
        let first = arena.len();
        if parent.is_near_leaves {
            arena.append(side);
        } else {
            self.rules.refine.refine(self.tree, &clip, depth, side, arena);
        }
        let like = Cut { clip, capacity: capacity.max(own), depth, ..*parent };
        let cut = Cut::of_arena(arena, first, like);
        (cut.len > 0).then_some(cut)
    }

    /// Appends the triangles of a leaf; returns their box. Of a triangle that is not wholly inside the clip box
    /// `seen` tells what the leaf sees, given the box of its part.
    fn gather(
        &self,
        cut: &Cut,
        prims: &mut Vec<u32>,
        arena: &[Node],
        seen: impl Fn(u32, Aabb) -> Option<Aabb>,
    ) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for node in &arena[cut.places()] {
            if is_whole(node, &cut.clip) {
                bounds = bounds.union(node.bounds());
                prims.extend(self.tree.run(node).map(|place| self.order.prim(place)));
            } else {
                self.order.each(self.tree, node, &cut.clip, &mut |reference| {
                    let prim = self.order.prim(reference.run().start);
                    if let Some(part) = seen(prim, reference.bounds()) {
                        bounds = bounds.union(part);
                        prims.push(prim);
                    }
                });
            }
        }
        if !self.order.references.fragments.is_empty() {
            // Parts of one triangle may meet in a leaf.
            prims.sort_unstable();
            prims.dedup();
        }
        bounds
    }
}

impl<R: Refine> TopDown for CutRecursion<'_, R> {
    type Seed = OwnCut;
    type Part = Cut;
    type Scratch = Scratch;

    fn plant(&self, seed: OwnCut, scratch: &mut Scratch) -> Cut {
        seed.plant(&mut scratch.arena)
    }

    fn lift(&self, cut: &Cut, scratch: &Scratch) -> OwnCut {
        cut.lift(&scratch.arena)
    }

    fn approach(&self, cut: &Cut, scratch: &Scratch) {
        for node in &scratch.arena[cut.places()] {
            warm(self.tree, self.order.keys, &self.order.references, node);
        }
    }

    fn count(&self, cut: &Cut) -> u32 {
        cut.count
    }

    fn half_area(&self, cut: &Cut) -> f32 {
        cut.bounds.half_area()
    }

    fn kind(&self, cut: &Cut) -> Kind {
        cut.kind
    }

    fn split(&self, part: &Cut, scratch: &mut Scratch) -> [Option<Cut>; 2] {
        let Scratch { counts, arena, sweep, spatial_sweep, sides: [left, right] } = scratch;
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
        let weight = if cut.is_near_leaves { Weight::Quartets } else { Weight::Nodes };

        // Find: the cheapest object split, and a spatial one where it is cheaper still.
        let halve = cut.depth >= MAX_DEPTH;
        let object = if halve { ObjectSplit::NONE } else { sweep.best(self.isa, nodes, cut.bounds, weight) };
        let spatial =
            if halve { None } else { self.spatial_split(&cut, nodes, &object, weight, spatial_sweep) };

        // Reorder: the nodes to the left and to the right, clipped by the plane of a spatial split.
        left.clear();
        right.clear();
        let mut clips = [cut.clip; 2];
        if let Some(split) = spatial {
            counts.spatial_splits += 1;
            for node in nodes {
                let [on_left, on_right] = self.parts(node, &split);
                left.extend(on_left);
                right.extend(on_right);
            }
            clips = [split.left_of(cut.clip), split.right_of(cut.clip)];
        } else if object.left > 0 {
            let is_left = object.members(nodes);
            for (i, node) in nodes.iter().enumerate() {
                if is_left(i, node) { left.push(*node) } else { right.push(*node) }
            }
        } else {
            // Nothing is gained by any split: halve in the order of the Morton codes.
            let (a, b) = nodes.split_at(nodes.len() / 2);
            left.extend_from_slice(a);
            right.extend_from_slice(b);
        }

        if part.kind != Kind::SoftLeaf && self.leaf_is_cheaper(&cut, [left, right]) {
            return [Some(Cut { kind: Kind::SoftLeaf, ..cut }), None];
        }

        // Refine.
        let references = left.iter().chain(right.iter()).map(|node| node.count).sum();
        [
            self.side(&cut, clips[0], references, left, arena),
            self.side(&cut, clips[1], references, right, arena),
        ]
    }

    fn leaf(&self, cut: &Cut, prims: &mut Vec<u32>, scratch: &mut Scratch) -> Aabb {
        self.gather(cut, prims, &scratch.arena, |_, bounds| Some(bounds))
    }

    fn visible_leaf(&self, cut: &Cut, prims: &mut Vec<u32>, scratch: &mut Scratch) -> Aabb {
        let mesh = self.order.references.mesh;
        self.gather(cut, prims, &scratch.arena, |prim, bounds| visible(mesh, prim, bounds))
    }

    fn mark(&self, scratch: &Scratch) -> usize {
        scratch.arena.len()
    }

    fn release(&self, scratch: &mut Scratch, mark: usize) {
        scratch.arena.truncate(mark);
    }
}
