//! Variants of the auxiliary BVH.

use super::area_scale::AreaScale;
use super::sort::SortBits;
use super::treelet::LeafRule;
use crate::builders::api::config_error::{ConfigError, check, check_option};
use crate::builders::prims::presplit::PresplitConfig;
use crate::bvh::limits::{BLOCK, MAX_REFERENCES_PER_TRIANGLE, MIDDLE_DEPTH};

/// Which subtrees of the auxiliary BVH are leaves beside those of few references: near the leaves nothing is lost
/// by opening them all at once, where they are small.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Clusters {
    /// Most references of a cluster.
    pub most: u32,
    /// Largest area of its box as a share of the scene's, or of the calibrated area
    /// ([`AuxiliaryConfig::calibration`]). Of a finished cluster: of a cube that the box must fit.
    pub area: f32,
}

/// Variants of the auxiliary BVH; each changes the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AuxiliaryConfig {
    /// Codes are sorted by their highest 12 bits alone, as in the paper. Within a bucket the other bits are in no
    /// order, so that no search finds where they change (the paper does not say what becomes of it): its run, in
    /// the order of the mesh, is halved by count.
    pub bucket_sort: bool,
    /// Which triangles are split before the sort (paper 5.3).
    pub presplit: Option<PresplitConfig>,
    /// Subtrees of at most this many references are leaves, 1 to 4.
    pub auxiliary_leaf: Option<u32>,
    /// Larger subtrees that are leaves too.
    pub clusters: Option<Clusters>,
    /// Areas of clusters and of nodes split spatially are relative to this many times the median area of
    /// 2048 references that follow one another along the Morton curve, where that is less than the scene's: a flat wide
    /// scene is large for what is in it (paper, section 6, leaves parameters chosen by the scene open).
    pub calibration: Option<f32>,
}

impl AuxiliaryConfig {
    /// That of the paper, but for the sort: by all bits.
    pub const PAPER: Self =
        Self { bucket_sort: false, presplit: None, auxiliary_leaf: None, clusters: None, calibration: None };

    /// The bits that codes are sorted by, and how many partitions by the middle count as done: all of them for
    /// buckets, whose equal codes are then halved by count.
    pub(crate) const fn sort(&self) -> (SortBits, u32) {
        if self.bucket_sort { (SortBits::Highest, MIDDLE_DEPTH) } else { (SortBits::All, 0) }
    }

    /// Subtrees of at most this many references are always leaves.
    pub(super) fn leaf(&self) -> u32 {
        self.auxiliary_leaf.unwrap_or(1)
    }

    /// Most references of a leaf.
    pub(crate) fn max_leaf(&self) -> u32 {
        self.clusters.map_or(0, |clusters| clusters.most).max(self.leaf())
    }

    pub(in crate::builders) fn rule(&self, scale: &AreaScale) -> LeafRule {
        let area = self.clusters.map_or(0.0, |clusters| clusters.area * scale.relative_to);
        LeafRule { always: self.leaf(), most: self.max_leaf(), area }
    }

    /// Refuses parameters out of range.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        check_option("auxiliary_leaf", self.auxiliary_leaf, 1..=BLOCK)?;
        if let Some(Clusters { most, area }) = self.clusters {
            check("clusters.most", most, 1..=4096)?;
            check("clusters.area", area, 0.0..=f32::MAX)?;
        }
        check_option("calibration", self.calibration, 0.0..=f32::MAX)?;
        if let Some(PresplitConfig { filled, min_area, max_extra }) = self.presplit {
            check("presplit.filled", filled, 0.0..=0.5)?;
            check("presplit.min_area", min_area, 1e-12..=1.0)?;
            check("presplit.max_extra", max_extra, 0.0..=(MAX_REFERENCES_PER_TRIANGLE - 1) as f32)?;
        }
        Ok(())
    }
}
