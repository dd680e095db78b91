//! Which split of a build is drawn: one of few nodes, whose boxes fill the picture without hiding one another, and of the
//! largest extent among those.

use super::{Kind, Picture};
use crate::builders::cuts_of;
use crate::builders::steps::watch::{SplitBoxes, best_split};
use crate::geometry::Aabb;
use crate::scene::Scene;
use std::ops::RangeInclusive;

/// Nodes of the cut.
const NODES: RangeInclusive<usize> = 6..=20;

/// The split of `kind` to be drawn of a build of `scene` by `builder`, on the current rayon pool; `None` if there is none
/// that shows it.
///
/// # Errors
/// A builder without cuts, in one line.
pub fn choose(scene: &Scene, builder: &str, kind: Kind) -> Result<Option<Picture>, String> {
    let config = cuts_of(builder)
        .ok_or_else(|| format!("{builder} has no cuts; give phr-fast, phr-hq or the like"))?;
    let scene_area = scene.mesh.bounds().half_area();
    let score = |split: &SplitBoxes| {
        let worth = match kind {
            Kind::Object => of_object_split(split),
            Kind::Spatial => of_spatial_split(split),
        };
        let size = (split.bounds().half_area() / scene_area).min(1.0);
        NODES.contains(&split.cut.len()).then_some(worth?).map(|worth| worth + of_picture(split) + size)
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

/// Nodes of a side that were replaced by their children.
pub fn opened(split: &SplitBoxes, side: usize) -> usize {
    let kept = |bounds| split.refined[side].contains(bounds);
    split.sides[side].iter().filter(|bounds| !kept(bounds)).count()
}

/// An object split is worth a picture where both sides have several nodes, more where some are opened on both.
fn of_object_split(split: &SplitBoxes) -> Option<f32> {
    let is_shown = split.plane.is_none() && split.sides.iter().all(|side| side.len() > 1);
    let opened = [0, 1].map(|side| opened(split, side) > 0);
    (is_shown && (opened[0] || opened[1])).then(|| if opened == [true; 2] { 4.0 } else { 0.0 })
}

/// A spatial split is where nodes are on both sides, more where a child of an opened one is on this side alone: the other
/// is discarded.
fn of_spatial_split(split: &SplitBoxes) -> Option<f32> {
    let on_both = split.sides[0].len() + split.sides[1].len() > split.cut.len();
    let is_shown = split.plane.is_some() && on_both && split.sides.iter().all(|side| side.len() > 1);
    let discards = |side: usize| split.refined[side].len() < split.sides[side].len() + opened(split, side);
    is_shown.then(|| if discards(0) || discards(1) { 4.0 } else { 0.0 })
}

/// Of two pictures the better one is neither a strip nor mostly empty, nor are its boxes on top of one another.
fn of_picture(split: &SplitBoxes) -> f32 {
    let [across, up] = axes(split);
    let area = |bounds: &Aabb| bounds.extent()[across] * bounds.extent()[up];
    let bounds = split.bounds();
    let ratio = bounds.extent()[up] / bounds.extent()[across];
    let filled = split.cut.iter().map(area).sum::<f32>() / area(&bounds);
    let is_square = (0.4..=1.4).contains(&ratio);
    let is_clear = (0.35..=1.6).contains(&filled);
    f32::from(u8::from(is_square) + u8::from(is_clear))
}

/// The axes across and up of the picture: that of the split, and the longer of the others.
pub fn axes(split: &SplitBoxes) -> [usize; 2] {
    let extent = split.bounds().extent();
    let [a, b] = [(split.axis + 1) % 3, (split.axis + 2) % 3];
    [split.axis, if extent[a] >= extent[b] { a } else { b }]
}
