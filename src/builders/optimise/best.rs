//! As good as it gets: a tree of PHR, made better afterwards.

use crate::builders::builder::{Build, Builder, Stopwatch};
use crate::builders::lbvh::area_scale::Areas;
use crate::builders::optimise::{OptimiseConfig, Optimiser};
use crate::builders::phr::PhrConfig;
use crate::builders::phr::hierarchy::Hierarchy;
use crate::builders::phr::policy::Rules;
use crate::builders::wide::top_down::QUARTET;
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
    hierarchy: Hierarchy,
    optimiser: Optimiser,
}

impl Best {
    /// A builder called `name` in records.
    pub fn new(name: &'static str, config: BestConfig) -> Self {
        Self { name, config, hierarchy: Hierarchy::default(), optimiser: Optimiser::default() }
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
        let (optimiser, BestConfig { phr, optimise }) = (&mut self.optimiser, &self.config);
        // Which leaves are worth more than one quartet is decided in the end.
        let rules =
            |areas: &Areas| Rules { max_leaf: QUARTET, collapse: None, ..phr.rules(mesh.len(), areas) };
        let (is_drawn, mut cuts) =
            self.hierarchy.recurse(mesh, &phr.auxiliary(), rules, |recursion, memory| {
                optimiser.draw(recursion, recursion.root(), mesh, memory)
            });
        let mut watch = Stopwatch::start();
        let tree = if is_drawn { optimiser.improve(mesh, optimise, &mut watch) } else { Bvh4::default() };
        cuts.phases.extend(watch.phases);
        Build::finish(tree, cuts.phases, cuts.counts, cuts.bytes + optimiser.bytes())
    }

    fn recycle(&mut self, tree: Bvh4) {
        self.optimiser.recycle(tree);
    }
}
