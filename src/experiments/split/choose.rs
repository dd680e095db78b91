//! Which split of a build is drawn: one of few nodes, whose boxes fill the picture without hiding one another, in
//! which one sees what opening does.

use super::{Kind, Picture};
use crate::builders::steps::split_boxes::{OpenedNode, SideBoxes, SplitBoxes};
use crate::builders::steps::watch::best_split;
use crate::builders::{CutConfig, cuts_of};
use crate::geometry::Aabb;
use crate::scene::Scene;
use std::ops::RangeInclusive;

/// Nodes of the cut.
const NODES: RangeInclusive<usize> = 6..=14;

/// The split of `kind` to be drawn of a build of `scene` by `builder`, on the current rayon pool; `None` if there
/// is none that shows it.
///
/// # Errors
/// A builder without cuts that a threshold refines, in one line.
pub fn choose(scene: &Scene, builder: &str, kind: Kind) -> Result<Option<Picture>, String> {
    let config = cuts_of(builder).filter(|config| matches!(config, CutConfig::Phr(_)));
    let config = config
        .ok_or_else(|| format!("{builder} has no cuts of PHR's kind; give phr-fast, phr-hq or the like"))?;
    let scene_area = scene.mesh.bounds().half_area();
    let score = |split: &SplitBoxes| {
        if !NODES.contains(&split.cut.len()) {
            return None;
        }
        let worth = match kind {
            Kind::Object => of_object_split(split),
            Kind::Spatial => of_spatial_split(split),
        };
        let size = (split.bounds().half_area() / scene_area).min(1.0);
        Some(worth? + of_picture(split) + size)
    };
    let found = best_split(&scene.mesh, &config, score).map_err(|error| format!("{builder}: {error}"))?;
    Ok(found.map(|split| Picture {
        kind,
        scene: scene.name.clone(),
        triangles: scene.mesh.len() as u64,
        builder: builder.into(),
        split,
    }))
}

/// An object split is worth a picture where nodes are opened whose children one tells apart, more where that is on both
/// sides, and where all are such.
fn of_object_split(split: &SplitBoxes) -> Option<f32> {
    if split.plane.is_some() || split.sides.iter().any(|side| side.nodes().count() < 2) {
        return None;
    }
    let axes = axes(split);
    let count = |is_one: &dyn Fn(&OpenedNode) -> bool| {
        split.sides.each_ref().map(|side| side.opened.iter().filter(|node| is_one(node)).count() as f32)
    };
    let (opened, seen) = (count(&|_| true), count(&|node| is_seen(node, axes)));
    let both = if seen.iter().all(|&seen| seen > 0.0) { 4.0 } else { 0.0 };
    (seen[0] + seen[1] > 0.0).then(|| both + 3.0 * (seen[0] + seen[1]) / (opened[0] + opened[1]))
}

/// A spatial split is worth one where nodes are on both sides, more where one of them is opened and its child
/// beyond the plane is discarded.
fn of_spatial_split(split: &SplitBoxes) -> Option<f32> {
    let plane = split.plane?;
    let axes = axes(split);
    let on_both = |bounds: &Aabb| !split.cut.contains(bounds);
    let discards = |(number, side): (usize, &SideBoxes)| {
        let is_beyond = |child: &Aabb| match number {
            0 => child.min[split.axis] >= plane,
            _ => child.max[split.axis] <= plane,
        };
        let is_one = |node: &OpenedNode| {
            let [child] = node.discarded[..] else { return false };
            let whole = area(node.bounds, axes) + area(child, axes);
            on_both(&node.bounds) && is_beyond(&child) && area(child, axes) > 0.1 * whole
        };
        side.opened.iter().any(is_one)
    };
    let shared = split.sides.iter().any(|side| side.nodes().any(on_both));
    let is_shown = shared && split.sides.iter().all(|side| side.nodes().count() > 1);
    let discarding = split.sides.iter().enumerate().filter(|side| discards(*side)).count();
    is_shown.then_some([0.0, 8.0, 9.0][discarding.min(2)])
}

/// Whether one sees in the picture how a node becomes two: its children lie beside one another there, neither as a
/// line.
fn is_seen(node: &OpenedNode, axes: [usize; 2]) -> bool {
    let [a, b] = node.children[..] else { return false };
    let (least, shared) = (area(a, axes).min(area(b, axes)), area(a.intersection(b), axes));
    least > 0.08 * area(node.bounds, axes) && shared < 0.3 * least
}

/// Of two pictures the better one is neither a strip nor mostly empty, nor are its boxes on top of one another.
fn of_picture(split: &SplitBoxes) -> f32 {
    let axes = axes(split);
    let bounds = split.bounds();
    let ratio = bounds.extent()[axes[1]] / bounds.extent()[axes[0]];
    let areas: f32 = split.cut.iter().map(|node| area(*node, axes)).sum();
    let pairs = split.cut.iter().enumerate().flat_map(|(i, a)| split.cut[..i].iter().map(move |b| (*a, *b)));
    let hidden: f32 = pairs.map(|(a, b)| area(a.intersection(b), axes)).sum();
    let filled = areas / area(bounds, axes);
    let is_square = (0.5..=1.1).contains(&ratio);
    let is_filled = (0.35..=1.6).contains(&filled);
    let clear = if areas > 0.0 { (1.0 - hidden / areas).max(0.0) } else { 0.0 };
    f32::from(u8::from(is_square) + u8::from(is_filled)) + 3.0 * clear
}

/// The area of a box in the picture.
fn area(bounds: Aabb, axes: [usize; 2]) -> f32 {
    let [across, up] = axes.map(|axis| bounds.extent()[axis].max(0.0));
    across * up
}

/// The axes across and up of the picture: that of the split, and the longer of the others.
pub fn axes(split: &SplitBoxes) -> [usize; 2] {
    let extent = split.bounds().extent();
    let [a, b] = [(split.axis + 1) % 3, (split.axis + 2) % 3];
    [split.axis, if extent[a] >= extent[b] { a } else { b }]
}
