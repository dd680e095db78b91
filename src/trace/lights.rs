//! Lights for any scene: a sun and a sky outdoors, a lamp near the camera indoors. Each vertex of a path
//! sends one shadow ray, to the sun or to the lamp, chosen at random.

use super::camera::Camera;
use crate::geometry::{Hit, Ray, Tracer};
use crate::scene::View;
use glam::Vec3;

/// The lights of one view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lights {
    /// Unit vector of the view, taken for "up" by the sky.
    up: Vec3,
    sun: Vec3,
    lamp: Vec3,
    lamp_radius: f32,
    /// Distance from the lamp at which it is as bright as [`LAMP`].
    reach: f32,
}

/// Irradiance of surfaces that face the sun; warm.
const SUN: Vec3 = Vec3::new(2.2, 2.05, 1.8);
/// Irradiance of surfaces that face the lamp at its reach.
const LAMP: Vec3 = Vec3::new(0.8, 0.75, 0.68);
/// Radiance of the sky at the horizon and above.
const HORIZON: Vec3 = Vec3::new(0.5, 0.52, 0.55);
const ZENITH: Vec3 = Vec3::new(0.25, 0.36, 0.6);

/// A light seen from a point, occluded or not.
pub(super) struct LightSample {
    /// Unit direction to the light.
    pub dir: Vec3,
    /// Distance to it, infinite for the sun.
    pub distance: f32,
    /// Irradiance of a surface that faces it.
    pub irradiance: Vec3,
}

impl Lights {
    /// Places the lights for `view`: the sun behind the camera's right shoulder, the lamp above its left one,
    /// below a ceiling if there is one.
    pub(super) fn new(tracer: &dyn Tracer, view: &View) -> Self {
        let [right, up, forward] = Camera::new(view, 1, 1).axes();
        let world_up = view.up.try_normalize().unwrap_or(up);
        let reach = median_distance(tracer, view);
        let to_lamp = (world_up - 0.5 * right + 0.2 * forward).try_normalize().unwrap_or(up);
        let free = distances(tracer, &[Ray { org: view.eye, tnear: 0.0, dir: to_lamp, tfar: reach }])[0];
        let away = 0.6 * free.min(0.8 * reach);
        Self {
            up: world_up,
            sun: (world_up + 0.7 * right - 0.6 * forward).try_normalize().unwrap_or(up),
            lamp: view.eye + away * to_lamp,
            lamp_radius: 0.2 * away,
            reach,
        }
    }

    /// Radiance of the sky in unit direction `dir`.
    pub(super) fn sky(&self, dir: Vec3) -> Vec3 {
        HORIZON.lerp(ZENITH, self.up.dot(dir).clamp(0.0, 1.0).sqrt())
    }

    /// One light for `point`: the sun for half of the `choice`s in [0, 1), else a point of the lamp given by
    /// a unit vector; twice as bright as it is, since it stands for both. `None` inside the lamp.
    pub(super) fn sample(&self, point: Vec3, choice: f32, on_lamp: Vec3) -> Option<LightSample> {
        if choice < 0.5 {
            return Some(LightSample { dir: self.sun, distance: f32::INFINITY, irradiance: 2.0 * SUN });
        }
        let to_lamp = self.lamp + self.lamp_radius * on_lamp - point;
        let distance = to_lamp.length();
        let dir = to_lamp.try_normalize()?;
        // Nearer than half its reach the lamp gets no brighter.
        let nearness = self.reach / distance.max(0.5 * self.reach);
        Some(LightSample { dir, distance, irradiance: 2.0 * nearness * nearness * LAMP })
    }
}

/// The median distance of the surfaces that the camera sees; the distance of its target if it sees none.
fn median_distance(tracer: &dyn Tracer, view: &View) -> f32 {
    const SIDE: u32 = 16;
    let camera = Camera::new(view, SIDE, SIDE);
    let rays: Vec<Ray> =
        (0..SIDE * SIDE).map(|pixel| camera.ray(pixel % SIDE, pixel / SIDE, [0.5; 2])).collect();
    let mut distances = distances(tracer, &rays);
    distances.retain(|t| t.is_finite() && *t > 0.0);
    distances.sort_unstable_by(f32::total_cmp);
    let fallback = view.eye.distance(view.target);
    let fallback = if fallback.is_finite() && fallback > 0.0 { fallback } else { 1.0 };
    distances.get(distances.len() / 2).copied().unwrap_or(fallback)
}

fn distances(tracer: &dyn Tracer, rays: &[Ray]) -> Vec<f32> {
    // A view that makes invalid rays (an infinite eye, say) sees nothing.
    if !rays.iter().all(Ray::is_valid) {
        return vec![f32::INFINITY; rays.len()];
    }
    let mut hits = vec![Hit::MISS; rays.len()];
    tracer.closest(rays, &mut hits);
    hits.iter().map(|hit| hit.t).collect()
}
