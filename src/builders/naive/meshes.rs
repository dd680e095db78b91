//! Meshes that try what builders find hard.

use crate::builders::testing::mesh;
pub(super) use crate::builders::testing::soup;
use crate::geometry::Mesh;
use glam::Vec3;

/// A soup enlarged and moved, so that coordinates are of any size and sign.
pub fn scaled(n: usize, scale: f32, seed: u64) -> Mesh {
    mesh(n, seed, |i, random| {
        let at = random.point(0.0, 1.0) - 0.5;
        [0; 3].map(|_| (at + random.point(0.0, 1.0) * if i % 10 == 0 { 0.4 } else { 0.01 }) * scale)
    })
}

/// Long diagonal needles all through each other.
pub fn needles(n: usize, seed: u64) -> Mesh {
    mesh(n, seed, |_, random| {
        let (a, b) = (random.point(0.0, 1.0) * 100.0, random.point(0.0, 1.0) * 100.0);
        [a, b, a + Vec3::X * 1e-3]
    })
}

/// Needles from corner to corner of a cube, copies of each other, among beads strung on them: pieces and whole
/// triangles of one Morton code.
pub fn beads(n: usize, seed: u64) -> Mesh {
    mesh(n, seed, |i, random| {
        // Half of them on the first pieces.
        let at = Vec3::splat(if i % 2 == 0 {
            random.unit() * 1000.0
        } else {
            1.5 + (random.unit() * 4.0).floor() * 0.25
        });
        if i % 50 == 7 {
            [Vec3::ZERO, Vec3::splat(1000.0), Vec3::new(1e-3, 0.0, 0.0)]
        } else {
            [at, at + Vec3::X * 0.1, at + Vec3::Y * 0.1]
        }
    })
}

/// Three crossing planes of squares: boxes that are flat, equally large, equally far apart.
pub fn grids(n: usize) -> Mesh {
    mesh(6 * n * n, 0, |i, _| {
        let (axis, cell, half) = (i % 3, i / 6, i / 3 % 2);
        let corner = |di: usize, dj: usize| {
            let mut p = Vec3::splat((n / 2) as f32);
            p[(axis + 1) % 3] = (cell % n + di) as f32;
            p[(axis + 2) % 3] = (cell / n + dj) as f32;
            p
        };
        [corner(half, half), corner(1, 0), corner(0, 1)]
    })
}

/// All alike.
pub fn identical(n: usize) -> Mesh {
    mesh(n, 0, |_, _| [Vec3::ZERO, Vec3::X, Vec3::new(0.3, 0.7, 0.1)])
}

/// Corners on a coarse grid: many equal centroids, areas and planes, flat and degenerate triangles.
pub fn coarse(n: usize, cells: f32, seed: u64) -> Mesh {
    mesh(n, seed, |_, random| {
        let at = (random.point(0.0, 1.0) * cells).floor();
        [0; 3].map(|_| at + (random.point(0.0, 1.0) * 3.0).floor() - 1.0)
    })
}

/// Clusters within clusters, far smaller than a cell of the Morton codes.
pub fn clusters(n: usize, seed: u64) -> Mesh {
    mesh(n, seed, |i, random| {
        let center = Vec3::new((i % 3) as f32, (i % 5) as f32, (i % 2) as f32) * 1000.0;
        let size = 10f32.powi(-((i % 7) as i32));
        let at = center + random.point(0.0, 1.0) * size;
        [0; 3].map(|_| at + random.point(0.0, 1.0) * size * 0.1)
    })
}

/// Boxes one inside another.
pub fn concentric(n: usize) -> Mesh {
    mesh(n, 0, |i, _| {
        let size = 1.0 + i as f32;
        [Vec3::new(-size, -size, 0.0), Vec3::new(size, -size, 0.0), Vec3::new(0.0, 2.0 * size, 0.0)]
    })
}

/// Blocks side by side by their centroids, three of which reach far beyond the others at both ends: a plane there costs
/// less than any object split, but has all centroids on one side.
pub fn overhanging() -> Mesh {
    mesh(96, 0, |i, _| {
        let block = i / 4;
        let reach = match block {
            0 => 0.85,
            8 | 23 => 0.9,
            _ => 0.2,
        };
        let [min, max] = [-0.5, 0.5].map(|side| block as f32 * 1e-3 + side * reach);
        [Vec3::new(min, 0.0, 0.0), Vec3::new(max, 1.0, 0.0), Vec3::new(min, 1.0, 1.0)]
    })
}

/// Each a fraction of the one before: the deepest trees.
pub fn geometric(n: usize) -> Mesh {
    mesh(n, 0, |i, _| {
        let at = 2f32.powi(i as i32 % 120 - 60);
        [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| Vec3::X * at + v * at * 0.1)
    })
}
