//! The parameter of PLOC.

use crate::builders::api::config_error::{ConfigError, check};

/// The largest radius, that of the authors' own program.
pub(crate) const MAX_RADIUS: usize = 128;

/// Parameters of PLOC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlocConfig {
    /// How many clusters before and after a cluster are searched for its nearest, 1 to 128.
    pub radius: usize,
}

impl PlocConfig {
    /// Radius 25, the middle one of the paper's results (10, 25 and 100).
    pub const DEFAULT: Self = Self { radius: 25 };

    /// Refuses parameters out of range.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        check("radius", self.radius, 1..=MAX_RADIUS)
    }
}

impl Default for PlocConfig {
    fn default() -> Self {
        Self::DEFAULT
    }
}
