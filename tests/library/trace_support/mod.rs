//! What the tests of traversal share: small meshes, a builder simple enough to trust, and rays.
#![allow(dead_code, reason = "each test uses a part")]

use glam::{Vec3, Vec3A};
use phr::bvh::{Link, MAX_LEAF_BLOCKS, TriangleBlock, WideBvh, WideNode};
use phr::geometry::{Aabb, Hit, Mesh, Ray, Tracer};
use phr::random::SplitMix64;

/// A tree over `mesh` by medians along the widest axis, cut to `N` children per node, leaves of at most
/// `leaf` triangles.
pub fn median_tree<const N: usize>(mesh: &Mesh, leaf: usize) -> WideBvh<N> {
    assert!((1..=4 * MAX_LEAF_BLOCKS).contains(&leaf));
    let mut ids: Vec<u32> = (0..mesh.len() as u32).collect();
    let mut tree = WideBvh::<N> { bounds: mesh.bounds(), ..WideBvh::default() };
    if !ids.is_empty() {
        tree.root = emit(&mut tree, mesh, &mut ids, leaf);
    }
    tree
}

fn bounds(mesh: &Mesh, ids: &[u32]) -> Aabb {
    ids.iter().map(|&id| mesh.bounds_of(id)).collect()
}

fn emit<const N: usize>(tree: &mut WideBvh<N>, mesh: &Mesh, ids: &mut [u32], leaf: usize) -> Link {
    if ids.len() <= leaf {
        let first = tree.blocks.len();
        for chunk in ids.chunks(4) {
            let mut block = TriangleBlock::EMPTY;
            for (lane, &id) in chunk.iter().enumerate() {
                block.set(lane, mesh.corners(id), id);
            }
            tree.blocks.push(block);
        }
        return Link::leaf(first, ids.len().div_ceil(4));
    }
    let index = tree.nodes.len();
    tree.nodes.push(WideNode::EMPTY);
    let mut parts = vec![ids];
    while parts.len() < N {
        let Some(largest) =
            (0..parts.len()).filter(|&i| parts[i].len() > leaf).max_by_key(|&i| parts[i].len())
        else {
            break;
        };
        let part = parts.swap_remove(largest);
        let centres: Aabb =
            part.iter().map(|&id| mesh.bounds_of(id).center2()).map(|c| Aabb::new(c, c)).collect();
        let extent = centres.extent();
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap();
        part.sort_by(|&a, &b| {
            mesh.bounds_of(a).center2()[axis].total_cmp(&mesh.bounds_of(b).center2()[axis])
        });
        let (left, right) = part.split_at_mut(part.len() / 2);
        parts.extend([left, right]);
    }
    for (slot, part) in parts.into_iter().enumerate() {
        let bounds = bounds(mesh, part);
        let link = emit(tree, mesh, part, leaf);
        tree.nodes[index].set(slot, bounds, link);
    }
    Link::inner(index)
}

/// `n` small triangles in the cube from -1 to 1.
pub fn soup(n: usize, seed: u64) -> Mesh {
    let mut random = SplitMix64::new(seed);
    let size = 2.0 / (n as f32).cbrt();
    let vertices = (0..n)
        .flat_map(|_| {
            let centre = random.point(-1.0, 1.0);
            [0; 3].map(|_| (centre + size * random.point(-1.0, 1.0)).to_array())
        })
        .collect();
    mesh(vertices, (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// The six walls of the cube from -1 to 1, each `n` x `n` quads: coplanar, axis-aligned, flat boxes.
pub fn walls(n: usize) -> Mesh {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let base = vertices.len() as u32;
            for i in 0..=n {
                for j in 0..=n {
                    let mut vertex = [side; 3];
                    vertex[(axis + 1) % 3] = i as f32 / n as f32 * 2.0 - 1.0;
                    vertex[(axis + 2) % 3] = j as f32 / n as f32 * 2.0 - 1.0;
                    vertices.push(vertex);
                }
            }
            let row = n as u32 + 1;
            for i in 0..n as u32 {
                for j in 0..n as u32 {
                    let corner = base + i * row + j;
                    triangles.push([corner, corner + row, corner + 1]);
                    triangles.push([corner + row, corner + row + 1, corner + 1]);
                }
            }
        }
    }
    mesh(vertices, triangles)
}

pub fn mesh(vertices: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(vertices, triangles).unwrap().0
}

/// Both meshes in one.
pub fn joined(a: &Mesh, b: &Mesh) -> Mesh {
    let offset = a.vertices().len() as u32;
    let vertices = a.vertices().iter().chain(b.vertices()).copied().collect();
    let moved = b.triangles().iter().map(|t| t.map(|i| i + offset));
    mesh(vertices, a.triangles().iter().copied().chain(moved).collect())
}

/// Rays of all sorts around the cube from -1 to 1: any direction, along axes and in axis planes, from
/// outside, inside and from surfaces, with finite intervals.
pub fn rays(mesh: &Mesh, n: usize, seed: u64) -> Vec<Ray> {
    let mut random = SplitMix64::new(seed);
    (0..n)
        .map(|i| {
            let mut org = 2.0 * random.point(-1.0, 1.0);
            let mut dir = random.point(-1.0, 1.0);
            match i % 6 {
                0 => dir = random.point(-1.0, 1.0) * 0.5 - org,
                1 => {
                    let axis = random.below(3);
                    dir = Vec3::ZERO;
                    dir[axis] = if random.unit() < 0.5 { -2.0 } else { 0.5 };
                    org = random.point(-1.0, 1.0) - 3.0 * dir;
                }
                2 => dir[random.below(3)] = if random.unit() < 0.5 { 0.0 } else { -0.0 },
                3 if !mesh.is_empty() => {
                    let [a, b, c] = mesh.corners(random.below(mesh.len()) as u32);
                    let (u, v) = (0.5 * random.unit(), 0.5 * random.unit());
                    org = (a + u * (b - a) + v * (c - a)).into();
                }
                4 => org *= 0.4,
                _ => {}
            }
            let tnear = match i {
                _ if i % 7 == 0 => random.unit(),
                // From a surface, but not so near that rounding decides whether it is hit.
                _ if i % 6 == 3 => 1e-2,
                _ => 0.0,
            };
            let tfar = if i % 5 == 0 { tnear + 2.0 * random.unit() } else { f32::INFINITY };
            Ray { org, tnear, dir, tfar }
        })
        .collect()
}

pub fn closest(tracer: &dyn Tracer, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    tracer.closest(rays, &mut hits);
    hits
}

pub fn any(tracer: &dyn Tracer, rays: &[Ray]) -> Vec<bool> {
    let mut occluded = vec![false; rays.len()];
    tracer.any(rays, &mut occluded);
    occluded
}

/// One triangle in the plane z = 0 with corners at 0, x = 1 and y = 1.
pub fn one_triangle() -> Mesh {
    mesh(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])
}

pub fn ray(org: [f32; 3], dir: [f32; 3]) -> Ray {
    Ray { org: org.into(), tnear: 0.0, dir: dir.into(), tfar: f32::INFINITY }
}

/// A point of the box.
pub fn inside(bounds: Aabb, random: &mut SplitMix64) -> Vec3A {
    bounds.min + bounds.extent() * Vec3A::from(random.point(0.0, 1.0))
}
