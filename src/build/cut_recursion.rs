//! Building from a hierarchy: split a cut of the auxiliary BVH, refine both sides, recurse (paper 3.2, Figure 3).
//! How a side is refined is all in which PHR and the method of Hunt et al. differ.

use super::binary::{BinaryTree, Node};
use super::cut::{Cut, SPACE, gather, open};
use super::lbvh::Auxiliary;
use super::object_split::{ObjectSplit, Sweep};
use super::spatial_split::{SpatialSplit, SpatialSweep};
use super::top_down::{self, Pool, QUARTET, TopDown};
use super::{Build, Counts, Stopwatch};
use crate::geometry::{Aabb, Mesh};

/// From this many binary splits on, the triangles left are halved by count: no input makes the tree deeper
/// than traversal stacks allow.
const MAX_DEPTH: u32 = 50;

/// How a cut is refined after a split.
pub(super) trait Refine: Sync {
    /// Moves the nodes of a side of a split at binary depth `depth` from `side` to `refined`, some of them
    /// opened ([`open`]).
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
    /// Most references per triangle that spatial splits may make.
    pub max_references: f32,
    /// Most triangles of a leaf.
    pub max_leaf: u32,
}

/// The recursion over cuts.
pub(super) struct CutRecursion<'a, R> {
    tree: &'a BinaryTree,
    rules: Rules<R>,
}

/// An auxiliary BVH and the memory to build over its cuts, kept from build to build.
#[derive(Default)]
pub(super) struct Hierarchy {
    auxiliary: Auxiliary,
    pool: Pool<Scratch>,
}

impl Hierarchy {
    /// Builds over `mesh` by the rules made for the scene's box.
    pub fn build<R: Refine>(&mut self, mesh: &Mesh, rules: impl FnOnce(Aabb) -> Rules<R>) -> Build {
        let mut phases = self.auxiliary.build(mesh);
        let mut watch = Stopwatch::start();
        let tree = &self.auxiliary.tree;
        let recursion = CutRecursion { tree, rules: rules(self.auxiliary.order.primitives.bounds) };
        let root = tree.root.map(|root| recursion.root(root));
        let tree = top_down::build(&recursion, root, mesh, &self.pool);
        watch.lap("cuts and nodes");
        phases.extend(watch.phases);
        Build::finish(tree, phases, self.counts(mesh), self.auxiliary.bytes() + self.pool.bytes())
    }

    /// Adds up what the tasks counted.
    fn counts(&self, mesh: &Mesh) -> Counts {
        let mut counts = Counts { auxiliary_nodes: 2 * mesh.len() as u64, ..Counts::default() };
        self.pool.for_each_scratch(|scratch| {
            let of_task = std::mem::take(&mut scratch.counts);
            counts.splits += of_task.splits;
            counts.spatial_splits += of_task.spatial_splits;
            counts.swept += of_task.swept;
        });
        counts
    }
}

/// Memory and counts of one task.
#[derive(Default)]
pub(super) struct Scratch {
    /// What was counted since it was last taken.
    counts: Counts,
    sweep: Sweep,
    spatial_sweep: SpatialSweep,
    is_left: Vec<bool>,
    sides: [Vec<Node>; 2],
    /// Memory of cuts no longer in use.
    spare: Vec<Vec<Node>>,
}

impl<R: Refine> CutRecursion<'_, R> {
    /// The whole scene as a cut.
    fn root(&self, root: Node) -> Cut {
        let nodes = Cut::initial(self.tree, root, self.rules.initial_threshold, self.rules.initial_len);
        let count: u32 = nodes.iter().map(|node| node.count).sum();
        let bounds = nodes.iter().map(Node::bounds).collect();
        let capacity = (count as f32 * self.rules.max_references) as u32;
        Cut { nodes, clip: SPACE, bounds, count, capacity, depth: 0, is_leaf: count <= QUARTET }
    }

    /// Opens a cut of one node, whatever the threshold, until there is something to split.
    fn open_single(&self, cut: &mut Cut) {
        while let &[node] = &cut.nodes[..]
            && !node.is_leaf()
        {
            cut.nodes.clear();
            open(self.tree, &node, &cut.clip, |child| cut.nodes.push(child));
        }
        self.measure(cut);
    }

    /// Opens a cut down to its triangles.
    fn open_fully(&self, cut: &mut Cut) {
        let mut i = 0;
        while i < cut.nodes.len() {
            if cut.nodes[i].is_leaf() {
                i += 1;
            } else {
                let node = cut.nodes.swap_remove(i);
                open(self.tree, &node, &cut.clip, |child| cut.nodes.push(child));
            }
        }
        self.measure(cut);
    }

    fn measure(&self, cut: &mut Cut) {
        cut.bounds = cut.nodes.iter().map(Node::bounds).collect();
        cut.count = cut.nodes.iter().map(|node| node.count).sum();
        cut.is_leaf = cut.count <= QUARTET;
    }

    /// Whether a leaf costs no more than a node with the two sides as leaves, in the cost model of Table 1: a
    /// leaf costs its quartets, a node one.
    fn leaf_is_cheaper(&self, cut: &Cut, sides: [&[Node]; 2]) -> bool {
        let leaf = |area: f32, count: u32| area * count.div_ceil(QUARTET) as f32;
        let side_cost = |side: &[Node]| {
            let bounds: Aabb = side.iter().map(Node::bounds).collect();
            leaf(bounds.half_area(), side.iter().map(|node| node.count).sum())
        };
        let area = cut.bounds.half_area();
        cut.count <= self.rules.max_leaf
            && leaf(area, cut.count) <= area + sides.map(side_cost).iter().sum::<f32>()
    }

    /// A spatial split, if the rules allow one that is cheaper than `object`.
    fn spatial_split(&self, cut: &Cut, object: &ObjectSplit, scratch: &mut Scratch) -> Option<SpatialSplit> {
        let area = cut.bounds.half_area();
        if area <= self.rules.spatial_above {
            return None;
        }
        let split = scratch.spatial_sweep.best(&cut.nodes, cut.bounds);
        let references: u64 = cut
            .nodes
            .iter()
            .map(|node| {
                let sides =
                    u64::from(split.on_left(node.bounds())) + u64::from(split.on_right(node.bounds()));
                u64::from(node.count) * sides
            })
            .sum();
        let gains = split.cost < object.cost && split.cost < area * cut.nodes.len() as f32;
        (gains && references <= u64::from(cut.capacity)).then_some(split)
    }

    /// Refines one side of a split into a cut of its own.
    fn side(
        &self,
        parent: &Cut,
        clip: Aabb,
        references: u32,
        side: &mut Vec<Node>,
        scratch: &mut Scratch,
    ) -> Option<Cut> {
        let own: u32 = side.iter().map(|node| node.count).sum();
        let mut nodes = scratch.spare.pop().unwrap_or_default();
        let depth = parent.depth + 1;
        self.rules.refine.refine(self.tree, &clip, depth, side, &mut nodes);
        // Room for duplicates is handed down in proportion to what each side holds.
        let capacity = (f64::from(parent.capacity) * f64::from(own) / f64::from(references)) as u32;
        let mut cut = Cut {
            nodes,
            clip,
            bounds: Aabb::EMPTY,
            count: 0,
            capacity: capacity.max(own),
            depth,
            is_leaf: false,
        };
        self.measure(&mut cut);
        if cut.nodes.is_empty() {
            scratch.spare.push(cut.nodes);
            return None;
        }
        Some(cut)
    }
}

impl<R: Refine> TopDown for CutRecursion<'_, R> {
    type Part = Cut;
    type Scratch = Scratch;

    fn count(&self, cut: &Cut) -> u32 {
        cut.count
    }

    fn is_leaf(&self, cut: &Cut) -> bool {
        cut.is_leaf
    }

    fn half_area(&self, cut: &Cut) -> f32 {
        cut.bounds.half_area()
    }

    fn split(&self, mut cut: Cut, scratch: &mut Scratch) -> [Option<Cut>; 2] {
        if cut.nodes.len() == 1 {
            self.open_single(&mut cut);
        } else if cut.depth >= MAX_DEPTH {
            self.open_fully(&mut cut);
        }
        if cut.nodes.is_empty() {
            return [None, None];
        }
        if cut.is_leaf {
            return [Some(cut), None];
        }
        scratch.counts.splits += 1;
        scratch.counts.swept += cut.nodes.len() as u64;

        // Find: the cheapest object split, and a spatial one where it is cheaper still.
        let halve = cut.depth >= MAX_DEPTH;
        let object = if halve { ObjectSplit::NONE } else { scratch.sweep.best(&cut.nodes, cut.bounds) };
        let spatial = if halve { None } else { self.spatial_split(&cut, &object, scratch) };

        // Reorder: the nodes to the left and to the right, clipped by the plane of a spatial split.
        let [mut left, mut right] = std::mem::take(&mut scratch.sides);
        let mut clips = [cut.clip; 2];
        if let Some(split) = spatial {
            scratch.counts.spatial_splits += 1;
            for node in &cut.nodes {
                let bounds = node.bounds();
                if split.on_left(bounds) {
                    left.push(node.with_bounds(split.left_of(bounds)));
                }
                if split.on_right(bounds) {
                    right.push(node.with_bounds(split.right_of(bounds)));
                }
            }
            clips = [split.left_of(cut.clip), split.right_of(cut.clip)];
        } else if object.left > 0 {
            scratch.sweep.mark_left(&object, &mut scratch.is_left);
            for (node, &is_left) in cut.nodes.iter().zip(&scratch.is_left) {
                if is_left { left.push(*node) } else { right.push(*node) }
            }
        } else {
            // Nothing is gained by any split: halve in the order of the Morton codes.
            let (a, b) = cut.nodes.split_at(cut.nodes.len() / 2);
            left.extend_from_slice(a);
            right.extend_from_slice(b);
        }

        if self.leaf_is_cheaper(&cut, [&left, &right]) {
            left.clear();
            right.clear();
            scratch.sides = [left, right];
            cut.is_leaf = true;
            return [Some(cut), None];
        }

        // Refine.
        let references = left.iter().chain(&right).map(|node| node.count).sum();
        let sides = [
            self.side(&cut, clips[0], references, &mut left, scratch),
            self.side(&cut, clips[1], references, &mut right, scratch),
        ];
        left.clear();
        right.clear();
        scratch.sides = [left, right];
        cut.nodes.clear();
        scratch.spare.push(cut.nodes);
        sides
    }

    fn leaf(&self, mut cut: Cut, ids: &mut Vec<u32>, scratch: &mut Scratch) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for node in &cut.nodes {
            gather(self.tree, node, &cut.clip, ids, &mut bounds);
        }
        cut.nodes.clear();
        scratch.spare.push(cut.nodes);
        bounds
    }
}
