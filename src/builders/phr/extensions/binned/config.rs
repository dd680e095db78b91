//! The parameter of binned SAH.

use crate::builders::api::config_error::{ConfigError, check};

/// Most bins along an axis.
pub(crate) const MOST_BINS: usize = 64;

/// Parameters of binned SAH.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BinnedSahConfig {
    /// Bins along each axis, 2 to 64; in nodes of few references four and one for every twenty, as in Embree.
    pub bins: usize,
}

impl BinnedSahConfig {
    /// Sixteen bins (Wald 2007).
    pub const DEFAULT: Self = Self { bins: 16 };

    /// Refuses parameters out of range.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        check("bins", self.bins, 2..=MOST_BINS)
    }
}

impl Default for BinnedSahConfig {
    fn default() -> Self {
        Self::DEFAULT
    }
}
