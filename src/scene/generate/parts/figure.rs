//! The surface of the statue: an outline turned about the y axis, with folds, curls and the noise of a scan.

use super::frame::sin_cos;
use super::random::{fractal, noise};
use glam::Vec3;

/// Outline from below to above: height, half width along x, half depth along z.
const OUTLINE: [[f32; 3]; 19] = [
    [0.000, 0.001, 0.001],
    [0.000, 0.330, 0.290],
    [0.015, 0.370, 0.320],
    [0.060, 0.370, 0.320],
    [0.080, 0.310, 0.265],
    [0.115, 0.320, 0.275],
    [0.160, 0.400, 0.330],
    [0.185, 0.385, 0.310],
    [0.230, 0.410, 0.310],
    [0.290, 0.330, 0.260],
    [0.380, 0.235, 0.165],
    [0.500, 0.265, 0.160],
    [0.590, 0.265, 0.145],
    [0.640, 0.150, 0.110],
    [0.675, 0.075, 0.075],
    [0.740, 0.100, 0.112],
    [0.820, 0.100, 0.112],
    [0.880, 0.050, 0.055],
    [0.940, 0.001, 0.001],
];

/// The point of the surface at angle `u` (turns) and place `v` (0 to 1) along the outline.
pub fn surface(seed: u64, u: f32, v: f32) -> Vec3 {
    // Scans are denser where the scanner stood: both parameters run unevenly, but meet at their ends.
    let u = u + 0.05 * sin_cos(u).0 + 0.02 * sin_cos(3.0 * u).0;
    let v = v + 0.02 * sin_cos(2.0 * v).0;
    let (sin, cos) = sin_cos(u);

    let place = v.clamp(0.0, 1.0) * (OUTLINE.len() - 1) as f32;
    let below = (place as usize).min(OUTLINE.len() - 2);
    let t = place - below as f32;
    let [height, width, depth] = std::array::from_fn(|axis| spline(below, t, axis).max(0.0005));

    // Petals of the seat, knees to both sides, arms; each on its range of heights.
    let bump = |low: f32, high: f32| 0.5 - 0.5 * sin_cos(((height - low) / (high - low)).clamp(0.0, 1.0)).1;
    let petals = bump(0.09, 0.19) * 0.07 * sin_cos(u * 14.0).1.abs();
    let knees = bump(0.17, 0.32) * (0.16 * sin_cos(u * 2.0).0 * sin_cos(u * 2.0).0 * cos.max(0.0) - 0.04);
    let sideways = sin * sin * sin * sin;
    let arms = bump(0.28, 0.62) * 0.22 * (sideways * sideways * sideways) * (0.8 + 0.4 * cos);
    let mut p = Vec3::new(width * sin, height, depth * cos);
    let outwards = Vec3::new(sin, 0.0, cos);
    let reach = width.min(depth);
    p += outwards * (reach * (petals + knees + arms));

    // Folds of the robe follow the noise; curls cover the head; all over lies the scanner's noise.
    let folds = bump(0.2, 0.64) * 0.010 * sin_cos(height * 14.0 + 1.3 * noise(seed, p * 5.0) + sin * 0.8).0;
    let curls = bump(0.76, 0.95) * 0.006 * noise(seed.wrapping_add(50), p * 60.0);
    let [rough, fine] = [90, 70].map(|stream| seed.wrapping_add(stream));
    let carved = 0.008 * fractal(rough, p * 18.0, 3) + 0.0012 * fractal(fine, p * 160.0, 3);
    let taper = (reach / 0.05).min(1.0);
    p + (outwards + Vec3::Y * 0.3) * ((folds + curls + carved) * taper)
}

/// Catmull-Rom interpolation of the outline.
fn spline(below: usize, t: f32, axis: usize) -> f32 {
    let at = |i: usize| OUTLINE[i.min(OUTLINE.len() - 1)][axis];
    let (a, b, c, d) = (at(below.saturating_sub(1)), at(below), at(below + 1), at(below + 2));
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}
