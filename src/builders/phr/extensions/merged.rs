//! A static part of a scene and a dynamic one merged (paper, section 6, left open): the auxiliary tree of the
//! static part is built once, by any of the builders of auxiliary trees, and kept. For each frame only that of the
//! dynamic part is built; the two become the children of one root, and PHR refines cuts of the whole.

use super::auxiliary_tree::AuxiliaryTree;
use crate::builders::api::builder::{Build, Phase};
use crate::builders::api::config_error::ConfigError;
use crate::builders::binary::node::Node;
use crate::builders::lbvh::area_scale::AreaScale;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::phr::config::{Extensions, PhrConfig};
use crate::builders::phr::memory::CutMemory;
use crate::builders::phr::pipeline::build_from_cuts;
use crate::builders::wide::refit::RefitError;
use crate::bvh::WideBvh;
use crate::geometry::{Aabb, Mesh};
use crate::memory::{catch_out_of_memory, huge_pages};
use crate::simd::Isa;
use std::fmt;

/// Builds trees of nodes of up to `N` children over scenes whose first triangles never move.
///
/// ```
/// use phr::builders::{AuxiliaryTree, MergedPhr, PhrConfig};
///
/// let mesh = phr::scene::scalable(20_000, 1).mesh;
/// let mut builder = MergedPhr::<8>::new(PhrConfig::SPEED)?;
/// builder.keep(&mesh, 15_000, AuxiliaryTree::Lbvh)?;   // once
/// let build = builder.build(&mesh)?;                   // in each frame
/// assert_eq!(build.tree.validate(&mesh), Ok(()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct MergedPhr<const N: usize> {
    config: PhrConfig,
    /// Its auxiliary tree begins with the static part's, that of the last frame's dynamic part follows.
    memory: CutMemory<N>,
    dynamic: Auxiliary,
    kept: Kept,
    isa: Isa,
}

impl<const N: usize> fmt::Debug for MergedPhr<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MergedPhr").field("config", &self.config).finish_non_exhaustive()
    }
}

/// The static part.
#[derive(Clone, Copy, Default)]
struct Kept {
    triangles: usize,
    pairs: usize,
    root: Option<Node>,
}

impl<const N: usize> MergedPhr<N> {
    /// A builder with parameters of PHR; needles are not presplit.
    ///
    /// # Errors
    /// A parameter out of range.
    pub fn new(config: PhrConfig) -> Result<Self, ConfigError> {
        config.check()?;
        let auxiliary = AuxiliaryConfig { presplit: None, ..config.extensions.auxiliary };
        Ok(Self {
            config: PhrConfig { extensions: Extensions { auxiliary, ..config.extensions }, ..config },
            memory: CutMemory::default(),
            dynamic: Auxiliary::default(),
            kept: Kept::default(),
            isa: Isa::best(),
        })
    }

    /// Builds the auxiliary tree of the static part, the first `triangles` of `mesh`, by `tree`, and keeps it.
    ///
    /// # Errors
    /// A mesh of fewer triangles, a parameter of `tree` out of range. No memory: this is of no use then.
    pub fn keep(
        &mut self,
        mesh: &Mesh,
        triangles: usize,
        tree: AuxiliaryTree,
    ) -> Result<Vec<Phase>, RefitError> {
        tree.check()?;
        if triangles > mesh.len() {
            return Err(RefitError::Triangles { tree: triangles, mesh: mesh.len() });
        }
        let auxiliary = &mut self.memory.auxiliary;
        let config = &self.config.extensions.auxiliary;
        let watch =
            catch_out_of_memory(|| tree.build(auxiliary, (mesh, 0..triangles as u32), config, self.isa))?;
        self.kept = Kept { triangles, pairs: auxiliary.tree.pairs.len(), root: auxiliary.tree.root };
        Ok(watch.phases)
    }

    /// Builds the tree over `mesh`, the triangles of which after those of the static part have moved, are others,
    /// or are more or fewer.
    ///
    /// # Errors
    /// A mesh of fewer triangles than the static part. No memory: this is of no use then.
    pub fn build(&mut self, mesh: &Mesh) -> Result<Build<N>, RefitError> {
        if self.kept.triangles > mesh.len() {
            return Err(RefitError::Triangles { tree: self.kept.triangles, mesh: mesh.len() });
        }
        Ok(catch_out_of_memory(|| {
            let Extensions { auxiliary_tree, auxiliary, .. } = &self.config.extensions;
            let moving = self.kept.triangles as u32..mesh.len() as u32;
            let mut watch = auxiliary_tree.build(&mut self.dynamic, (mesh, moving), auxiliary, self.isa);
            self.merge(mesh);
            watch.lap("merge");
            build_from_cuts(&mut self.memory, mesh, &self.config, self.isa, watch)
        })?)
    }

    /// Gives back a tree that is no longer needed, so that the next one is built in its memory.
    pub fn recycle(&mut self, tree: WideBvh<N>) {
        self.memory.recursion.recycle(tree);
    }

    /// Puts the dynamic part's references and pairs behind the static part's, and a root above both.
    fn merge(&mut self, mesh: &Mesh) {
        let Kept { triangles, pairs, root } = self.kept;
        let Auxiliary { order, tree, scale, .. } = &mut self.memory.auxiliary;
        order.keys.truncate(triangles);
        huge_pages::reserve(&mut order.keys, mesh.len(), "merged keys");
        order.keys.extend_from_slice(&self.dynamic.order.keys);
        tree.pairs.truncate(pairs);
        let added = &self.dynamic.tree.pairs;
        huge_pages::reserve(&mut tree.pairs, pairs + added.len() + 1, "merged pairs");
        let appended = |node: Node| node.appended(pairs as u32, triangles as u32);
        tree.pairs.extend(added.iter().map(|pair| pair.map(appended)));
        tree.root = Node::join_any([root, self.dynamic.tree.root.map(appended)], &mut tree.pairs);
        let bounds = tree.root.map_or(Aabb::EMPTY, |root| root.bounds());
        let calibration = self.config.extensions.auxiliary.calibration;
        *scale = AreaScale::in_order(bounds, &order.keys, &order.refs(mesh), calibration);
    }
}
