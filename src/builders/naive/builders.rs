//! The builders: how each refines the cuts of the one recursion.

use super::auxiliary::{Tree, lbvh, lbvh_of};
use super::cut::{self, Cut};
use super::full_leaves::with_full_leaves;
use super::ploc;
use super::recursion::Naive;
use super::wide::Wide;
use crate::builders::hunt::pipeline::HuntConfig;
use crate::builders::lbvh::config::{AuxiliaryConfig, Clusters};
use crate::builders::phr::config::PhrConfig;
use crate::builders::phr::extensions::auxiliary_tree::AuxiliaryTree;
use crate::builders::phr::extensions::clustered::ClusteredPhrConfig;
use crate::builders::phr::refine::Threshold;
use crate::bvh::limits::{CUT_DEPTH, FINISHED_CUT_DEPTH, MAX_REFERENCES_PER_TRIANGLE};
use crate::geometry::{Aabb, Mesh};
use std::rc::Rc;

/// PHR.
pub fn phr(mesh: &Mesh, config: &PhrConfig, width: usize) -> Option<Wide> {
    let (linear, scale) = lbvh(mesh, &config.extensions.auxiliary)?;
    let root = match &config.extensions.auxiliary_tree {
        AuxiliaryTree::Ploc(config) => ploc::clusters(mesh, config)?,
        _ => linear,
    };
    cuts(mesh, &root, scale, config, (width, CUT_DEPTH))
}

/// PHR over finished clusters.
pub fn clustered_phr(mesh: &Mesh, config: &ClusteredPhrConfig, width: usize) -> Option<Wide> {
    let config = config.of_cuts().unwrap();
    let Clusters { most, area } = config.extensions.auxiliary.clusters.unwrap();
    let (root, scale) =
        lbvh_of(mesh, &AuxiliaryConfig { clusters: None, ..config.extensions.auxiliary }, with_full_leaves)?;
    cuts(mesh, &root.finished(most.max(4), area * scale), scale, &config, (width, FINISHED_CUT_DEPTH))
}

/// The tree from cuts of an auxiliary tree.
fn cuts(
    mesh: &Mesh,
    root: &Rc<Tree>,
    scale: f32,
    config: &PhrConfig,
    (width, cut_depth): (usize, u32),
) -> Option<Wide> {
    let scene = mesh.bounds().half_area();
    let threshold = |depth: u32| {
        // Equation 2.
        let divisor = f64::from(config.alpha * depth as f32 + config.delta).exp2();
        (f64::from(scene) / divisor) as f32
    };
    let builder = Naive {
        mesh,
        width,
        cut_depth,
        config,
        spatial_above: scale * config.spatial_threshold,
        // Parts that fit a cache.
        part: (mesh.len() / 64).clamp(512, 4096) as u32,
        refine: &|side, clip, depth| {
            let count: u32 = side.iter().map(|member| member.tree.count).sum();
            let bounds: Aabb = side.iter().map(|member| member.bounds).collect();
            let local = config.extensions.local_threshold.filter(|local| count >= local.references);
            let threshold =
                threshold(depth).min(local.map_or(f32::INFINITY, |local| bounds.half_area() * local.area));
            side.into_iter()
                .flat_map(|member| {
                    let stays = member.is_leaf() || member.bounds.half_area() <= threshold;
                    if stays { vec![member] } else { member.open(clip) }
                })
                .collect()
        },
    };
    let (above, len) = config.initial_cut_limits(mesh.len(), &Threshold::new(scene, config));
    let members = cut::initial(root, above, len);
    builder.subtree(&Cut::whole(members, config.max_references, mesh.len() * MAX_REFERENCES_PER_TRIANGLE))
}

/// The LBVH itself, with full leaves.
pub fn wide_lbvh(mesh: &Mesh, width: usize) -> Option<Wide> {
    lbvh_of(mesh, &AuxiliaryConfig::PAPER, with_full_leaves).map(|(root, _)| root.packed(width))
}

/// The method of Hunt et al. 2007 with cuts of constant length.
pub fn hunt(mesh: &Mesh, config: &HuntConfig, width: usize) -> Option<Wide> {
    let (root, _) = lbvh(mesh, &AuxiliaryConfig::PAPER)?;
    let cuts = PhrConfig { max_leaf: config.max_leaf, ..PhrConfig::FAST };
    let builder = Naive {
        mesh,
        width,
        cut_depth: CUT_DEPTH,
        config: &cuts,
        spatial_above: f32::INFINITY,
        part: 0,
        refine: &|mut side, clip, _| {
            loop {
                let mut inner: Vec<usize> = (0..side.len()).filter(|&i| !side[i].is_leaf()).collect();
                inner.sort_by(|&a, &b| side[b].bounds.half_area().total_cmp(&side[a].bounds.half_area()));
                inner.truncate(config.cut_length.saturating_sub(side.len()));
                if inner.is_empty() {
                    return side;
                }
                let open = |(i, member): (usize, &super::member::Member)| {
                    if inner.contains(&i) { member.open(clip) } else { vec![member.clone()] }
                };
                side = side.iter().enumerate().flat_map(open).collect();
            }
        },
    };
    let members = cut::initial(&root, 0.0, config.cut_length);
    builder.subtree(&Cut::whole(members, 1.0, mesh.len()))
}
