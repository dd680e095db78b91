//! Build-from-hierarchy with cuts of constant length (Hunt, Mark, Fussell 2007, adapted to BVHs as in paper 5):
//! PHR's recursion, refined by opening the largest nodes until the cut is long enough, without spatial splits.

use super::builder::{Build, Builder, Stopwatch};
use super::config_error::{ConfigError, check};
use crate::builders::binary::tree::BinaryTree;
use crate::builders::phr::PhrConfig;
use crate::builders::phr::clip::open;
use crate::builders::phr::cut::{Cut, CutBuilder, Side};
use crate::builders::phr::initial_cut::initial_cut;
use crate::builders::phr::memory::CutMemory;
use crate::builders::phr::policy::CutPolicy;
use crate::builders::phr::recursion::CutRecursion;
use crate::builders::wide::build;
use crate::bvh::WideBvh;
use crate::bvh::limits::{BLOCK, MAX_LEAF};
use crate::geometry::{Aabb, Mesh};
use crate::simd::Isa;

/// Parameters of Hunt's method.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct HuntConfig {
    /// Nodes of every cut, as far as there are enough; 2 to 65536.
    pub cut_length: usize,
    /// Most triangles of a leaf, as in [`PhrConfig::max_leaf`].
    pub max_leaf: u32,
}

/// The rule of constant length: a partial sort by area, then the largest nodes are opened (paper 5).
struct ConstantLength(usize);

impl CutPolicy for ConstantLength {
    const KEEPS_SINGLE_NODES: bool = false;

    fn refine(&self, tree: &BinaryTree, clip: &Aabb, _: u32, side: &Side, refined: &mut CutBuilder<'_>) {
        let mut side = side.nodes.clone();
        let mut opened_once = Vec::new();
        // Opening a node makes a cut one longer; several rounds are needed after an uneven split.
        while side.len() < self.0 {
            let mut areas: Vec<(f32, usize)> = side
                .iter()
                .enumerate()
                .filter(|(_, node)| !node.is_leaf())
                .map(|(i, node)| (node.bounds().half_area(), i))
                .collect();
            if areas.is_empty() {
                break;
            }
            let wanted = (self.0 - side.len()).min(areas.len());
            areas.select_nth_unstable_by(wanted - 1, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut opened = vec![false; side.len()];
            areas[..wanted].iter().for_each(|&(_, i)| opened[i] = true);
            for (node, opened) in side.drain(..).zip(opened) {
                if opened {
                    open(tree, &node, clip, |child| opened_once.push(child));
                } else {
                    opened_once.push(node);
                }
            }
            std::mem::swap(&mut side, &mut opened_once);
        }
        side.into_iter().for_each(|node| refined.push(node));
    }
}

/// Builds by Hunt's method; memory is kept between builds.
pub struct Hunt<const N: usize> {
    name: &'static str,
    config: HuntConfig,
    /// The parameters that the recursion shares with PHR; without spatial splits.
    cuts: PhrConfig,
    memory: CutMemory<N>,
    isa: Isa,
}

impl<const N: usize> Hunt<N> {
    /// A builder called `name` in records.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(name: &'static str, config: HuntConfig) -> Result<Self, ConfigError> {
        Self::with_isa(name, config, Isa::best())
    }

    /// A builder with the given instructions.
    pub(crate) fn with_isa(name: &'static str, config: HuntConfig, isa: Isa) -> Result<Self, ConfigError> {
        let HuntConfig { cut_length, max_leaf } = config;
        check("cut_length", cut_length, 2..=1 << 16)?;
        check("max_leaf", max_leaf, BLOCK..=MAX_LEAF)?;
        let cuts = PhrConfig { spatial_threshold: f32::INFINITY, max_leaf, ..PhrConfig::FAST };
        Ok(Self { name, config, cuts, memory: CutMemory::default(), isa })
    }
}

impl<const N: usize> Builder<N> for Hunt<N> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, mesh: &Mesh) -> Build<N> {
        let CutMemory { auxiliary, recursion: memory } = &mut self.memory;
        let mut phases = auxiliary.build(mesh, &self.cuts.extensions.auxiliary);
        let mut watch = Stopwatch::start();
        let length = self.config.cut_length;
        let cut = auxiliary.tree.root.map(|root| {
            let nodes = initial_cut(&auxiliary.tree, root, 0.0, length);
            (Cut::whole(nodes, 1.0, mesh.len()), Default::default())
        });
        let recursion = CutRecursion::new(auxiliary, mesh, &self.cuts, ConstantLength(length), self.isa);
        let tree = build::build(&recursion, cut, mesh, memory);
        watch.lap("cuts and nodes");
        phases.extend(watch.phases);
        self.memory.finish(tree, phases)
    }

    fn recycle(&mut self, tree: WideBvh<N>) {
        self.memory.recursion.recycle(tree);
    }
}
