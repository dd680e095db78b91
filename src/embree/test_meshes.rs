//! Meshes and rays for the tests of this module.

use crate::geometry::{Mesh, Ray};
use crate::random::SplitMix64;

/// `count` random triangles, from small to long and thin, in a box of size 10.
pub fn soup(count: usize) -> Mesh {
    let mut random = SplitMix64::new(7);
    let mut vertices = Vec::new();
    for _ in 0..count {
        let (corner, long) = (random.point(0.0, 10.0), random.unit().powi(8) * 8.0 + 0.1);
        vertices.push(corner.to_array());
        vertices.push((corner + random.point(0.0, long)).to_array());
        vertices.push((corner + random.point(0.0, 0.3)).to_array());
    }
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(vertices, triangles).unwrap().0
}

/// `count` rays between random points in and around the soup's box.
pub fn rays(count: usize) -> Vec<Ray> {
    let mut random = SplitMix64::new(11);
    let mut ray = || {
        let (from, to) = (random.point(-2.0, 12.0), random.point(0.0, 10.0));
        Ray {
            org: from,
            tnear: 0.0,
            dir: to - from,
            tfar: if random.unit() < 0.5 { f32::INFINITY } else { 1.0 },
        }
    };
    (0..count).map(|_| ray()).collect()
}
