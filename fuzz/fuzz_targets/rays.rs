//! Any rays against a tree: no panic, and the same answers alone and in a batch.

#![no_main]

use libfuzzer_sys::fuzz_target;
use phr::geometry::{Mesh, Ray};
use phr::{Bvh, BvhConfig};
use std::sync::OnceLock;

static BVHS: OnceLock<[Bvh; 2]> = OnceLock::new();

fn built(width: usize) -> Bvh {
    let mesh: Mesh = phr::scene::scalable(3000, 1).mesh;
    Bvh::build(&mesh, &BvhConfig { width, ..BvhConfig::default() }).unwrap()
}

fuzz_target!(init: phr_fuzz::one_thread(), |rays: Vec<([f32; 3], [f32; 3], f32, f32)>| {
    let rays: Vec<Ray> = rays
        .into_iter()
        .map(|(org, dir, tnear, tfar)| Ray { org: org.into(), dir: dir.into(), tnear, tfar })
        .collect();
    for bvh in BVHS.get_or_init(|| [built(4), built(8)]) {
        let mut hits = vec![None; rays.len()];
        bvh.intersect_batch(&rays, &mut hits);
        let mut occluded = vec![false; rays.len()];
        bvh.occluded_batch(&rays, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            let alone = bvh.intersect(ray);
            assert_eq!(alone, hits[i], "{ray:?}");
            assert_eq!(bvh.occluded(ray), occluded[i], "{ray:?}");
            assert_eq!(alone.is_some(), occluded[i], "{ray:?}");
            if let Some(hit) = alone {
                assert!(hit.t.is_finite() && hit.t > ray.tnear && hit.t <= ray.tfar, "{ray:?} {hit:?}");
            }
        }
    }
});
