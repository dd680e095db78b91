//! Progressive Hierarchical Refinement (Hendrich, Meister, Bittner 2017): the paper's builder.

pub(crate) mod cut;
pub(crate) mod exact;
pub(crate) mod extensions;
pub(crate) mod hierarchy;
pub(crate) mod initial_cut;
pub(crate) mod policy;
pub(crate) mod recursion;
pub(crate) mod side;

use crate::builders::binary::{BinaryTree, Node};
use crate::builders::builder::{Build, Builder};
use crate::builders::lbvh::area_scale::Areas;
use crate::builders::lbvh::auxiliary::{AuxiliaryConfig, Clusters};
use crate::builders::optimise::Costs;
use crate::builders::phr::cut::{Growing, is_whole, open};
use crate::builders::phr::hierarchy::Hierarchy;
use crate::builders::phr::policy::{Refine, Rules};
use crate::builders::phr::side::Side;
use crate::builders::prims::presplit::PresplitConfig;
use crate::builders::split::sweep_sah;
use crate::builders::wide::top_down::QUARTET;
use crate::bvh::Bvh4;
use crate::geometry::{Aabb, Mesh};

/// Parameters of PHR.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PhrConfig {
    /// alpha of equation 2: how fast cuts shrink with depth.
    pub alpha: f32,
    /// delta of equation 2: how fine the initial cut is.
    pub delta: f32,
    /// Most nodes of the initial cut (paper 4.1: "e.g. 2048").
    pub max_cut: usize,
    /// Nodes of the initial cut per triangle, at least 2048 and at most `max_cut`, however small they are: in a scene
    /// of a few huge triangles all else is smaller than a threshold taken from the scene's area. 0 in the paper.
    pub cut_share: f32,
    /// Large parts of the scene are opened by their own area too: `None` in the paper.
    pub own_threshold: Option<OwnThreshold>,
    /// Spatial splits are tried in nodes whose area relative to the scene's exceeds this (paper 4.4: "e.g. 1e-3").
    pub spatial_threshold: f32,
    /// Spatial splits are tried only where the sides of the best object split overlap in a box whose area relative
    /// to the scene's exceeds this (cf. Stich et al. 2009, 4.5): 0, whether they overlap or not, in the paper.
    pub overlap_threshold: f32,
    /// A spatial split is taken if it costs less than the best object split, as in the paper, or if its cost times the
    /// growth in references is less than so many times the object split's: 1 in the paper.
    pub spatial_bias: f32,
    /// Most references per triangle that spatial splits may make: a bound on memory, not in the paper.
    pub max_references: f32,
    /// Most triangles of a leaf. Up to four always are one; more where the cost model has a leaf of several
    /// quartets cheaper than a node (the paper leaves leaves open).
    pub max_leaf: u32,
    /// References that a leaf of the auxiliary BVH holds at most: 1 in the paper, up to 4.
    pub auxiliary_leaf: u32,
    /// Larger subtrees that are leaves of the auxiliary BVH too: none in the paper.
    pub clusters: Option<Clusters>,
    /// Cuts of at most so many references are opened down to them, and their splits count the quartets that
    /// leaves cost: 0 in the paper.
    pub leaf_sweep: u32,
    /// Cuts of at most so many references, whose boxes are too small for spatial splits, are split down to leaves
    /// in one go by sweeps over all of them: 0 in the paper, up to 256.
    pub subtree_sweep: u32,
    /// What parts of the tree that fit a cache are to be cheapest in as wide trees, larger leaves included: they are split
    /// down to quartets, and `max_leaf` does not count. `None` in the paper, where the largest child is opened first.
    pub collapse: Option<Costs>,
    /// Areas of clusters, of nodes split spatially and of overlaps are relative to so many times the median area of 2048
    /// references that follow one another along the Morton curve, where that is less than the scene's: a flat wide scene
    /// is large for what is in it. `None` in the paper, whose open problem parameters chosen by the scene are (section 6).
    pub calibration: Option<f32>,
    /// Which triangles are split before the Morton sort (paper 5.3); `None` for none.
    pub presplit: Option<PresplitConfig>,
    /// Where a spatial split cuts a node of a single triangle, the triangle is clipped and not only its box.
    pub clip_triangles: bool,
}

/// A threshold beside that of equation 2, taken from what is split and not from the scene: a part that is small in the
/// scene has few nodes large enough for equation 2, however much there is in it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct OwnThreshold {
    /// It is for sides of splits with at least so many references;
    pub references: u32,
    /// nodes of a larger area, relative to the side's, are opened too.
    pub area: f32,
}

impl PhrConfig {
    /// PHR-Fast (paper 4.3).
    pub const FAST: Self = Self {
        alpha: 0.5,
        delta: 6.0,
        max_cut: 2048,
        cut_share: 0.0,
        own_threshold: None,
        spatial_threshold: 1e-3,
        spatial_bias: 1.0,
        max_references: 2.0,
        max_leaf: 8,
        auxiliary_leaf: 1,
        leaf_sweep: 0,
        subtree_sweep: 0,
        clusters: None,
        overlap_threshold: 0.0,
        calibration: None,
        presplit: None,
        clip_triangles: false,
        collapse: None,
    };
    /// PHR-HQ (paper 4.3).
    pub const HQ: Self = Self { alpha: 0.55, delta: 9.0, ..Self::FAST };

    /// Threshold and length of an initial cut of [`PhrConfig::cut_share`].
    pub(crate) fn initial_cut(&self, triangles: usize) -> Option<(f32, usize)> {
        let len = (triangles as f32 * self.cut_share) as usize;
        (self.cut_share > 0.0).then(|| (0.0, len.max(2048).min(self.max_cut)))
    }

    /// Of the auxiliary BVH.
    pub(crate) fn auxiliary(&self) -> AuxiliaryConfig {
        let Self { presplit, auxiliary_leaf, clusters, calibration, .. } = *self;
        AuxiliaryConfig { presplit, leaf: auxiliary_leaf.clamp(1, QUARTET), clusters, calibration }
    }

    /// The rules for a scene of so many triangles with the given areas.
    pub(crate) fn rules(&self, triangles: usize, areas: &Areas) -> Rules<Threshold> {
        let refine = Threshold::new(areas.scene, self);
        let (initial_threshold, initial_len) =
            self.initial_cut(triangles).unwrap_or((refine.at(0), self.max_cut));
        Rules {
            initial_threshold,
            refine,
            initial_len,
            spatial_above: areas.reference * self.spatial_threshold,
            spatial_bias: self.spatial_bias,
            max_references: self.max_references,
            opens_once: true,
            auxiliary_leaf: self.clusters.map_or(self.auxiliary_leaf, |clusters| clusters.most),
            max_leaf: if self.collapse.is_some() { QUARTET } else { self.max_leaf },
            collapse: self.collapse.map(Costs::possible),
            leaf_sweep: self.leaf_sweep,
            overlap_above: (self.overlap_threshold > 0.0).then_some(areas.reference * self.overlap_threshold),
            subtree_sweep: self.subtree_sweep.min(sweep_sah::MOST as u32),
            clip_triangles: self.clip_triangles,
        }
    }
}

/// The threshold rule of equation 2: nodes larger than `t_d = S / 2^(alpha d + delta)` are opened one level.
pub(crate) struct Threshold {
    /// Half of `t_d` by depth d: areas are compared halved.
    by_depth: Vec<f32>,
    own: Option<OwnThreshold>,
}

impl Threshold {
    /// The thresholds of a scene whose box has the given half area.
    pub fn new(scene: f32, config: &PhrConfig) -> Self {
        let at = |d: u32| f64::from(scene) / f64::from(config.alpha * d as f32 + config.delta).exp2();
        Self { by_depth: (0..=128).map(|d| at(d) as f32).collect(), own: config.own_threshold }
    }

    /// Half of `t_d` at depth `depth`.
    pub fn at(&self, depth: u32) -> f32 {
        self.by_depth[(depth as usize).min(self.by_depth.len() - 1)]
    }

    /// That for a side of a split at depth `depth`.
    #[inline]
    fn of(&self, depth: u32, side: &Side) -> f32 {
        let threshold = self.at(depth);
        match self.own {
            Some(own) if side.count >= own.references => {
                let bounds: Aabb = side.nodes.iter().map(Node::bounds).collect();
                threshold.min(bounds.half_area() * own.area)
            }
            _ => threshold,
        }
    }
}

impl Refine for Threshold {
    #[inline]
    fn refine(&self, tree: &BinaryTree, clip: &Aabb, depth: u32, side: &Side, refined: &mut Growing<'_>) {
        if let [node] = side.nodes[..] {
            // Alone it is going to be opened, whatever its area.
            tree.prefetch(&node);
            if is_whole(&node, clip) {
                refined.push(node);
                return;
            }
        }
        let threshold = self.of(depth, side);
        for &node in &side.nodes {
            if node.is_leaf() || node.bounds().half_area() <= threshold {
                refined.push(node);
            } else {
                open(tree, &node, clip, |child| {
                    tree.prefetch(&child);
                    refined.push(child);
                });
            }
        }
    }
}

/// Builds by PHR; memory is kept between builds.
pub struct Phr {
    name: &'static str,
    config: PhrConfig,
    hierarchy: Hierarchy,
}

impl Phr {
    /// A builder called `name` in records.
    pub fn new(name: &'static str, config: PhrConfig) -> Self {
        Self { name, config, hierarchy: Hierarchy::default() }
    }

    /// The same with other instructions, which the processor must have.
    #[cfg(test)]
    pub(crate) fn with_isa(mut self, isa: crate::builders::split::object::lanes::Isa) -> Self {
        self.hierarchy.isa = isa;
        self
    }
}

impl Builder for Phr {
    fn name(&self) -> &'static str {
        self.name
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, mesh: &Mesh) -> Build {
        self.hierarchy.build(mesh, &self.config.auxiliary(), |areas| self.config.rules(mesh.len(), areas))
    }

    fn recycle(&mut self, tree: Bvh4) {
        self.hierarchy.recycle(tree);
    }
}
