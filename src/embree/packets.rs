//! Ray queries in packets of eight (`rtcIntersect8`, `rtcOccluded8`): Embree's gain from coherent
//! rays. Trees are ranked by single rays; this is an extra column.

#![allow(unsafe_code)]

use super::{EmbreeScene, query};
use crate::geometry::{Hit, Ray, Tracer};
use embree_sys as sys;

const LANES: usize = 8;

/// A committed scene traced in packets of eight rays, in the order given.
pub struct Packets<'s, 'a> {
    scene: &'s EmbreeScene<'a>,
    coherent: bool,
}

impl<'a> EmbreeScene<'a> {
    /// Traces this scene in packets of eight. `coherent` promises that neighbouring rays go alike, as from a
    /// camera: faster for those, much slower for others. `None` where this Embree has no such kernels.
    pub fn packets(&self, coherent: bool) -> Option<Packets<'_, 'a>> {
        // SAFETY: the device is live.
        let supported = unsafe {
            sys::rtcGetDeviceProperty(self.device().raw(), sys::RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)
        };
        (supported == 1).then_some(Packets { scene: self, coherent })
    }
}

impl Packets<'_, '_> {
    fn context(&self) -> sys::RTCIntersectContext {
        let mut context = query::context();
        if self.coherent {
            context.flags = sys::RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        }
        context
    }
}

/// Fills the lanes of `packet`; lanes without a valid ray are switched off in the mask returned.
fn fill(packet: &mut sys::RTCRay8, rays: &[Ray]) -> Mask {
    let mut mask = Mask([0; LANES]);
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

/// -1 for a lane that is traced, 0 for one that is not; aligned as Embree reads it.
#[repr(align(32))]
struct Mask([i32; LANES]);

impl Tracer for Packets<'_, '_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        let mut context = self.context();
        let mut packet = sys::RTCRayHit8::default();
        packet.ray.mask = [u32::MAX; LANES];
        for (rays, hits) in rays.chunks(LANES).zip(hits.chunks_mut(LANES)) {
            let mask = fill(&mut packet.ray, rays);
            packet.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; LANES];
            // SAFETY: the scene is committed and live; mask and packet are whole, aligned by their types and
            // not shared; lanes that are on hold valid rays.
            unsafe { sys::rtcIntersect8(mask.0.as_ptr(), self.scene.raw(), &mut context, &mut packet) };
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = if packet.hit.geomID[lane] == sys::RTC_INVALID_GEOMETRY_ID {
                    Hit::MISS
                } else {
                    Hit {
                        t: packet.ray.tfar[lane],
                        u: packet.hit.u[lane],
                        v: packet.hit.v[lane],
                        prim: packet.hit.primID[lane],
                    }
                };
            }
        }
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        let mut context = self.context();
        let mut packet = sys::RTCRay8 { mask: [u32::MAX; LANES], ..Default::default() };
        for (rays, occluded) in rays.chunks(LANES).zip(occluded.chunks_mut(LANES)) {
            let mask = fill(&mut packet, rays);
            // SAFETY: as in `closest`.
            unsafe { sys::rtcOccluded8(mask.0.as_ptr(), self.scene.raw(), &mut context, &mut packet) };
            for (lane, (ray, occluded)) in rays.iter().zip(occluded).enumerate() {
                *occluded = mask.0[lane] != 0 && packet.tfar[lane] < 0.0 && ray.tfar >= 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::test_meshes::{rays, soup};
    use crate::embree::{Config, Device, EmbreeBuilder, Width};

    #[test]
    fn packets_hit_what_single_rays_hit() {
        let (mesh, mut rays) = (soup(1000), rays(3003));
        rays[20].dir.x = f32::NAN;
        rays[3002].tnear = -1.0;
        for width in Width::ALL {
            let device = Device::new(&Config { builder: EmbreeBuilder::Sah, width, threads: 1 }).unwrap();
            let scene = device.prepare(&mesh).unwrap().commit().unwrap();
            let mut single = vec![Hit::MISS; rays.len()];
            scene.closest(&rays, &mut single);
            for packets in [false, true].into_iter().filter_map(|coherent| scene.packets(coherent)) {
                let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![true; rays.len()]);
                packets.closest(&rays, &mut hits);
                packets.any(&rays, &mut occluded);
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
