//! Every ray against every triangle, in double precision: the tracer that tests believe.

use crate::geometry::{Hit, Mesh, Ray, Tracer};

/// Traces without any tree. Edges count as hit; among equal distances the lowest triangle wins.
#[derive(Clone, Copy, Debug)]
pub struct BruteForce<'a>(pub &'a Mesh);

impl BruteForce<'_> {
    /// Distance and barycentric coordinates of the second and third corner.
    fn intersect(&self, ray: &Ray, prim: u32) -> Option<[f64; 3]> {
        let [a, b, c] = self.0.corners(prim).map(|corner| corner.as_dvec3());
        let (org, dir) = (ray.org.as_dvec3(), ray.dir.as_dvec3());
        let across = dir.cross(c - a);
        let det = across.dot(b - a);
        if det == 0.0 {
            return None;
        }
        let u = across.dot(org - a) / det;
        let beyond = (org - a).cross(b - a);
        let v = beyond.dot(dir) / det;
        let t = beyond.dot(c - a) / det;
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        let within = f64::from(ray.tnear) < t && t <= f64::from(ray.tfar);
        (inside && within).then_some([t, u, v])
    }
}

impl Tracer for BruteForce<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            let mut best = [f64::INFINITY, 0.0, 0.0];
            let mut prim = Hit::NONE;
            for candidate in 0..self.0.len() as u32 {
                if let Some(crossing) = self.intersect(ray, candidate)
                    && crossing[0] < best[0]
                {
                    (best, prim) = (crossing, candidate);
                }
            }
            let [t, u, v] = best.map(|x| x as f32);
            *hit = Hit { t, u, v, prim };
        }
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        for (ray, occluded) in rays.iter().zip(occluded) {
            *occluded = (0..self.0.len() as u32).any(|prim| self.intersect(ray, prim).is_some());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn the_interval_is_open_at_its_start() {
        let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap().0;
        let trace = |tnear, tfar| {
            let ray = Ray { org: Vec3::new(0.25, 0.5, 2.0), tnear, dir: Vec3::NEG_Z, tfar };
            let mut hits = [Hit::MISS];
            BruteForce(&mesh).closest(&[ray], &mut hits);
            hits[0]
        };
        assert_eq!(trace(0.0, f32::INFINITY), Hit { t: 2.0, u: 0.25, v: 0.5, prim: 0 });
        assert!(trace(0.0, 2.0).is_hit());
        assert!(!trace(2.0, 3.0).is_hit());
        assert!(!trace(0.0, 1.999).is_hit());
    }
}
