//! What tests of builders share: triangle soups, random cuts, and one table of cases for all ways to split them.

use crate::builders::binary::node::Node;
use crate::geometry::{Aabb, Mesh};
use crate::random::SplitMix64;
use glam::{Vec3, Vec3A};

/// A mesh of `n` triangles by their corners; `triangle` gets the index of each.
pub(crate) fn mesh(
    n: usize,
    seed: u64,
    mut triangle: impl FnMut(usize, &mut SplitMix64) -> [Vec3; 3],
) -> Mesh {
    let mut random = SplitMix64::new(seed);
    let vertices = (0..n).flat_map(|i| triangle(i, &mut random)).map(|v| v.to_array()).collect();
    Mesh::new(vertices, (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap().0
}

/// Triangles of at most `size` anywhere in a unit cube.
pub(crate) fn soup(n: usize, size: f32, seed: u64) -> Mesh {
    mesh(n, seed, |_, random| {
        let at = random.point(0.0, 1.0);
        [0; 3].map(|_| at + random.point(-0.5, 0.5) * size)
    })
}

/// Random boxes as a cut, with their union. On coarse grids many centroids, planes and costs are equal.
pub(crate) fn cut(
    random: &mut SplitMix64,
    n: usize,
    grid: f32,
    size: f32,
    is_flat: bool,
) -> (Vec<Node>, Aabb) {
    let flat = if is_flat { Vec3A::new(0.0, 1.0, 1.0) } else { Vec3A::ONE };
    let mut corner = || Vec3A::from((random.point(0.0, 256.0) / grid).floor() * grid) - 100.0;
    let nodes: Vec<Node> = (0..n)
        .map(|i| {
            let (a, b) = (corner(), corner());
            let low = a.min(b);
            Node::leaf(Aabb::new(low, low + (a.max(b) - low) * flat * size), i, 1)
        })
        .collect();
    let bounds = nodes.iter().map(Node::bounds).collect();
    (nodes, bounds)
}

/// Calls `check` with the cuts that every way to split one is held to: short and long ones, on coarse and fine
/// grids, of small and large and flat boxes, and of boxes all alike.
pub(crate) fn for_each_cut(mut check: impl FnMut(&[Node], Aabb)) {
    let mut random = SplitMix64::new(1);
    let lengths = (2..140).chain([160, 200, 257, 300, 600]);
    for n in lengths {
        for (grid, size) in [(1.0, 1.0), (16.0, 1.0), (64.0, 0.3), (0.01, 0.05), (256.0, 1.0), (4.0, 0.0)] {
            let (nodes, bounds) = cut(&mut random, n, grid, size, n % 3 == 0);
            check(&nodes, bounds);
        }
    }
}
