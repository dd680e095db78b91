//! As good as it gets: a tree of PHR, made better afterwards.

use super::optimise::{OptimiseConfig, Optimiser};
use super::{Build, Builder, Phr, PhrConfig};
use crate::bvh::Bvh4;
use crate::geometry::Mesh;

/// Parameters of [`Best`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct BestConfig {
    /// Of the builder.
    pub phr: PhrConfig,
    /// Of what is done to its tree.
    pub optimise: OptimiseConfig,
}

/// Builds by PHR and optimises; memory is kept between builds.
pub struct Best {
    name: &'static str,
    config: BestConfig,
    phr: Phr,
    optimiser: Optimiser,
}

impl Best {
    /// A builder called `name` in records.
    pub fn new(name: &'static str, config: BestConfig) -> Self {
        Self { name, config, phr: Phr::new(name, config.phr), optimiser: Optimiser::default() }
    }
}

impl Builder for Best {
    fn name(&self) -> &'static str {
        self.name
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, mesh: &Mesh) -> Build {
        let build = self.phr.build(mesh);
        let (build, draft) = self.optimiser.improve(build, mesh, &self.config.optimise);
        self.phr.recycle(draft);
        build
    }

    fn recycle(&mut self, tree: Bvh4) {
        self.optimiser.recycle(tree);
    }
}
