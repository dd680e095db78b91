//! Build-from-hierarchy with cuts of constant length (Hunt, Mark, Fussell 2007, adapted to BVHs as in paper 5):
//! PHR's recursion, refined by opening the largest nodes until the cut is long enough, without spatial splits.

use crate::builders::binary::BinaryTree;
use crate::builders::builder::{Build, Builder};
use crate::builders::lbvh::auxiliary::AuxiliaryConfig;
use crate::builders::phr::cut::{Growing, open};
use crate::builders::phr::hierarchy::Hierarchy;
use crate::builders::phr::policy::{Refine, Rules};
use crate::builders::phr::side::Side;
use crate::bvh::Bvh4;
use crate::geometry::{Aabb, Mesh};

/// Parameters of Hunt's method.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct HuntConfig {
    /// Nodes of every cut, while there are so many.
    pub cut_length: usize,
    /// Most triangles of a leaf, as in [`super::PhrConfig::max_leaf`].
    pub max_leaf: u32,
}

/// The rule of constant length: a partial sort by area, then the largest are opened (paper 5).
struct ConstantLength(usize);

impl Refine for ConstantLength {
    fn refine(&self, tree: &BinaryTree, clip: &Aabb, _: u32, side: &Side, refined: &mut Growing<'_>) {
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
pub struct Hunt {
    name: &'static str,
    config: HuntConfig,
    hierarchy: Hierarchy,
}

impl Hunt {
    /// A builder called `name` in records.
    pub fn new(name: &'static str, config: HuntConfig) -> Self {
        Self { name, config, hierarchy: Hierarchy::default() }
    }

    /// The same with other instructions, which the processor must have.
    #[cfg(test)]
    pub(crate) fn with_isa(mut self, isa: crate::builders::split::object::lanes::Isa) -> Self {
        self.hierarchy.isa = isa;
        self
    }
}

impl Builder for Hunt {
    fn name(&self) -> &'static str {
        self.name
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!(self.config)
    }

    fn build(&mut self, mesh: &Mesh) -> Build {
        let HuntConfig { cut_length, max_leaf } = self.config;
        self.hierarchy.build(mesh, &AuxiliaryConfig::PAPER, |_| Rules {
            refine: ConstantLength(cut_length),
            initial_threshold: 0.0,
            initial_len: cut_length,
            spatial_above: f32::INFINITY,
            max_references: 1.0,
            opens_once: false,
            auxiliary_leaf: 1,
            max_leaf,
            collapse: None,
            leaf_sweep: 0,
            subtree_sweep: 0,
            overlap_above: None,
            spatial_bias: 1.0,
            clip_triangles: false,
        })
    }

    fn recycle(&mut self, tree: Bvh4) {
        self.hierarchy.recycle(tree);
    }
}
