//! Meshes and rays for the tests of this module.

use crate::geometry::{Mesh, Ray};
use glam::Vec3;

/// A small linear congruential generator: numbers in [0, 1).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    fn point(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * size
    }
}

/// `count` random triangles, from small to long and thin, in a box of size 10.
pub fn soup(count: usize) -> Mesh {
    let mut random = Random(7);
    let mut vertices = Vec::new();
    for _ in 0..count {
        let (corner, long) = (random.point(10.0), random.next().powi(8) * 8.0 + 0.1);
        vertices.push(corner.to_array());
        vertices.push((corner + random.point(long)).to_array());
        vertices.push((corner + random.point(0.3)).to_array());
    }
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(vertices, triangles).unwrap().0
}

/// `count` rays between random points in and around the soup's box.
pub fn rays(count: usize) -> Vec<Ray> {
    let mut random = Random(11);
    let mut ray = || {
        let (from, to) = (random.point(14.0) - 2.0, random.point(10.0));
        Ray {
            org: from,
            tnear: 0.0,
            dir: to - from,
            tfar: if random.next() < 0.5 { f32::INFINITY } else { 1.0 },
        }
    };
    (0..count).map(|_| ray()).collect()
}
