//! The parameters of AAC.

use crate::builders::api::config_error::{ConfigError, check};

/// Parameters of AAC.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AacConfig {
    /// delta: runs of fewer triangles are not partitioned further; 1 to 64.
    pub delta: usize,
    /// epsilon of f(n) = delta^(0.5 + epsilon) / 2 * n^(0.5 - epsilon), rounded up: the clusters left of n triangles,
    /// of fewer than delta those left of delta; 0 to 0.5. Where many boxes are equal, time grows with the cube of
    /// what it leaves.
    pub epsilon: f64,
}

impl AacConfig {
    /// AAC-Fast (Gu et al. 2013, section 4.1).
    pub const FAST: Self = Self { delta: 4, epsilon: 0.2 };

    /// Clusters left of `n` triangles.
    pub(super) fn clusters(&self, n: usize) -> usize {
        let (n, delta) = (n.max(self.delta) as f64, self.delta as f64);
        let clusters = delta.powf(0.5 + self.epsilon) / 2.0 * n.powf(0.5 - self.epsilon);
        // f(delta) is delta / 2 exactly, but for rounding.
        ((clusters - 1e-6).ceil() as usize).max(1)
    }

    /// Refuses parameters out of range.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        check("delta", self.delta, 1..=64)?;
        check("epsilon", self.epsilon, 0.0..=0.5)
    }
}
