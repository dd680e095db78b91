//! Ray queries: our rays into Embree's structures and its hits into ours.
//!
//! Debian's Embree is compiled with assertions and aborts on an invalid ray, so none may reach it. Rays are
//! checked in runs of [`RUN`], which stay in the first-level cache, before the run is traced: one to two
//! nanoseconds per ray where tracing takes hundreds, and the traced loop itself holds nothing but the conversion
//! and the call.

#![allow(unsafe_code)]

use super::EmbreeScene;
use super::arguments::Arguments;
use crate::geometry::{Hit, Ray, Tracer};
use embree_sys as sys;

/// Rays checked at a time: 8 KiB.
const RUN: usize = 256;

/// The hit that Embree wrote, or a miss if it found no geometry.
#[inline(always)]
pub(super) fn found(geometry: u32, hit: Hit) -> Hit {
    if geometry == sys::RTC_INVALID_GEOMETRY_ID { Hit::MISS } else { hit }
}

impl Tracer for EmbreeScene<'_> {
    /// An invalid ray misses.
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        debug_assert_eq!(rays.len(), hits.len());
        let (scene, mut arguments) = (self.raw(), Arguments::new());
        let mut query = sys::RTCRayHit::default();
        let mut trace = |ray: &Ray| {
            query.ray = embree_ray(ray);
            query.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
            // SAFETY: the scene is committed and live; the query is whole and aligned by its type; the ray is valid.
            unsafe { arguments.intersect1(scene, &mut query) };
            let hit = Hit { t: query.ray.tfar, u: query.hit.u, v: query.hit.v, prim: query.hit.primID };
            found(query.hit.geomID, hit)
        };
        for (rays, hits) in rays.chunks(RUN).zip(hits.chunks_mut(RUN)) {
            if all_valid(rays) {
                for (ray, hit) in rays.iter().zip(hits) {
                    *hit = trace(ray);
                }
            } else {
                for (ray, hit) in rays.iter().zip(hits) {
                    *hit = if ray.is_valid() { trace(ray) } else { Hit::MISS };
                }
            }
        }
    }

    /// An invalid ray hits nothing.
    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        debug_assert_eq!(rays.len(), occluded.len());
        let (scene, mut arguments) = (self.raw(), Arguments::new());
        let mut trace = |ray: &Ray| {
            let mut query = embree_ray(ray);
            // SAFETY: as in `closest`.
            unsafe { arguments.occluded1(scene, &mut query) };
            // A hit sets `tfar` to minus infinity; a segment that ends before its start hits nothing.
            query.tfar < 0.0 && ray.tfar >= 0.0
        };
        for (rays, occluded) in rays.chunks(RUN).zip(occluded.chunks_mut(RUN)) {
            if all_valid(rays) {
                for (ray, occluded) in rays.iter().zip(occluded) {
                    *occluded = trace(ray);
                }
            } else {
                for (ray, occluded) in rays.iter().zip(occluded) {
                    *occluded = ray.is_valid() && trace(ray);
                }
            }
        }
    }
}

/// True if Embree accepts all of them; without a branch per ray.
fn all_valid(rays: &[Ray]) -> bool {
    rays.iter().fold(true, |all, ray| all & ray.is_valid())
}

#[inline(always)]
pub(super) fn embree_ray(ray: &Ray) -> sys::RTCRay {
    sys::RTCRay {
        org_x: ray.org.x,
        org_y: ray.org.y,
        org_z: ray.org.z,
        tnear: ray.tnear,
        dir_x: ray.dir.x,
        dir_y: ray.dir.y,
        dir_z: ray.dir.z,
        time: 0.0,
        tfar: ray.tfar,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

#[cfg(test)]
mod tests {
    use crate::embree::test_meshes::{rays, soup};
    use crate::embree::{Config, Device, EmbreeBuilder, Width};
    use crate::geometry::{Hit, Tracer};

    #[test]
    fn all_builders_hit_the_same_with_and_without_invalid_rays_in_the_batch() {
        let mesh = soup(2000);
        let rays = rays(2000);
        let mut reference: Option<Vec<Hit>> = None;
        for width in Width::ALL {
            for builder in EmbreeBuilder::ALL {
                let device = Device::new(&Config { builder, width, threads: 1 }).unwrap();
                let scene = device.prepare(&mesh).unwrap().commit().unwrap();
                let mut hits = vec![Hit::MISS; rays.len()];
                let mut occluded = vec![false; rays.len()];
                scene.closest(&rays, &mut hits);
                scene.any(&rays, &mut occluded);
                let reference = reference.get_or_insert_with(|| hits.clone());
                for ((hit, occluded), expected) in hits.iter().zip(&occluded).zip(reference.iter()) {
                    assert_eq!((hit.is_hit(), *occluded), (expected.is_hit(), expected.is_hit()));
                    assert!(hit.t == expected.t || (hit.t - expected.t).abs() <= 1e-5 * hit.t);
                }
                let mut spoiled = rays.clone();
                spoiled[700].org.x = f32::NAN;
                let mut others = vec![Hit::MISS; rays.len()];
                scene.closest(&spoiled, &mut others);
                hits[700] = Hit::MISS;
                assert_eq!(others, hits);
            }
        }
        let hit = reference.unwrap().iter().filter(|hit| hit.is_hit()).count();
        assert!((100..1900).contains(&hit), "{hit} hits");
    }
}
