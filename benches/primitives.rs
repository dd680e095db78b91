//! Traversal with a test of the caller's against a loop written by hand over the same tree: rays of a camera and random
//! rays through spheres, one thread: `cargo bench --bench primitives`.

#![allow(missing_docs)] // criterion's macros make undocumented functions
#![allow(unsafe_code)] // a function compiled for AVX2

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use phr::bvh::{Child, IdBlock, LeafBlock as _, Link, WideBvh, WideNode};
use phr::geometry::{Aabb, Ray};
use phr::random::SplitMix64;
use phr::{BvhConfig, PrimitiveBvh};
use std::hint::black_box;

type Sphere = (Vec3, f32);

#[inline(always)]
fn hit((centre, radius): Sphere, ray: &Ray) -> Option<f32> {
    let to = ray.org - centre;
    let (b, c) = (to.dot(ray.dir), to.length_squared() - radius * radius);
    let discriminant = b * b - c;
    if discriminant < 0.0 {
        return None;
    }
    let t = -b - discriminant.sqrt();
    (ray.tnear < t && t <= ray.tfar).then_some(t)
}

/// Where the ray enters each child, infinite where it does not.
#[inline(always)]
fn entries(node: &WideNode<8>, ray: &Ray, rdir: Vec3, tfar: f32) -> [f32; 8] {
    let (mut near, mut far) = ([ray.tnear; 8], [tfar; 8]);
    for axis in 0..3 {
        for slot in 0..8 {
            let a = (node.lower[axis][slot] - ray.org[axis]) * rdir[axis];
            let b = (node.upper[axis][slot] - ray.org[axis]) * rdir[axis];
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            near[slot] = if low > near[slot] { low } else { near[slot] };
            far[slot] = if high < far[slot] { high } else { far[slot] };
        }
    }
    std::array::from_fn(|slot| if near[slot] <= far[slot] { near[slot] } else { f32::INFINITY })
}

/// What an application would write: a stack of links, nearest child first.
#[inline(always)]
fn by_hand(tree: &WideBvh<8, IdBlock>, spheres: &[Sphere], ray: &Ray) -> Option<(f32, u32)> {
    let rdir = 1.0 / ray.dir;
    let mut closest = None;
    let mut ray = *ray;
    let mut stack = [(0.0f32, Link::EMPTY); 256];
    stack[0].1 = tree.root;
    let mut len = 1;
    while len > 0 {
        len -= 1;
        let (entry, link) = stack[len];
        if entry > ray.tfar {
            continue;
        }
        match link.get() {
            Child::Empty => {}
            Child::Inner(index) => {
                let node = &tree.nodes[index];
                let base = len;
                for (slot, entry) in entries(node, &ray, rdir, ray.tfar).into_iter().enumerate() {
                    if entry < f32::INFINITY {
                        let mut at = len;
                        while at > base && stack[at - 1].0 < entry {
                            stack[at] = stack[at - 1];
                            at -= 1;
                        }
                        stack[at] = (entry, node.links[slot]);
                        len += 1;
                    }
                }
            }
            Child::Leaf { first, count } => {
                for id in tree.blocks[first..first + count].iter().flat_map(IdBlock::ids) {
                    if let Some(t) = hit(spheres[id as usize], &ray) {
                        closest = Some((t, id));
                        ray.tfar = t;
                    }
                }
            }
        }
    }
    closest
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn by_hand_avx2(tree: &WideBvh<8, IdBlock>, spheres: &[Sphere], rays: &[Ray]) -> f32 {
    rays.iter().filter_map(|ray| by_hand(tree, spheres, ray)).map(|(t, _)| t).sum()
}

fn primitives(criterion: &mut Criterion) {
    let mut random = SplitMix64::new(1);
    let spheres: Vec<Sphere> =
        (0..200_000).map(|_| (random.point(-1.0, 1.0), 0.002 + 0.006 * random.unit())).collect();
    let boxes: Vec<Aabb> = spheres
        .iter()
        .map(|&(centre, radius)| Aabb::new((centre - radius).into(), (centre + radius).into()))
        .collect();
    let bvh =
        PrimitiveBvh::build(&boxes, &BvhConfig { builder: "phr-speed", width: 8 }).expect("finite boxes");
    let tree = bvh.as_bvh8().expect("of width 8");
    let ray = |org: Vec3, at: Vec3| Ray { org, tnear: 0.0, dir: (at - org).normalize(), tfar: f32::INFINITY };
    let camera = (0..1 << 14).map(|i| {
        ray(
            Vec3::new(0.0, 0.0, 3.0),
            Vec3::new((i % 128) as f32 / 64.0 - 1.0, (i / 128) as f32 / 64.0 - 1.0, 0.0),
        )
    });
    let sets = [
        ("camera", camera.collect::<Vec<_>>()),
        ("random", (0..1 << 14).map(|_| ray(random.point(-1.0, 1.0), random.point(-1.0, 1.0))).collect()),
    ];
    for (name, rays) in &sets {
        let generic = |ray: &Ray| bvh.intersect_with(ray, |id, ray| hit(spheres[id as usize], ray));
        for ray in rays {
            assert_eq!(generic(ray).map(|hit| hit.t), by_hand(tree, &spheres, ray).map(|(t, _)| t));
        }
        let mut group = criterion.benchmark_group(format!("spheres/{name}"));
        group.sample_size(20).throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function(BenchmarkId::from_parameter("intersect_with"), |bencher| {
            bencher.iter(|| black_box(rays.iter().filter_map(generic).map(|hit| hit.t).sum::<f32>()));
        });
        group.bench_function(BenchmarkId::from_parameter("by hand"), |bencher| {
            bencher.iter(|| {
                let hits = rays.iter().filter_map(|ray| by_hand(tree, &spheres, ray));
                black_box(hits.map(|(t, _)| t).sum::<f32>())
            });
        });
        #[cfg(target_arch = "x86_64")]
        if phr::trace::Isa::best() != phr::trace::Isa::Scalar {
            group.bench_function(BenchmarkId::from_parameter("by hand, AVX2"), |bencher| {
                // SAFETY: the library found all of AVX2, FMA, BMI and LZCNT.
                bencher.iter(|| black_box(unsafe { by_hand_avx2(tree, &spheres, rays) }));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, primitives);
criterion_main!(benches);
