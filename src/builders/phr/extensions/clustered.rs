//! PHR over finished clusters: an LBVH is widened below compact clusters of some hundred triangles, or thousand, and
//! cuts of what is above them are split and refined. That takes little longer than the LBVH alone, which is worst at
//! the top and where needles are.

use crate::builders::api::builder::{Build, Builder, Stopwatch};
use crate::builders::api::config_error::ConfigError;
use crate::builders::lbvh::config::{AuxiliaryConfig, Clusters};
use crate::builders::lbvh::direct::clusters::ClusterTreelets;
#[cfg(feature = "serde")]
use crate::builders::phr::config::or_infinite;
use crate::builders::phr::config::{Extensions, PhrConfig};
use crate::builders::phr::memory::CutMemory;
use crate::builders::phr::pipeline::recursion_and_cut;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::presplit::PresplitConfig;
use crate::builders::wide::build;
use crate::bvh::limits::BLOCK;
use crate::bvh::{LeafBlock, TriangleBlock, WideBvh};
use crate::simd::Isa;
use std::fmt;

/// Parameters of [`ClusteredPhr`]: four of [`PhrConfig`] and two of [`AuxiliaryConfig`]. A [`PhrConfig`] would accept
/// extensions that clusters cannot follow: they are not opened, clipped or swept.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClusteredPhrConfig {
    /// As [`PhrConfig::alpha`].
    pub alpha: f32,
    /// As [`PhrConfig::delta`].
    pub delta: f32,
    /// Nodes of the initial cut, as far as there are enough.
    pub max_cut: usize,
    /// As [`PhrConfig::spatial_threshold`], relative to the calibrated scale. No plane cuts a cluster: it is on the
    /// side of its centroid.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "or_infinite"))]
    pub spatial_threshold: f32,
    /// Which subtrees of the LBVH are not opened: of at most so many triangles, and in a cube of at most this area. The
    /// longest edge counts, as a long cluster would reach far beyond the planes of spatial splits.
    pub clusters: Clusters,
    /// As [`AuxiliaryConfig::presplit`]: pieces are put into clusters like triangles.
    pub presplit: Option<PresplitConfig>,
}

impl ClusteredPhrConfig {
    /// That of `phr-draft`: clusters so large that cuts are short, and no spatial splits.
    pub const DRAFT: Self = Self {
        max_cut: 512,
        spatial_threshold: f32::INFINITY,
        clusters: Clusters { most: 4096, area: 3e-2 },
        presplit: None,
        ..Self::TURBO
    };

    /// That of `phr-turbo`.
    pub const TURBO: Self = Self {
        alpha: 0.45,
        delta: 5.0,
        max_cut: 2048,
        spatial_threshold: 3e-2,
        clusters: Clusters { most: 512, area: 3e-3 },
        // Small needles end in clusters anyhow; of large ones there are few, unless the scene is of needles throughout.
        presplit: Some(PresplitConfig {
            min_area: 1.0 / (1 << 13) as f32,
            max_extra: 0.0625,
            ..PresplitConfig::NEEDLES
        }),
    };

    /// The parameters that the recursion shares with PHR.
    ///
    /// # Errors
    /// A parameter out of range.
    pub(crate) fn of_cuts(&self) -> Result<PhrConfig, ConfigError> {
        let Self { alpha, delta, max_cut, spatial_threshold, clusters, presplit } = *self;
        let speed = PhrConfig::SPEED.extensions;
        let calibration = speed.auxiliary.calibration;
        let auxiliary_leaf = Some(BLOCK);
        let cuts = PhrConfig {
            alpha,
            delta,
            max_cut,
            spatial_threshold,
            max_leaf: BLOCK,
            max_references: PhrConfig::FAST.max_references,
            extensions: Extensions {
                auxiliary: AuxiliaryConfig {
                    auxiliary_leaf,
                    clusters: Some(clusters),
                    presplit,
                    calibration,
                    ..AuxiliaryConfig::PAPER
                },
                // Always `max_cut` nodes.
                cut_share: Some(1.0),
                local_threshold: speed.local_threshold,
                ..Extensions::NONE
            },
        };
        cuts.check()?;
        Ok(cuts)
    }
}

/// Builds trees of nodes of up to `N` children by PHR over finished clusters; memory is kept between builds.
///
/// ```
/// use phr::builders::{Builder as _, ClusteredPhr, ClusteredPhrConfig};
///
/// let mesh = phr::scene::scalable(20_000, 1).mesh;
/// let mut builder = ClusteredPhr::<8>::new("phr-turbo", ClusteredPhrConfig::TURBO)?;
/// let build = builder.build(&mesh);
/// assert_eq!(build.tree.validate(&mesh), Ok(()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ClusteredPhr<const N: usize, B: LeafBlock = TriangleBlock, I = [u32; 4]> {
    name: &'static str,
    config: ClusteredPhrConfig,
    treelets: ClusterTreelets<N, I>,
    memory: CutMemory<N, B>,
    isa: Isa,
}

impl<const N: usize, B: LeafBlock, I> fmt::Debug for ClusteredPhr<N, B, I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClusteredPhr")
            .field("name", &self.name)
            .field("config", &self.config)
            .finish_non_exhaustive()
    }
}

impl<const N: usize, B: LeafBlock, I: Copy + Default + Send> ClusteredPhr<N, B, I> {
    /// A builder called `name` in records.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(name: &'static str, config: ClusteredPhrConfig) -> Result<Self, ConfigError> {
        Self::with_isa(name, config, Isa::best())
    }

    /// A builder with the given instructions.
    pub(crate) fn with_isa(
        name: &'static str,
        config: ClusteredPhrConfig,
        isa: Isa,
    ) -> Result<Self, ConfigError> {
        config.of_cuts()?;
        let (treelets, memory) = (ClusterTreelets::default(), CutMemory::default());
        Ok(Self { name, config, treelets, memory, isa })
    }
}

impl<const N: usize, G: Geometry> Builder<N, G> for ClusteredPhr<N, G::Block, G::Item> {
    fn name(&self) -> &'static str {
        self.name
    }

    #[cfg(feature = "serde")]
    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, geometry: &G) -> Build<N, G::Block> {
        let Self { config, treelets, memory: CutMemory { auxiliary, recursion: memory }, isa, .. } = self;
        let cuts = &config.of_cuts().expect("in range, as was seen when the builder was made");
        let mut watch = Stopwatch::start(geometry.len());
        // Sort, auxiliary tree, clusters.
        let config = &cuts.extensions.auxiliary;
        let clusters = treelets.build(auxiliary, geometry, config, memory, (*isa, &mut watch));
        // Initial cut, recursion, the wide nodes above.
        let (recursion, cut) = recursion_and_cut(auxiliary, geometry, cuts, *isa);
        let tree = build::build_over(&recursion, cut, geometry, memory, clusters);
        watch.lap("cuts and nodes");
        self.memory.finish(tree, watch)
    }

    fn recycle(&mut self, tree: WideBvh<N, G::Block>) {
        self.memory.recursion.recycle(tree);
    }
}
