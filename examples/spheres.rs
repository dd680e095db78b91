//! A tree over spheres, which the caller tests: leaves hold numbers. Anything with a box goes the same way.
//! `cargo run --release --no-default-features --example spheres`

use phr::geometry::{Aabb, Ray};
use phr::{BvhConfig, PrimitiveBvh, Primitives, glam::Vec3, random::SplitMix64};

const RADIUS: f32 = 0.004;
struct Spheres(Vec<Vec3>);

impl Primitives for Spheres {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, id: u32) -> Aabb {
        Aabb::new((self.0[id as usize] - RADIUS).into(), (self.0[id as usize] + RADIUS).into())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut random = SplitMix64::new(1);
    let spheres = Spheres((0..100_000).map(|_| random.point(-1.0, 1.0)).collect());
    let bvh = PrimitiveBvh::build(&spheres, &BvhConfig::default())?;
    // Where a ray of unit direction first meets a sphere in the ray's interval. NaN, of a miss, is in none.
    let meet = |id: u32, ray: &Ray| {
        let to = ray.org - spheres.0[id as usize];
        let b = to.dot(ray.dir);
        let root = (b * b - to.length_squared() + RADIUS * RADIUS).sqrt();
        [-b - root, -b + root].into_iter().find(|&t| ray.tnear < t && t <= ray.tfar)
    };
    for y in -12..12 {
        let org = |x: i32| Vec3::new(x as f32 / 36.0, y as f32 / 12.0, 3.0);
        let ray = |x| Ray::new(org(x), Vec3::NEG_Z);
        let depth = |x| bvh.intersect_with(&ray(x), meet).map_or(7, |hit| (3.5 * (hit.t - 2.0)) as usize);
        println!("{}", (-36..36).map(|x| "@#*+=-: ".as_bytes()[depth(x)] as char).collect::<String>());
    }
    let up = Ray { org: Vec3::new(0.0, 0.0, -3.0), tnear: 0.0, dir: Vec3::Z, tfar: 3.0 };
    println!("free to the middle: {}", !bvh.occluded_with(&up, |id, ray| meet(id, ray).is_some()));
    Ok(())
}
