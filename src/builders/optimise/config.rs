//! How much a tree is optimised, and by which costs.

use crate::builders::api::config_error::{ConfigError, check};
use crate::builders::wide::optimal::CollapseCosts;

/// Parameters of the optimisation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OptimiseConfig {
    /// Rounds of reinsertion.
    pub rounds: u32,
    /// Subtrees that look for a better place in each round, per pair of siblings.
    pub share: f32,
    /// Costs that the wide tree minimises.
    pub costs: CollapseCosts,
}

impl OptimiseConfig {
    /// Costs of Embree's kernel, and as many rounds as move much.
    pub const DEFAULT: Self = Self { rounds: 4, share: 0.1, costs: CollapseCosts::EMBREE };

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        check("rounds", self.rounds, 0..=1000)?;
        check("share", self.share, 0.0..=2.0)?;
        self.costs.check().map_err(|error| error.within("costs"))
    }
}
