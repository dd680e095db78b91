//! The pipeline of `phr-fast`, `phr-hq`, `phr-speed` and `phr-quality`, from a mesh to a wide tree. (`phr-draft` and
//! `phr-turbo`: [`super::extensions::clustered`]; `phr-best`: [`crate::builders::optimise`].)
//!
//! 1. Needles are presplit (paper 5.3): [`crate::builders::prims::presplit`];
//! 2. references are sorted by Morton codes (4.7): [`crate::builders::lbvh::sort`];
//! 3. the auxiliary tree is built over them (4.7): [`crate::builders::lbvh::auxiliary`];
//! 4. its initial cut (4.1): [`super::initial_cut`];
//! 5. cuts are split and refined from there on (3.2, 4.2 to 4.4): [`super::recursion`];
//! 6. splits become wide nodes (4.5), in parallel (4.6): [`crate::builders::wide::build`].

use super::config::{Extensions, PhrConfig};
use super::cut::OwnedCut;
use super::memory::CutMemory;
use super::recursion::CutRecursion;
use super::refine::Threshold;
use crate::builders::api::builder::{Build, Builder, Stopwatch};
use crate::builders::api::config_error::ConfigError;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::prims::geometry::Geometry;
use crate::builders::wide::build;
use crate::builders::wide::refit::RefitError;
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use crate::geometry::Mesh;
use crate::memory::catch_out_of_memory;
use crate::simd::Isa;
use std::fmt;

/// Builds trees of nodes of up to `N` children by PHR; memory is kept between builds.
pub struct Phr<const N: usize, B: LeafBlock = TriangleBlock> {
    name: &'static str,
    config: PhrConfig,
    memory: CutMemory<N, B>,
    isa: Isa,
}

impl<const N: usize, B: LeafBlock> fmt::Debug for Phr<N, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Phr").field("name", &self.name).field("config", &self.config).finish_non_exhaustive()
    }
}

impl<const N: usize, B: LeafBlock> Phr<N, B> {
    /// A builder called `name` in records.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(name: &'static str, config: PhrConfig) -> Result<Self, ConfigError> {
        Self::with_isa(name, config, Isa::best())
    }

    /// A builder with the given instructions.
    pub(crate) fn with_isa(name: &'static str, config: PhrConfig, isa: Isa) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { name, config, memory: CutMemory::default(), isa })
    }

    /// Gives back a tree that is no longer needed, so that the next one is built in its memory.
    pub fn recycle(&mut self, tree: WideBvh<N, B>) {
        self.memory.recursion.recycle(tree);
    }
}

impl<const N: usize> Phr<N> {
    /// Builds again over `mesh`, that of the build before with vertices moved: the auxiliary tree is fitted to it
    /// and keeps its topology, so that nothing is sorted, and its cuts are refined as ever. An unmoved mesh
    /// gets the same tree, unless a calibration ([`AuxiliaryConfig::calibration`]) measures other references because
    /// the builder reordered keys. (The paper, 5.6, leaves animation open.)
    ///
    /// # Errors
    /// A mesh of another number of triangles, and presplit needles ([`AuxiliaryConfig::presplit`]). No memory: the
    /// builder is of no use then.
    ///
    /// [`AuxiliaryConfig::calibration`]: crate::builders::AuxiliaryConfig::calibration
    /// [`AuxiliaryConfig::presplit`]: crate::builders::AuxiliaryConfig::presplit
    pub fn refit(&mut self, mesh: &Mesh) -> Result<Build<N>, RefitError> {
        catch_out_of_memory(|| {
            let watch = self.memory.auxiliary.refit(mesh, &self.config.extensions.auxiliary)?;
            Ok(build_from_cuts(&mut self.memory, mesh, &self.config, self.isa, watch))
        })?
    }
}

impl<const N: usize, G: Geometry> Builder<N, G> for Phr<N, G::Block> {
    fn name(&self) -> &'static str {
        self.name
    }

    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, geometry: &G) -> Build<N, G::Block> {
        let Self { config, memory, isa, .. } = self;
        let Extensions { auxiliary_tree, auxiliary, .. } = &config.extensions;
        let mut watch = Stopwatch::start(geometry.len());
        // Presplit and sort.
        memory.auxiliary.sort(geometry, geometry.prims(), auxiliary, &mut watch);
        // Auxiliary tree.
        auxiliary_tree.grow(&mut memory.auxiliary, geometry, auxiliary, *isa, &mut watch);
        // Initial cut, recursion, wide nodes.
        build_from_cuts(memory, geometry, config, *isa, watch)
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.recycle(tree);
    }
}

/// Builds from cuts of the auxiliary BVH in `memory`.
pub(crate) fn build_from_cuts<const N: usize, G: Geometry>(
    memory: &mut CutMemory<N, G::Block>,
    geometry: &G,
    config: &PhrConfig,
    isa: Isa,
    mut watch: Stopwatch,
) -> Build<N, G::Block> {
    // Initial cut.
    let (recursion, cut) = recursion_and_cut(&memory.auxiliary, geometry, config, isa);
    // Recursion: wide nodes are made on the way back.
    let tree = build::build(&recursion, cut, geometry, &mut memory.recursion);
    watch.lap("cuts and nodes");
    memory.finish(tree, watch)
}

/// The recursion over a scene, refined by the thresholds of equation 2, and the initial cut that it begins with.
pub(crate) fn recursion_and_cut<'a, G: Geometry>(
    auxiliary: &'a Auxiliary,
    geometry: &'a G,
    config: &'a PhrConfig,
    isa: Isa,
) -> (CutRecursion<'a, Threshold, G>, Option<OwnedCut>) {
    let threshold = Threshold::new(auxiliary.scale.scene, config);
    let limits = config.initial_cut_limits(geometry.len(), &threshold);
    CutRecursion::new(auxiliary, geometry, config, threshold, isa).with_initial_cut(limits)
}

impl PhrConfig {
    /// The threshold of half area and the length of the initial cut of a scene.
    pub(crate) fn initial_cut_limits(&self, triangles: usize, threshold: &Threshold) -> (f32, usize) {
        match self.extensions.cut_share {
            None => (threshold.at(0), self.max_cut),
            Some(share) => (0.0, ((triangles as f32 * share) as usize).max(2048).min(self.max_cut)),
        }
    }
}
