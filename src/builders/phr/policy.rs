//! What builders over cuts do otherwise than one another.

use crate::builders::binary::BinaryTree;
use crate::builders::optimise::Costs;
use crate::builders::phr::cut::Growing;
use crate::builders::phr::side::Side;
use crate::geometry::Aabb;

/// How a cut is refined after a split.
pub(crate) trait Refine: Sync {
    /// Appends the nodes of a side of a split at binary depth `depth` to `refined`, some of them opened
    /// ([`crate::builders::phr::cut::open`]).
    fn refine(&self, tree: &BinaryTree, clip: &Aabb, depth: u32, side: &Side, refined: &mut Growing<'_>);
}

/// What one builder over cuts does otherwise than another.
pub(crate) struct Rules<R> {
    /// How cuts are refined.
    pub refine: R,
    /// Nodes of a larger half area are opened for the initial cut,
    pub initial_threshold: f32,
    /// while it has fewer nodes than this.
    pub initial_len: usize,
    /// Spatial splits are tried for nodes of a larger half area; infinite for none.
    pub spatial_above: f32,
    /// They are tried only where the sides of the object split overlap by a larger half area, if this is given,
    pub overlap_above: Option<f32>,
    /// and taken if they cost less than that split, or, times the references they make per reference, less than so many
    /// times that split.
    pub spatial_bias: f32,
    /// Most references per reference that spatial splits may make.
    pub max_references: f32,
    /// Whether refining opens the node of a side that has but one into its two children at most, so that no more can
    /// come of it before the next split.
    pub opens_once: bool,
    /// Most references of a leaf of the auxiliary BVH.
    pub auxiliary_leaf: u32,
    /// Most triangles of a leaf.
    pub max_leaf: u32,
    /// Cuts of at most so many references are opened down to them, and their splits count quartets.
    pub leaf_sweep: u32,
    /// Cuts of at most so many references, too small for spatial splits, are handed to [`crate::builders::split::sweep_sah`].
    pub subtree_sweep: u32,
    /// What subtrees within pieces are to be cheapest in, if they are made wide at once.
    pub collapse: Option<Costs>,
    /// Where a spatial split cuts a node of a single reference, its triangle is clipped and not only its box.
    pub clip_triangles: bool,
}
