//! Ray queries in streams: arrays of single rays (`rtcIntersect1M`, `rtcOccluded1M`) and arrays of packets of
//! sixteen (`rtcIntersectNM`, `rtcOccludedNM`), which Embree groups as it sees fit. Embree 4 has no such queries,
//! nor this module.

#![allow(unsafe_code)]

use super::arguments::Arguments;
use super::{EmbreeScene, query};
use crate::geometry::{Hit, Ray, Tracer};
use embree_sys as sys;

/// Rays handed over at a time. Embree works on up to 64 at once; more only save calls.
const STREAM: usize = 256;
/// Rays of a packet.
const LANES: usize = 16;

/// A committed scene traced in streams of single rays.
pub struct Stream<'s, 'a> {
    scene: &'s EmbreeScene<'a>,
    coherent: bool,
}

/// A committed scene traced in streams of packets.
pub struct PacketStream<'s, 'a> {
    scene: &'s EmbreeScene<'a>,
    coherent: bool,
}

impl<'a> EmbreeScene<'a> {
    fn has_streams(&self) -> bool {
        let property = sys::RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED;
        // SAFETY: the device is live.
        unsafe { sys::rtcGetDeviceProperty(self.device().raw(), property) == 1 }
    }

    /// Traces this scene in streams of single rays; `coherent` as for [`EmbreeScene::packets`]. `None` where this
    /// Embree has no streams.
    pub fn stream(&self, coherent: bool) -> Option<Stream<'_, 'a>> {
        self.has_streams().then_some(Stream { scene: self, coherent })
    }

    /// As [`EmbreeScene::stream`], in streams of packets.
    pub fn packet_stream(&self, coherent: bool) -> Option<PacketStream<'_, 'a>> {
        self.has_streams().then_some(PacketStream { scene: self, coherent })
    }
}

/// What Embree leaves alone: a ray whose interval is empty.
const INACTIVE: Ray = Ray { org: glam::Vec3::ZERO, tnear: 1.0, dir: glam::Vec3::X, tfar: 0.0 };

fn valid_or_inactive(ray: &Ray) -> &Ray {
    if ray.is_valid() { ray } else { &INACTIVE }
}

impl Tracer for Stream<'_, '_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        let mut arguments = Arguments::of(self.coherent);
        let mut stream = vec![sys::RTCRayHit::default(); STREAM.min(rays.len())];
        let stride = size_of::<sys::RTCRayHit>();
        for (rays, hits) in rays.chunks(STREAM).zip(hits.chunks_mut(STREAM)) {
            for (query, ray) in stream.iter_mut().zip(rays) {
                query.ray = query::embree_ray(valid_or_inactive(ray));
                query.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
            }
            // SAFETY: the scene is committed and live; as many queries as rays are whole, aligned by their type and not
            // shared; each ray is valid.
            unsafe {
                let count = rays.len() as u32;
                sys::rtcIntersect1M(
                    self.scene.raw(),
                    arguments.context(),
                    stream.as_mut_ptr(),
                    count,
                    stride,
                );
            }
            for (hit, query) in hits.iter_mut().zip(&stream) {
                *hit = query::found(
                    query.hit.geomID,
                    Hit { t: query.ray.tfar, u: query.hit.u, v: query.hit.v, prim: query.hit.primID },
                );
            }
        }
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        let mut arguments = Arguments::of(self.coherent);
        let mut stream = vec![sys::RTCRay::default(); STREAM.min(rays.len())];
        let stride = size_of::<sys::RTCRay>();
        for (rays, occluded) in rays.chunks(STREAM).zip(occluded.chunks_mut(STREAM)) {
            for (query, ray) in stream.iter_mut().zip(rays) {
                *query = query::embree_ray(valid_or_inactive(ray));
            }
            // SAFETY: as in `closest`.
            unsafe {
                let count = rays.len() as u32;
                sys::rtcOccluded1M(self.scene.raw(), arguments.context(), stream.as_mut_ptr(), count, stride);
            }
            for ((occluded, query), ray) in occluded.iter_mut().zip(&stream).zip(rays) {
                *occluded = query.tfar < 0.0 && ray.tfar >= 0.0;
            }
        }
    }
}

/// Fills lane `lane` of `packet`.
fn set(packet: &mut sys::RTCRay16, lane: usize, ray: &Ray) {
    packet.org_x[lane] = ray.org.x;
    packet.org_y[lane] = ray.org.y;
    packet.org_z[lane] = ray.org.z;
    packet.tnear[lane] = ray.tnear;
    packet.dir_x[lane] = ray.dir.x;
    packet.dir_y[lane] = ray.dir.y;
    packet.dir_z[lane] = ray.dir.z;
    packet.time[lane] = 0.0;
    packet.tfar[lane] = ray.tfar;
    packet.mask[lane] = u32::MAX;
    packet.id[lane] = 0;
    packet.flags[lane] = 0;
}

/// The rays of a packet, the last lanes inactive if there are fewer.
fn lanes(rays: &[Ray]) -> impl Iterator<Item = (usize, &Ray)> {
    (0..LANES).map(|lane| (lane, rays.get(lane).map_or(&INACTIVE, valid_or_inactive)))
}

impl Tracer for PacketStream<'_, '_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        let mut arguments = Arguments::of(self.coherent);
        let mut stream = vec![sys::RTCRayHit16::default(); STREAM.min(rays.len()).div_ceil(LANES)];
        for (rays, hits) in rays.chunks(STREAM).zip(hits.chunks_mut(STREAM)) {
            for (packet, rays) in stream.iter_mut().zip(rays.chunks(LANES)) {
                lanes(rays).for_each(|(lane, ray)| set(&mut packet.ray, lane, ray));
                packet.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; LANES];
            }
            let packets = rays.len().div_ceil(LANES) as u32;
            let stride = size_of::<sys::RTCRayHit16>();
            // SAFETY: the scene is committed and live; so many packets are whole, aligned by their type and not shared;
            // each ray is valid.
            unsafe {
                let first = stream.as_mut_ptr().cast();
                sys::rtcIntersectNM(
                    self.scene.raw(),
                    arguments.context(),
                    first,
                    LANES as u32,
                    packets,
                    stride,
                );
            }
            for (packet, hits) in stream.iter().zip(hits.chunks_mut(LANES)) {
                for (lane, hit) in hits.iter_mut().enumerate() {
                    let (ray, found) = (&packet.ray, &packet.hit);
                    let (u, v, prim) = (found.u[lane], found.v[lane], found.primID[lane]);
                    *hit = query::found(found.geomID[lane], Hit { t: ray.tfar[lane], u, v, prim });
                }
            }
        }
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        let mut arguments = Arguments::of(self.coherent);
        let mut stream = vec![sys::RTCRay16::default(); STREAM.min(rays.len()).div_ceil(LANES)];
        for (rays, occluded) in rays.chunks(STREAM).zip(occluded.chunks_mut(STREAM)) {
            for (packet, rays) in stream.iter_mut().zip(rays.chunks(LANES)) {
                lanes(rays).for_each(|(lane, ray)| set(packet, lane, ray));
            }
            let packets = rays.len().div_ceil(LANES) as u32;
            let stride = size_of::<sys::RTCRay16>();
            // SAFETY: as in `closest`.
            unsafe {
                let first = stream.as_mut_ptr().cast();
                sys::rtcOccludedNM(
                    self.scene.raw(),
                    arguments.context(),
                    first,
                    LANES as u32,
                    packets,
                    stride,
                );
            }
            let answers = stream.iter().zip(occluded.chunks_mut(LANES)).zip(rays.chunks(LANES));
            for ((packet, occluded), rays) in answers {
                for (lane, (occluded, ray)) in occluded.iter_mut().zip(rays).enumerate() {
                    *occluded = packet.tfar[lane] < 0.0 && ray.tfar >= 0.0;
                }
            }
        }
    }
}
