//! The steps of a build, each on its own, for `benches/steps.rs`: no stable interface.

use crate::builders::binary::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::builder::Phase;
use crate::builders::lbvh::auxiliary::{Auxiliary, AuxiliaryConfig};
use crate::builders::lbvh::sort::reference;
use crate::builders::phr::cut::{Growing, SPACE};
use crate::builders::phr::initial_cut::initial_cut;
use crate::builders::phr::policy::Refine;
use crate::builders::phr::side::Side;
use crate::builders::phr::{PhrConfig, Threshold};
use crate::builders::split::cost::Weight;
use crate::builders::split::object::bins::Bins;
use crate::builders::split::object::lanes::{self, Isa};
use crate::builders::split::object::ranks::{self, RankSweep};
use crate::builders::split::object::{ObjectSplit, Sweep};
use crate::builders::split::spatial::{SpatialSweep, anywhere};
use crate::builders::split::sweep_sah::SubtreeSweep;
use crate::builders::wide::top_down::{QUARTET, WIDTH};
use crate::builders::wide::treelet::Piece;
use crate::bvh::{Link, TriangleBlock, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::parallel::ordered_append::Batch;

/// Levels over which [`Steps::refine`] halves and refines.
const LEVELS: u32 = 16;

/// What a step must read and write at least.
#[derive(Clone, Copy, Debug)]
pub struct Traffic {
    /// Bytes read.
    pub read: usize,
    /// Bytes written.
    pub written: usize,
}

/// A mesh with its auxiliary BVH, and the memory of the steps after it.
pub struct Steps<'a> {
    mesh: &'a Mesh,
    auxiliary: Auxiliary,
    threshold: Threshold,
    prims: Vec<u32>,
    children: Vec<[(Aabb, Link); WIDTH]>,
    piece: Piece,
    initial: Vec<Node>,
    arena: Vec<Node>,
    side: Side,
    subtree_sweep: SubtreeSweep,
    subtrees: Subtrees,
}

impl<'a> Steps<'a> {
    /// Of a mesh of more than four triangles; leaves of the auxiliary BVH hold at most `leaf` triangles.
    pub fn new(mesh: &'a Mesh, leaf: u32) -> Self {
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(mesh, &AuxiliaryConfig { leaf, ..AuxiliaryConfig::PAPER });
        let children = auxiliary.tree.pairs.chunks_exact(2).map(|pairs| {
            let link = |node: &Node| (node.bounds(), Link::inner(node.pair().unwrap_or_default()));
            [link(&pairs[0][0]), link(&pairs[0][1]), link(&pairs[1][0]), link(&pairs[1][1])]
        });
        let threshold = Threshold::new(auxiliary.areas.scene, &PhrConfig::FAST);
        let cut = |root| initial_cut(&auxiliary.tree, root, threshold.at(0), PhrConfig::FAST.max_cut);
        Self {
            initial: auxiliary.tree.root.map_or_else(Vec::new, cut),
            children: children.collect(),
            prims: auxiliary.order.keys.iter().map(|&key| reference(key)).collect(),
            threshold,
            mesh,
            auxiliary,
            piece: Piece::default(),
            arena: Vec::new(),
            side: Side::default(),
            subtree_sweep: SubtreeSweep::default(),
            subtrees: Subtrees::default(),
        }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.mesh.len()
    }

    /// Builds the auxiliary BVH again; the durations of its phases, "codes", "sort" and "auxiliary tree" among
    /// them.
    pub fn auxiliary(&mut self, leaf: u32) -> Vec<Phase> {
        self.auxiliary.build(self.mesh, &AuxiliaryConfig { leaf, ..AuxiliaryConfig::PAPER })
    }

    /// Of "codes", "sort" (each key moved but once) or "auxiliary tree"; `None` of others.
    pub fn auxiliary_traffic(&self, phase: &str) -> Option<Traffic> {
        let mesh = size_of_val(self.mesh.triangles()) + size_of_val(self.mesh.padded_vertices());
        let keys = size_of_val(&self.auxiliary.order.keys[..]);
        let pairs = size_of_val(&self.auxiliary.tree.pairs[..]);
        Some(match phase {
            "codes" => Traffic { read: mesh, written: keys },
            "sort" => Traffic { read: keys, written: keys },
            "auxiliary tree" => Traffic { read: mesh + keys, written: pairs },
            _ => return None,
        })
    }

    /// Cuts of `len` nodes, from all over the auxiliary BVH, together of at most `nodes` nodes.
    pub fn cuts(&self, len: usize, nodes: usize) -> Cuts {
        let tree = &self.auxiliary.tree;
        let mut cuts = Cuts { len, nodes: Vec::new(), bounds: Vec::new(), limits: Vec::new() };
        let Some(root) = tree.root else { return cuts };
        for subtree in initial_cut(tree, root, 0.0, nodes / len) {
            let cut = initial_cut(tree, subtree, 0.0, len);
            if cut.len() == len {
                cuts.bounds.push(cut.iter().map(Node::bounds).collect());
                cuts.nodes.extend(cut);
            }
        }
        let mut sweep = Sweep::default();
        cuts.limits = cuts
            .each()
            .map(|(nodes, bounds)| sweep.best(Isa::best(), nodes, bounds, Weight::Nodes).cost)
            .collect();
        cuts
    }

    /// Refines the initial cut by PHR-Fast's rule: it is halved by count, and the halves are refined and halved
    /// again, some levels down. Returns the number of nodes handed to the rule.
    pub fn refine(&mut self) -> usize {
        self.arena.clear();
        self.arena.extend_from_slice(&self.initial);
        self.refine_halves(0, 1)
    }

    fn refine_halves(&mut self, first: usize, depth: u32) -> usize {
        let len = self.arena.len() - first;
        if len < 2 || depth > LEVELS {
            return 0;
        }
        let mut refined = len;
        for half in [first..first + len / 2, first + len / 2..first + len] {
            self.side.clear();
            self.arena[half].iter().for_each(|node| self.side.push(*node));
            let begin = self.arena.len();
            let mut cut = Growing::new(&mut self.arena);
            self.threshold.refine(&self.auxiliary.tree, &SPACE, depth, &self.side, &mut cut);
            refined += self.refine_halves(begin, depth + 1);
            self.arena.truncate(begin);
        }
        refined
    }

    /// Splits runs of `len` triangles in Morton order down to quartets, each in one go; `len` is at most 256. Returns
    /// the number of pairs of siblings.
    pub fn subtrees(&mut self, len: usize) -> usize {
        self.subtrees.release([0; 2]);
        for prims in self.prims.chunks(len) {
            self.subtree_sweep.clear();
            prims.iter().for_each(|&prim| self.subtree_sweep.push(self.mesh.bounds_of(prim), prim));
            self.subtree_sweep.build(Isa::best(), &mut self.subtrees);
        }
        self.subtrees.pairs.len()
    }

    /// Of [`Steps::subtrees`], once for runs of that length.
    pub fn subtree_traffic(&self) -> Traffic {
        let Traffic { read, .. } = self.leaf_block_traffic();
        Traffic { read, written: size_of_val(&self.subtrees.pairs[..]) + size_of_val(&self.prims[..]) }
    }

    /// Writes all triangles into leaf blocks, in Morton order; returns the number of blocks.
    pub fn leaf_blocks(&mut self) -> usize {
        self.piece.clear();
        self.prims.chunks(QUARTET as usize).filter_map(|prims| self.piece.leaf(self.mesh, prims)).count()
    }

    /// Of [`Steps::leaf_blocks`].
    pub fn leaf_block_traffic(&self) -> Traffic {
        let mesh = size_of_val(self.mesh.triangles()) + size_of_val(self.mesh.padded_vertices());
        let blocks = self.prims.len().div_ceil(QUARTET as usize);
        Traffic { read: mesh + size_of_val(&self.prims[..]), written: blocks * size_of::<TriangleBlock>() }
    }

    /// Writes a wide node over each two pairs of the auxiliary BVH; returns the number of nodes.
    pub fn wide_nodes(&mut self) -> usize {
        self.piece.clear();
        for children in &self.children {
            self.piece.node(children);
        }
        self.children.len()
    }

    /// Of [`Steps::wide_nodes`].
    pub fn wide_node_traffic(&self) -> Traffic {
        let written = self.children.len() * size_of::<WideNode<WIDTH>>();
        Traffic { read: size_of_val(&self.children[..]), written }
    }
}

/// How the object split of a cut is found. All find the same one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// As in a build: the fastest.
    Chosen,
    /// All nodes sorted along each axis and swept, in scalar code.
    Sorted,
    /// Bounded by bins.
    Binned,
    /// By ranks that are counted in vectors.
    Ranked,
    /// In vectors of eight lanes.
    Avx2,
    /// In vectors of sixteen lanes.
    Avx512,
}

impl Way {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Chosen, Self::Sorted, Self::Binned, Self::Ranked, Self::Avx2, Self::Avx512];

    /// Whether this processor can split a cut of `len` nodes so.
    pub fn splits(self, len: usize) -> bool {
        match self {
            Self::Chosen | Self::Sorted => true,
            Self::Binned => len > 2,
            Self::Ranked => Isa::best() != Isa::Scalar && len <= ranks::LONGEST,
            Self::Avx2 => Isa::best() != Isa::Scalar && len <= Isa::Avx2.longest(),
            Self::Avx512 => Isa::best() == Isa::Avx512 && len <= Isa::Avx512.longest(),
        }
    }
}

/// Cuts, all of one length.
pub struct Cuts {
    len: usize,
    nodes: Vec<Node>,
    bounds: Vec<Aabb>,
    /// What the best object splits cost.
    limits: Vec<f32>,
}

impl Cuts {
    fn each(&self) -> impl Iterator<Item = (&[Node], Aabb)> {
        self.nodes.chunks_exact(self.len).zip(self.bounds.iter().copied())
    }

    /// Nodes of all cuts.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Of any sweep.
    pub fn traffic(&self) -> Traffic {
        Traffic { read: size_of_val(&self.nodes[..]), written: 0 }
    }

    /// Finds the object split of each cut by a way that [`Way::splits`] such; returns the number of cuts for
    /// which there is none, so that nothing is left out.
    pub fn object_splits(&self, way: Way) -> usize {
        assert!(way.splits(self.len), "{way:?} does not split cuts of {} nodes", self.len);
        let (weight, n) = (Weight::Nodes, self.len);
        let (mut chosen, mut sorted) = (Sweep::default(), Sweep::plain());
        let (mut bins, mut ranks) = (Bins::default(), RankSweep::default());
        let best = |(nodes, bounds): (&[Node], Aabb)| match way {
            Way::Chosen => chosen.best(Isa::best(), nodes, bounds, weight),
            Way::Sorted => sorted.best(Isa::Scalar, nodes, bounds, weight),
            Way::Binned => bins.best(nodes, weight.limit(bounds.half_area(), n), weight),
            Way::Ranked => ranks.best(Isa::best(), nodes, weight.limit(bounds.half_area(), n), weight),
            Way::Avx2 => lanes::best(Isa::Avx2, nodes, weight.limit(bounds.half_area(), n), weight),
            Way::Avx512 => lanes::best(Isa::Avx512, nodes, weight.limit(bounds.half_area(), n), weight),
        };
        self.each().map(best).filter(|split| *split == ObjectSplit::NONE).count()
    }

    /// Finds the spatial split of each cut, where `bounded` only if it is cheaper than the object split, as a
    /// build does; returns the number of splits.
    pub fn spatial_splits(&self, bounded: bool) -> usize {
        let mut sweep = SpatialSweep::default();
        let limits = self.limits.iter().map(|&limit| if bounded { limit } else { f32::INFINITY });
        let split = |((nodes, bounds), limit)| {
            sweep.below(Isa::best(), limit, nodes, bounds, Weight::Nodes, anywhere).cost < limit
        };
        self.each().zip(limits).map(split).filter(|&found| found).count()
    }
}
