//! The steps of a build, each on its own, for `benches/steps.rs`: no stable interface. [`watch`] shows the splits of a
//! whole build, [`split_boxes`] is one of them.

pub mod split_boxes;
pub mod watch;

use super::api::builder::Phase;
use crate::builders::binary::node::Node;
use crate::builders::binary::subtrees::Subtrees;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::lbvh::key::reference;
use crate::builders::phr::config::PhrConfig;
use crate::builders::phr::cut::{CutBuilder, SPACE, Side};
use crate::builders::phr::initial_cut::initial_cut;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::refine::Threshold;
use crate::builders::split::cost::Weight;
use crate::builders::split::object::bins::Bins;
use crate::builders::split::object::full_sweep::FullSweep;
use crate::builders::split::object::lanes;
use crate::builders::split::object::ranks::{self, RankSweep};
use crate::builders::split::object::split::ObjectSplit;
use crate::builders::split::object::strategy::ObjectSweep;
use crate::builders::split::spatial::strategy::SpatialSweep;
use crate::builders::split::subtree_sweep::SubtreeSweep;
use crate::builders::wide::treelet::WideTreelet;
use crate::bvh::limits::BLOCK;
use crate::bvh::{Link, TriangleBlock, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::parallel::ordered_append::Chunk;
use crate::simd::Isa;

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
    children: Vec<[(Aabb, Link); 4]>,
    treelet: WideTreelet<4>,
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
        auxiliary.build(mesh, &of_leaves(leaf));
        let children = auxiliary.tree.pairs.chunks_exact(2).map(|pairs| {
            let link = |node: &Node| (node.bounds(), Link::inner(node.pair().unwrap_or_default()));
            [link(&pairs[0][0]), link(&pairs[0][1]), link(&pairs[1][0]), link(&pairs[1][1])]
        });
        let threshold = Threshold::new(auxiliary.scale.scene, &PhrConfig::FAST);
        let cut = |root| initial_cut(&auxiliary.tree, root, threshold.at(0), PhrConfig::FAST.max_cut);
        Self {
            initial: auxiliary.tree.root.map_or_else(Vec::new, cut),
            children: children.collect(),
            prims: auxiliary.order.keys.iter().map(|&key| reference(key)).collect(),
            threshold,
            mesh,
            auxiliary,
            treelet: WideTreelet::default(),
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
        self.auxiliary.build(self.mesh, &of_leaves(leaf)).phases
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
        let mut sweep = ObjectSweep::default();
        cuts.limits = cuts
            .each()
            .map(|(nodes, bounds)| sweep.find(Isa::best(), nodes, bounds, Weight::Nodes).0.cost)
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
            let mut cut = CutBuilder::new(&mut self.arena);
            self.threshold.refine(&self.auxiliary.tree, &SPACE, depth, &mut self.side, &mut cut);
            refined += self.refine_halves(begin, depth + 1);
            self.arena.truncate(begin);
        }
        refined
    }

    /// Splits runs of `len` triangles in Morton order down to blocks, each in one go; `len` is at most 256. Returns
    /// the number of pairs of siblings.
    pub fn subtrees(&mut self, len: usize) -> usize {
        self.subtrees.rollback([0; 2]);
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
        self.treelet.clear();
        self.prims.chunks(BLOCK as usize).filter_map(|prims| self.treelet.leaf(self.mesh, prims)).count()
    }

    /// Of [`Steps::leaf_blocks`].
    pub fn leaf_block_traffic(&self) -> Traffic {
        let mesh = size_of_val(self.mesh.triangles()) + size_of_val(self.mesh.padded_vertices());
        let blocks = self.prims.len().div_ceil(BLOCK as usize);
        Traffic { read: mesh + size_of_val(&self.prims[..]), written: blocks * size_of::<TriangleBlock>() }
    }

    /// Writes a wide node over each two pairs of the auxiliary BVH; returns the number of nodes.
    pub fn wide_nodes(&mut self) -> usize {
        self.treelet.clear();
        for children in &self.children {
            self.treelet.node(children);
        }
        self.children.len()
    }

    /// Of [`Steps::wide_nodes`].
    pub fn wide_node_traffic(&self) -> Traffic {
        let written = self.children.len() * size_of::<WideNode<4>>();
        Traffic { read: size_of_val(&self.children[..]), written }
    }
}

/// The auxiliary BVH with leaves of at most `leaf` triangles.
fn of_leaves(leaf: u32) -> AuxiliaryConfig {
    AuxiliaryConfig { auxiliary_leaf: Some(leaf), ..AuxiliaryConfig::PAPER }
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
    /// In vectors, without an order.
    Lanes,
}

impl Way {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Chosen, Self::Sorted, Self::Binned, Self::Ranked, Self::Lanes];

    /// Whether this processor can split a cut of `len` nodes so.
    pub fn splits(self, len: usize) -> bool {
        match self {
            Self::Chosen | Self::Sorted => true,
            Self::Binned => len > 2,
            Self::Ranked => Isa::best() != Isa::Scalar && len <= ranks::MOST,
            Self::Lanes => match Isa::best() {
                Isa::Avx512(_) => len <= lanes::MOST,
                Isa::Avx2(_) => len <= lanes::MOST_AVX2,
                Isa::Scalar => false,
            },
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
        let (weight, isa) = (Weight::Nodes, Isa::best());
        let (mut chosen, mut full) = (ObjectSweep::default(), FullSweep::default());
        let (mut bins, mut ranks) = (Bins::default(), RankSweep::default());
        let best = |(nodes, bounds): (&[Node], Aabb)| {
            let limit = weight.limit(bounds.half_area(), self.len);
            match (way, isa) {
                (Way::Chosen, _) => chosen.find(isa, nodes, bounds, weight).0,
                (Way::Binned, _) => isa.run(
                    #[inline(always)]
                    || bins.best(&mut full, nodes, limit, weight),
                ),
                (Way::Ranked, Isa::Avx2(token)) => ranks.best(token, nodes, limit, weight),
                (Way::Ranked, Isa::Avx512(token)) => ranks.best(token, nodes, limit, weight),
                (Way::Lanes, Isa::Avx2(token)) => lanes::avx2(token, nodes, limit, weight),
                (Way::Lanes, Isa::Avx512(token)) => lanes::avx512(token, nodes, limit, weight),
                (Way::Sorted | Way::Ranked | Way::Lanes, _) => full.best(nodes, limit, weight),
            }
        };
        self.each().map(best).filter(|split| *split == ObjectSplit::NONE).count()
    }

    /// Finds the spatial split of each cut, where `bounded` only if it is cheaper than the object split, as a
    /// build does; returns the number of splits.
    pub fn spatial_splits(&self, bounded: bool) -> usize {
        let mut sweep = SpatialSweep::default();
        let limits = self.limits.iter().map(|&limit| if bounded { limit } else { f32::INFINITY });
        let split = |(cut, limit)| sweep.find(Isa::best(), limit, cut, Weight::Nodes, None).cost < limit;
        self.each().zip(limits).map(split).filter(|&found| found).count()
    }
}
