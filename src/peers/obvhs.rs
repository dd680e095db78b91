//! The crate `obvhs`: PLOC, reinsertion and presplit triangles, in six presets.

use super::peer::Peer;
use crate::builders::{ForeignTree, Opened};
use crate::geometry::{Aabb, Mesh};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use std::time::Duration;

/// The crate's version.
pub const VERSION: &str = "0.4.0";

/// A preset of the crate, built as its binary tree.
#[derive(Clone, Copy, Debug)]
pub struct Obvhs {
    name: &'static str,
    params: BvhBuildParams,
}

impl Obvhs {
    /// All presets, from the fastest build to the slowest.
    pub const ALL: [Self; 6] = [
        Self { name: "obvhs-fastest", params: BvhBuildParams::fastest_build() },
        Self { name: "obvhs-very-fast", params: BvhBuildParams::very_fast_build() },
        Self { name: "obvhs-fast", params: BvhBuildParams::fast_build() },
        Self { name: "obvhs-medium", params: BvhBuildParams::medium_build() },
        Self { name: "obvhs-slow", params: BvhBuildParams::slow_build() },
        Self { name: "obvhs-very-slow", params: BvhBuildParams::very_slow_build() },
    ];
}

impl Peer for Obvhs {
    type Input = Vec<Triangle>;
    type Built = Bvh2;
    type Tree<'a> = &'a Bvh2;

    fn name(&self) -> &'static str {
        self.name
    }

    fn engine(&self) -> String {
        format!("obvhs {VERSION}")
    }

    fn config(&self) -> serde_json::Value {
        let params = &self.params;
        serde_json::json!({
            "crate": "obvhs",
            "version": VERSION,
            "pre_split": params.pre_split,
            "ploc_search_distance": format!("{:?}", params.ploc_search_distance),
            "search_depth_threshold": params.search_depth_threshold,
            "reinsertion_batch_ratio": params.reinsertion_batch_ratio,
            "post_collapse_reinsertion_batch_ratio_multiplier":
                params.post_collapse_reinsertion_batch_ratio_multiplier,
            "sort_precision": format!("{:?}", params.sort_precision),
            "max_prims_per_leaf": params.max_prims_per_leaf,
            "collapse_traversal_cost": params.collapse_traversal_cost,
        })
    }

    /// The corners of each triangle.
    fn input(&self, mesh: &Mesh) -> Vec<Triangle> {
        let triangle = |prim| {
            let [v0, v1, v2] = mesh.corners(prim).map(|corner| corner.to_array().into());
            Triangle { v0, v1, v2 }
        };
        (0..mesh.len() as u32).map(triangle).collect()
    }

    fn build(&self, triangles: &mut Vec<Triangle>) -> Bvh2 {
        // Its own clock leaves out some of the work.
        let mut unused = Duration::ZERO;
        build_bvh2_from_tris(triangles, self.params, &mut unused)
    }

    fn tree<'a>(&self, built: &'a Bvh2) -> &'a Bvh2 {
        built
    }
}

impl ForeignTree for &Bvh2 {
    type At = usize;

    fn root(&self) -> Option<usize> {
        (!self.nodes.is_empty()).then_some(0)
    }

    fn open(&self, at: usize, prims: &mut Vec<u32>) -> Opened<usize> {
        let node = &self.nodes[at];
        let first = node.first_index as usize;
        if node.prim_count == 0 {
            return Opened::Children([first, first + 1]);
        }
        prims.extend_from_slice(&self.primitive_indices[first..first + node.prim_count as usize]);
        let [min, max] = [node.aabb.min, node.aabb.max].map(|corner| corner.to_array().into());
        Opened::Leaf(Aabb { min, max })
    }

    fn may_repeat(&self) -> bool {
        self.uses_spatial_splits
    }
}
