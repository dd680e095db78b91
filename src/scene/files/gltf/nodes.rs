//! Where meshes stand: the nodes of the scene with their transforms.

use crate::scene::files::error::Fault;
use crate::scene::model::Contents;
use glam::{DMat4, DQuat, DVec3};
use gltf::json::scene::Node;
use gltf::json::{Index, Root};

/// A mesh in the place of a node.
pub(super) struct PlacedMesh {
    pub mesh: usize,
    /// From the mesh's space to the scene's.
    pub transform: DMat4,
}

/// The meshes of the default scene, or of the first, or of all nodes that are nobody's child where there is no scene:
/// depth first. In double precision, so that an identity changes no bit.
pub(super) fn placed_meshes(root: &Root, contents: &mut Contents) -> Result<Vec<PlacedMesh>, Fault> {
    let mut is_reached = vec![false; root.nodes.len()];
    // Looked at before they wait, so that no more wait than there are.
    let mut reach = |index: usize| {
        let fault = |problem: &str| Fault::new(format!("node {index}"), problem, Fault::DAMAGED);
        let place = is_reached.get_mut(index).ok_or_else(|| fault("there is no such node"))?;
        if std::mem::replace(place, true) {
            return Err(fault("child of two nodes, or of itself"));
        }
        Ok(index)
    };
    let mut waiting: Vec<(usize, DMat4)> = Vec::new();
    for node in roots(root)?.into_iter().rev() {
        waiting.push((reach(node)?, DMat4::IDENTITY));
    }
    let mut placed = Vec::new();
    let mut skinned = 0;
    while let Some((index, parent)) = waiting.pop() {
        let Some(node) = root.nodes.get(index) else { continue };
        let transform = parent * local(node);
        if let Some(mesh) = node.mesh {
            // A skin's joints place the mesh, not its node. Without them it stands as it was bound.
            let is_skinned = node.skin.is_some();
            skinned += usize::from(is_skinned);
            let transform = if is_skinned { DMat4::IDENTITY } else { transform };
            placed.push(PlacedMesh { mesh: mesh.value(), transform });
        }
        for child in node.children.iter().flatten().rev() {
            waiting.push((reach(child.value())?, transform));
        }
    }
    let elsewhere = root.nodes.iter().filter(|node| node.mesh.is_some()).count() - placed.len();
    if elsewhere > 0 {
        contents
            .remarks
            .push(format!("{elsewhere} nodes with a mesh stand in other scenes of the file, or in none"));
    }
    if skinned > 0 {
        contents.remarks.push(format!("{skinned} meshes with a skin stand as they were bound, not as posed"));
    }
    Ok(placed)
}

fn roots(root: &Root) -> Result<Vec<usize>, Fault> {
    let indices = |nodes: &[Index<Node>]| nodes.iter().map(Index::value).collect();
    let scene = match root.scene {
        Some(default) => Some(root.scenes.get(default.value()).ok_or_else(|| {
            Fault::new(format!("scene {}", default.value()), "there is no such scene", Fault::DAMAGED)
        })?),
        None => root.scenes.first(),
    };
    if let Some(scene) = scene {
        return Ok(indices(&scene.nodes));
    }
    let mut is_root = vec![true; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(is_root) = is_root.get_mut(child.value()) {
            *is_root = false;
        }
    }
    Ok((0..).zip(is_root).filter_map(|(node, is_root)| is_root.then_some(node)).collect())
}

fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |of: Option<[f32; 3]>, default: f64| {
        of.map_or(DVec3::splat(default), |v| DVec3::from(v.map(f64::from)))
    };
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |rotation| {
        let length = DQuat::from_array(rotation.0.map(f64::from)).length();
        let quaternion = DQuat::from_array(rotation.0.map(f64::from));
        if length > 0.0 { quaternion / length } else { DQuat::IDENTITY }
    });
    DMat4::from_scale_rotation_translation(vector(node.scale, 1.0), rotation, vector(node.translation, 0.0))
}
