//! Ray queries in packets of eight or sixteen (`rtcIntersect8`, `rtcIntersect16` and their `rtcOccluded`): Embree's
//! gain from coherent rays. Trees are ranked by single rays; packets, and the streams of Embree 3, are what our own
//! batches are measured against.

#![allow(unsafe_code)]

use super::arguments::Arguments;
use super::{EmbreeScene, query};
use crate::geometry::{Hit, Ray, Tracer};
use embree_sys as sys;

/// A committed scene traced in packets of `LANES` rays, in the order given.
pub struct Packets<'s, 'a, const LANES: usize> {
    scene: &'s EmbreeScene<'a>,
    coherent: bool,
}

impl<'a> EmbreeScene<'a> {
    /// Traces this scene in packets of `LANES` rays, 8 or 16. `coherent` promises that neighbouring rays go alike, as
    /// from a camera: faster for those, much slower for others. `None` where this Embree has no such kernels.
    pub fn packets<const LANES: usize>(&self, coherent: bool) -> Option<Packets<'_, 'a, LANES>> {
        let property = match LANES {
            8 => sys::RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED,
            16 => sys::RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED,
            _ => return None,
        };
        // SAFETY: the device is live.
        let supported = unsafe { sys::rtcGetDeviceProperty(self.device().raw(), property) };
        (supported == 1).then_some(Packets { scene: self, coherent })
    }
}

/// -1 for a lane that is traced, 0 for one that is not; aligned as Embree reads it.
#[repr(align(64))]
struct Mask<const LANES: usize>([i32; LANES]);

/// A packet of `$lanes` rays: its filling, and both queries.
macro_rules! packets {
    ($lanes:literal, $ray:ident, $ray_hit:ident, $intersect:ident, $occluded:ident) => {
        impl Packets<'_, '_, $lanes> {
            /// Fills the lanes of `packet`; lanes without a valid ray are switched off in the mask returned.
            fn fill(packet: &mut sys::$ray, rays: &[Ray]) -> Mask<$lanes> {
                let mut mask = Mask([0; $lanes]);
                for (lane, ray) in rays.iter().enumerate().filter(|(_, ray)| ray.is_valid()) {
                    mask.0[lane] = -1;
                    packet.org_x[lane] = ray.org.x;
                    packet.org_y[lane] = ray.org.y;
                    packet.org_z[lane] = ray.org.z;
                    packet.tnear[lane] = ray.tnear;
                    packet.dir_x[lane] = ray.dir.x;
                    packet.dir_y[lane] = ray.dir.y;
                    packet.dir_z[lane] = ray.dir.z;
                    packet.tfar[lane] = ray.tfar;
                }
                mask
            }
        }

        impl Tracer for Packets<'_, '_, $lanes> {
            fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
                let mut arguments = Arguments::of(self.coherent);
                let mut packet = sys::$ray_hit::default();
                packet.ray.mask = [u32::MAX; $lanes];
                for (rays, hits) in rays.chunks($lanes).zip(hits.chunks_mut($lanes)) {
                    let mask = Self::fill(&mut packet.ray, rays);
                    packet.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; $lanes];
                    // SAFETY: the scene is committed and live; mask and packet are whole and aligned by their
                    // types; lanes that are on hold valid rays.
                    unsafe { arguments.$intersect(mask.0.as_ptr(), self.scene.raw(), &mut packet) };
                    for (lane, hit) in hits.iter_mut().enumerate() {
                        let (ray, found) = (&packet.ray, &packet.hit);
                        let (u, v, prim) = (found.u[lane], found.v[lane], found.primID[lane]);
                        *hit = query::found(found.geomID[lane], Hit { t: ray.tfar[lane], u, v, prim });
                    }
                }
            }

            fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
                let mut arguments = Arguments::of(self.coherent);
                let mut packet = sys::$ray { mask: [u32::MAX; $lanes], ..Default::default() };
                for (rays, occluded) in rays.chunks($lanes).zip(occluded.chunks_mut($lanes)) {
                    let mask = Self::fill(&mut packet, rays);
                    // SAFETY: as in `closest`.
                    unsafe { arguments.$occluded(mask.0.as_ptr(), self.scene.raw(), &mut packet) };
                    for (lane, (ray, occluded)) in rays.iter().zip(occluded).enumerate() {
                        *occluded = mask.0[lane] != 0 && packet.tfar[lane] < 0.0 && ray.tfar >= 0.0;
                    }
                }
            }
        }
    };
}

packets!(8, RTCRay8, RTCRayHit8, intersect8, occluded8);
packets!(16, RTCRay16, RTCRayHit16, intersect16, occluded16);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::test_meshes::{rays, soup};
    use crate::embree::{Config, Device, EmbreeBuilder, Width};
    use crate::simd::Isa;

    #[test]
    fn packets_and_streams_hit_what_single_rays_hit() {
        let (mesh, mut rays) = (soup(1000), rays(3003));
        rays[20].dir.x = f32::NAN;
        rays[3002].tnear = -1.0;
        for width in Width::ALL {
            let device = Device::new(&Config { builder: EmbreeBuilder::Sah, width, threads: 1 }).unwrap();
            let scene = device.prepare(&mesh).unwrap().commit().unwrap();
            let mut single = vec![Hit::MISS; rays.len()];
            scene.closest(&rays, &mut single);
            let mut batches: Vec<Box<dyn Tracer>> = Vec::new();
            for coherent in [false, true] {
                batches
                    .extend(scene.packets::<8>(coherent).map(|packets| Box::new(packets) as Box<dyn Tracer>));
                batches.extend(
                    scene.packets::<16>(coherent).map(|packets| Box::new(packets) as Box<dyn Tracer>),
                );
                #[cfg(not(embree4))]
                {
                    let stream = scene.stream(coherent);
                    batches.extend(stream.map(|stream| Box::new(stream) as Box<dyn Tracer>));
                    let stream = scene.packet_stream(coherent);
                    batches.extend(stream.map(|stream| Box::new(stream) as Box<dyn Tracer>));
                }
            }
            // Packets of 8 with AVX at least, each with the flag for coherent rays and without.
            assert!(batches.len() >= 2 || matches!(Isa::best(), Isa::Scalar));
            for batch in batches {
                let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![true; rays.len()]);
                batch.closest(&rays, &mut hits);
                batch.any(&rays, &mut occluded);
                for ((hit, occluded), single) in hits.iter().zip(occluded).zip(&single) {
                    assert_eq!((hit.is_hit(), occluded), (single.is_hit(), single.is_hit()));
                    assert!(
                        hit.t == single.t || (hit.t - single.t).abs() <= 1e-4 * single.t,
                        "{hit:?} {single:?}"
                    );
                }
            }
        }
    }
}
