//! Recorded rays by kind, and tracing a batch with all threads.

use crate::geometry::{Hit, Ray, Tracer};
use rayon::prelude::*;

/// The purpose of a path tracer's ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum RayKind {
    /// From the camera; traced for the closest hit.
    Primary,
    /// To a light; traced for any hit.
    Shadow,
    /// Scattered by a surface; traced for the closest hit.
    Bounce,
}

impl RayKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Primary, Self::Shadow, Self::Bounce];

    /// The name in records: "primary", "shadow" or "bounce".
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Bounce => "bounce",
        }
    }

    /// True if [`Tracer::any`] answers these rays, false if [`Tracer::closest`] does.
    pub fn is_any_hit(self) -> bool {
        self == Self::Shadow
    }
}

/// The rays of a path-traced frame, all valid ([`Ray::is_valid`]), in an order that does not depend on the
/// number of threads: tile by tile, within a tile segment by segment, within a segment pixel by pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayBatches {
    /// Rays from the camera.
    pub primary: Vec<Ray>,
    /// Rays to lights.
    pub shadow: Vec<Ray>,
    /// Scattered rays.
    pub bounce: Vec<Ray>,
}

impl RayBatches {
    /// The rays of one kind.
    pub fn get(&self, kind: RayKind) -> &[Ray] {
        match kind {
            RayKind::Primary => &self.primary,
            RayKind::Shadow => &self.shadow,
            RayKind::Bounce => &self.bounce,
        }
    }

    /// The rays of one kind, to add to.
    pub fn get_mut(&mut self, kind: RayKind) -> &mut Vec<Ray> {
        match kind {
            RayKind::Primary => &mut self.primary,
            RayKind::Shadow => &mut self.shadow,
            RayKind::Bounce => &mut self.bounce,
        }
    }

    /// Number of rays of all kinds.
    pub fn len(&self) -> usize {
        RayKind::ALL.iter().map(|&kind| self.get(kind).len()).sum()
    }

    /// True without rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Rays a thread takes at once: some hundred microseconds of work.
const CHUNK: usize = 1024;

/// [`Tracer::closest`] with all threads of the current rayon pool; `hits` has the length of `rays`.
pub fn closest_in_parallel(tracer: &dyn Tracer, rays: &[Ray], hits: &mut [Hit]) {
    assert_eq!(rays.len(), hits.len(), "as many hits as rays");
    rays.par_chunks(CHUNK)
        .zip(hits.par_chunks_mut(CHUNK))
        .for_each(|(rays, hits)| tracer.closest(rays, hits));
}

/// [`Tracer::any`] with all threads of the current rayon pool; `occluded` has the length of `rays`.
pub fn any_in_parallel(tracer: &dyn Tracer, rays: &[Ray], occluded: &mut [bool]) {
    assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
    rays.par_chunks(CHUNK)
        .zip(occluded.par_chunks_mut(CHUNK))
        .for_each(|(rays, occluded)| tracer.any(rays, occluded));
}
