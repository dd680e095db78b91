//! What thresholds of area are relative to. The paper's are relative to the scene's area; choosing its parameters by
//! the scene is left open there (section 6). In a flat wide city nearly all that is hit is smaller than any threshold
//! that suits a room, so extensions may be relative to what the scene's own parts measure.

use super::morton_order::{Key, reference};
use super::references::References;
use crate::geometry::Aabb;
use rayon::prelude::*;

/// References of a part of a scene.
pub(super) const PART: usize = 2048;
/// Most parts that are measured.
pub(super) const PARTS: usize = 64;
/// One of so many references of a part is measured.
pub(super) const STEP: usize = 64;

/// Half areas of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Areas {
    /// Of its box.
    pub scene: f32,
    /// Of what thresholds of extensions are relative to: no more than that.
    pub reference: f32,
}

impl Areas {
    /// Those of a scene with the given box.
    pub fn of(scene: Aabb) -> Self {
        Self { scene: scene.half_area(), reference: scene.half_area() }
    }

    /// Those of a scene whose keys are sorted: the reference area is `parts` times the median area of parts of the
    /// scene, runs of [`PART`] references along the Morton curve.
    pub fn calibrated(scene: Aabb, keys: &[Key], references: &References<'_>, parts: f32) -> Self {
        let areas = Self::of(scene);
        let count = PARTS.min(keys.len() / PART);
        let area = |i: usize| {
            let first = i * keys.len() / count;
            let some = keys[first..first + PART].iter().step_by(STEP);
            some.map(|&key| references.bounds(reference(key))).collect::<Aabb>().half_area()
        };
        let mut measured: Vec<f32> = (0..count).into_par_iter().with_min_len(16).map(area).collect();
        measured.sort_by(f32::total_cmp);
        let median = measured.get(count / 2).copied().unwrap_or(f32::INFINITY);
        Self { reference: areas.scene.min(median * parts), ..areas }
    }
}
