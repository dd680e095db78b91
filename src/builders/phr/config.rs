//! The parameters of PHR: the paper's, and our extensions.

use super::extensions::auxiliary_tree::AuxiliaryTree;
use crate::builders::api::config_error::{ConfigError, check, check_option};
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::wide::optimal::CollapseCosts;
use crate::bvh::limits::{BLOCK, MAX_LEAF, MAX_REFERENCES_PER_TRIANGLE, SUBTREE_MOST};

/// Parameters of PHR, by the paper's symbols.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PhrConfig {
    /// alpha of equation 2: how fast cuts shrink with depth.
    pub alpha: f32,
    /// delta of equation 2: how fine the initial cut is.
    pub delta: f32,
    /// Most nodes of the initial cut (paper 4.1: "e.g. 2048").
    pub max_cut: usize,
    /// Spatial splits are tried in nodes whose area relative to the scene's exceeds this (paper 4.4: "e.g. 1e-3");
    /// with [`AuxiliaryConfig::calibration`] relative to that scale. Infinite, `null` in JSON: there are no spatial
    /// splits.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
    pub spatial_threshold: f32,
    /// Most triangles of a leaf, 4 to 28. Up to four always are a leaf; more are one where the cost model has a leaf of
    /// several blocks cheaper than a node (the paper leaves leaves open).
    pub max_leaf: u32,
    /// Most references after spatial splits for each one before them, 1 to 4; in all there are at most four per
    /// triangle. Bounds memory (the paper has no bound).
    pub max_references: f32,
    /// What goes beyond the paper; none in [`PhrConfig::FAST`] and [`PhrConfig::HQ`].
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub extensions: Extensions,
}

/// Reads a number that may be infinite, of which JSON makes `null`.
#[cfg(feature = "serde")]
pub(super) fn or_infinite<'de, D: serde::Deserializer<'de>>(json: D) -> Result<f32, D::Error> {
    let number: Option<f32> = serde::Deserialize::deserialize(json)?;
    Ok(number.unwrap_or(f32::INFINITY))
}

/// What goes beyond the paper. Each changes the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extensions {
    /// Of the auxiliary BVH.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub auxiliary: AuxiliaryConfig,
    /// Which builder makes the auxiliary tree (paper 5.5).
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "AuxiliaryTree::is_lbvh"))]
    pub auxiliary_tree: AuxiliaryTree,
    /// The initial cut has this share of the triangles as nodes, at least 2048, but never more than `max_cut`, however
    /// small they are: in a scene of a few huge triangles all else is smaller than a threshold taken from the scene's
    /// area.
    pub cut_share: Option<f32>,
    /// Large parts of the scene are opened by their own area too. `own_threshold` in JSON, as in committed results.
    #[cfg_attr(feature = "serde", serde(rename = "own_threshold"))]
    pub local_threshold: Option<LocalThreshold>,
    /// Where a spatial split cuts a node of a single triangle, the triangle is clipped and not only its box.
    pub clip_triangles: bool,
    /// Sides of splits are weighed by the triangles below their nodes in place of the nodes, the alternative that
    /// the paper names in 4.2. For an experiment: splits are found in plain code.
    pub triangle_counts: bool,
    /// Cuts of at most this many references, whose boxes are too small for spatial splits, are split down to leaves
    /// in one go by sweeps over all of them.
    pub subtree_sweep: Option<u32>,
    /// Parts of the tree that fit a cache are split down to blocks and collapsed to the wide tree that is cheapest
    /// by these costs; `max_leaf` does not count then.
    pub collapse: Option<CollapseCosts>,
}

/// A threshold beside that of equation 2, taken from the part that is split and not from the scene: a part that is
/// small in the scene has few nodes large enough for equation 2, however much there is in it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LocalThreshold {
    /// It holds for sides of splits with at least this many references.
    pub references: u32,
    /// Nodes of a larger area, relative to the side's, are opened too.
    pub area: f32,
}

impl Extensions {
    /// None: the paper.
    pub const NONE: Self = Self {
        auxiliary: AuxiliaryConfig::PAPER,
        auxiliary_tree: AuxiliaryTree::Lbvh,
        cut_share: None,
        local_threshold: None,
        clip_triangles: false,
        triangle_counts: false,
        subtree_sweep: None,
        collapse: None,
    };
}

impl PhrConfig {
    /// PHR-Fast (paper 4.3), but for the sort of the auxiliary tree ([`AuxiliaryConfig::PAPER`]).
    pub const FAST: Self = Self {
        alpha: 0.5,
        delta: 6.0,
        max_cut: 2048,
        spatial_threshold: 1e-3,
        max_leaf: 8,
        max_references: 2.0,
        extensions: Extensions::NONE,
    };
    /// PHR-HQ (paper 4.3), with the same exception.
    pub const HQ: Self = Self { alpha: 0.55, delta: 9.0, ..Self::FAST };

    /// Refuses parameters out of range.
    ///
    /// # Errors
    /// The first of them, with its range.
    pub fn check(&self) -> Result<(), ConfigError> {
        let Self { alpha, delta, max_cut, spatial_threshold, max_leaf, max_references, extensions } = *self;
        check("alpha", alpha, 0.0..=16.0)?;
        check("delta", delta, 0.0..=64.0)?;
        check("max_cut", max_cut, 1..=1 << 24)?;
        check("spatial_threshold", spatial_threshold, 0.0..=f32::INFINITY)?;
        check("max_leaf", max_leaf, BLOCK..=MAX_LEAF)?;
        check("max_references", max_references, 1.0..=MAX_REFERENCES_PER_TRIANGLE as f32)?;
        extensions.check()
    }

    /// Most triangles of a leaf of a cut.
    pub(crate) fn leaf_size(&self) -> u32 {
        if self.extensions.collapse.is_some() { BLOCK } else { self.max_leaf }
    }
}

impl Extensions {
    fn check(&self) -> Result<(), ConfigError> {
        let Self { auxiliary, auxiliary_tree, local_threshold, collapse, .. } = self;
        auxiliary.check()?;
        auxiliary_tree.check().map_err(|error| error.within("auxiliary_tree"))?;
        check_option("cut_share", self.cut_share, 0.0..=1.0)?;
        check_option("local_threshold.area", local_threshold.map(|local| local.area), 0.0..=f32::MAX)?;
        check_option("subtree_sweep", self.subtree_sweep, 0..=SUBTREE_MOST as u32)?;
        collapse.map_or(Ok(()), |costs| costs.check().map_err(|error| error.within("collapse")))
    }
}
