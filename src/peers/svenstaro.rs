//! The crate `bvh` of Sven-Hendrik Haase (svenstaro): SAH in buckets down to single shapes.

use super::peer::Peer;
use crate::builders::{ForeignTree, Opened};
use crate::geometry::{Aabb, Mesh};
use svenstaro_bvh::aabb::{Aabb as Box3, Bounded};
use svenstaro_bvh::bounding_hierarchy::{BHShape, BoundingHierarchy as _};
use svenstaro_bvh::bvh::{Bvh, BvhNode};

/// The crate's version.
pub const VERSION: &str = "0.12.0";

/// The crate's parallel builder.
#[derive(Clone, Copy, Debug)]
pub struct Svenstaro;

/// A triangle as the crate sees it: a box, and the node that it is in.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    bounds: Aabb,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Box3<f32, 3> {
        let [min, max] = [self.bounds.min, self.bounds.max].map(|corner| corner.to_array().into());
        Box3::with_bounds(min, max)
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// The crate's tree.
pub struct Built {
    bvh: Bvh<f32, 3>,
    /// The box of a lone leaf: the crate's leaves have none.
    first: Aabb,
}

impl Peer for Svenstaro {
    type Input = Vec<Shape>;
    type Built = Built;
    type Tree<'a> = &'a Built;

    fn name(&self) -> &'static str {
        "svenstaro-bvh"
    }

    fn engine(&self) -> String {
        format!("bvh {VERSION}")
    }

    fn config(&self) -> serde_json::Value {
        serde_json::json!({ "crate": "bvh", "version": VERSION })
    }

    /// The box of each triangle.
    fn input(&self, mesh: &Mesh) -> Vec<Shape> {
        (0..mesh.len() as u32).map(|prim| Shape { bounds: mesh.bounds_of(prim), node: 0 }).collect()
    }

    fn build(&self, shapes: &mut Vec<Shape>) -> Built {
        Built { bvh: Bvh::build_par(shapes), first: shapes.first().map_or(Aabb::EMPTY, |shape| shape.bounds) }
    }

    fn tree<'a>(&self, built: &'a Built) -> &'a Built {
        built
    }
}

impl ForeignTree for &Built {
    /// A node, and its box if it is a leaf: parents hold the boxes.
    type At = (usize, Aabb);

    fn root(&self) -> Option<(usize, Aabb)> {
        (!self.bvh.nodes.is_empty()).then_some((0, self.first))
    }

    fn open(&self, (at, bounds): (usize, Aabb), prims: &mut Vec<u32>) -> Opened<(usize, Aabb)> {
        match &self.bvh.nodes[at] {
            BvhNode::Node { child_l_index, child_l_aabb, child_r_index, child_r_aabb, .. } => {
                Opened::Children([(*child_l_index, ours(child_l_aabb)), (*child_r_index, ours(child_r_aabb))])
            }
            BvhNode::Leaf { shape_index, .. } => {
                prims.push(*shape_index as u32);
                Opened::Leaf(bounds)
            }
        }
    }

    fn may_repeat(&self) -> bool {
        false
    }
}

fn ours(bounds: &Box3<f32, 3>) -> Aabb {
    let [min, max] = [bounds.min, bounds.max].map(|corner| <[f32; 3]>::from(corner).into());
    Aabb { min, max }
}
