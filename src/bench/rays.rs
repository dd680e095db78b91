//! The rays of a scene, recorded once per view from a path tracer over the reference tree, with the
//! reference's hits. All trees are traced with these rays.

use super::settings::Settings;
use crate::geometry::{Hit, Mesh, Ray, Tracer};
use crate::scene::Scene;
use crate::trace::verify::{self, Verdict};
use crate::trace::{self, RayBatches, RayKind};

/// The answers of a tracer to one batch.
#[derive(Clone, Debug, PartialEq)]
pub enum Answers {
    /// Closest hits.
    Closest(Vec<Hit>),
    /// Whether anything was hit.
    Any(Vec<bool>),
}

impl Answers {
    /// Room for the answers to `rays` of `kind`.
    pub fn room(kind: RayKind, rays: usize) -> Self {
        if kind.is_any_hit() { Self::Any(vec![false; rays]) } else { Self::Closest(vec![Hit::MISS; rays]) }
    }

    /// Resets all answers, so that none is left from an earlier trace.
    pub fn reset(&mut self) {
        match self {
            Self::Closest(hits) => hits.fill(Hit::MISS),
            Self::Any(occluded) => occluded.fill(false),
        }
    }

    /// Has `tracer` answer `rays` with all threads of the current rayon pool.
    pub fn fill(&mut self, tracer: &dyn Tracer, rays: &[Ray]) {
        match self {
            Self::Closest(hits) => trace::closest_in_parallel(tracer, rays, hits),
            Self::Any(occluded) => trace::any_in_parallel(tracer, rays, occluded),
        }
    }

    /// Rays that hit.
    pub fn hits(&self) -> u64 {
        match self {
            Self::Closest(hits) => trace::hit_count(hits) as u64,
            Self::Any(occluded) => occluded.iter().filter(|&&hit| hit).count() as u64,
        }
    }

    /// Hash of the rounded distances; of hit or miss for any-hit rays.
    pub fn hash(&self) -> u64 {
        match self {
            Self::Closest(hits) => trace::hit_hash(hits),
            Self::Any(occluded) => occluded.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &hit| {
                (hash ^ u64::from(hit)).wrapping_mul(0x0000_0100_0000_01b3)
            }),
        }
    }

    /// Compares with the reference's answers to the same rays; both tracers settle disputes.
    pub fn compare(&self, mesh: &Mesh, rays: &[Ray], reference: &Self, tracers: [&dyn Tracer; 2]) -> Verdict {
        match (reference, self) {
            (Self::Closest(reference), Self::Closest(hits)) => {
                verify::compare_closest(mesh, rays, reference, hits)
            }
            (Self::Any(reference), Self::Any(hits)) => {
                verify::compare_any(mesh, rays, reference, hits, verify::witness(&tracers))
            }
            _ => unreachable!("answers of one kind of ray are of one kind"),
        }
    }
}

/// One view's rays and the reference's answers, by [`RayKind::ALL`].
#[derive(Clone, Debug)]
pub struct ViewRays {
    /// The rays.
    pub batches: RayBatches,
    /// The reference's answers.
    pub reference: Vec<Answers>,
    /// Rays left out because Embree would not accept them.
    pub invalid: usize,
}

/// Records the rays of the first views of `scene` with `tracer`, the reference, on the current rayon pool.
pub fn record(tracer: &dyn Tracer, scene: &Scene, settings: &Settings) -> Vec<ViewRays> {
    let views = scene.views.iter().take(settings.views);
    views
        .map(|view| {
            let recording = trace::record(tracer, &scene.mesh, view, &settings.path());
            let answers = |kind: RayKind| {
                let rays = recording.batches.get(kind);
                let mut answers = Answers::room(kind, rays.len());
                answers.fill(tracer, rays);
                answers
            };
            let reference = RayKind::ALL.map(answers).into();
            ViewRays { batches: recording.batches, reference, invalid: recording.invalid }
        })
        .collect()
}
