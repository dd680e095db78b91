//! A statue that bursts into shards, each of which flies and tumbles on its own: what was together is soon anywhere.

use super::super::generated_scene::view;
use super::super::parts::{Draft, Frame, Random, draw};
use super::super::statue::figure;
use super::animation::{Animated, Animation, append, floor};
use glam::Vec3;
use std::collections::HashMap;

/// The bursting statue.
pub const BURST: Animated = Animated {
    name: "burst",
    triangles: 200_000,
    about: "a statue that bursts into tumbling shards",
    seed: 22,
    make,
};

/// Side of the cells whose triangles stay together; the statue is 1 high.
const CELL: f32 = 0.05;
/// Height of the pedestal on which it stands.
const PEDESTAL: f32 = 0.6;

/// A part that flies as a whole.
struct Shard {
    center: Vec3,
    velocity: Vec3,
    axis: Vec3,
    turns: f32,
}

fn make(animated: &Animated, triangles: usize) -> Animation {
    let mut draft = floor(4.0);
    let fixed = draft.triangles.len();
    let frame = Frame::at(0.0, PEDESTAL, 0.0);
    let statue =
        draw(triangles - fixed, animated.seed, &|layout| figure(layout, &frame, layout.seed, [220.0, 7.2]));
    let (apart, shard_of, shards) = shattered(&statue, animated.seed);
    let still = draft.vertices.len();
    append(&mut draft, apart);
    let views = [
        view([1.3, 1.5, 3.2], [0.0, 0.95, 0.0], 45.0),
        view([-2.2, 0.9, 1.2], [0.0, 0.9, 0.0], 50.0),
        view([0.4, 3.4, 1.2], [0.0, 0.8, 0.0], 50.0),
    ];
    let motion = move |i: usize, rest: Vec3, time: f32| match i.checked_sub(still) {
        Some(i) => shards[shard_of[i] as usize].at(rest, time),
        None => rest,
    };
    animated.animation(draft, fixed, &views, Box::new(motion))
}

/// The triangles with vertices of their own for each shard, the shard of each vertex, and the shards.
fn shattered(statue: &Draft, seed: u64) -> (Draft, Vec<u32>, Vec<Shard>) {
    let (mut apart, mut shard_of, mut shards) = (Draft::default(), Vec::new(), Vec::new());
    let (mut known, mut copies) = (HashMap::new(), HashMap::new());
    for triangle in &statue.triangles {
        let corners = triangle.map(|i| Vec3::from_array(statue.vertices[i as usize]));
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        let cell = (center / CELL).floor();
        let shard = *known.entry(cell.to_array().map(|x| x as i32)).or_insert_with(|| {
            shards.push(Shard::of((cell + 0.5) * CELL, (seed, shards.len() as u64)));
            shards.len() as u32 - 1
        });
        let copied = triangle.map(|vertex| {
            *copies.entry((vertex, shard)).or_insert_with(|| {
                apart.vertices.push(statue.vertices[vertex as usize]);
                shard_of.push(shard);
                apart.vertices.len() as u32 - 1
            })
        });
        apart.triangles.push(copied);
    }
    (apart, shard_of, shards)
}

impl Shard {
    /// The shard around `center`, which flies outwards and anywhere.
    fn of(center: Vec3, (seed, stream): (u64, u64)) -> Self {
        let mut random = Random::new(seed, stream);
        let outwards = (center - Vec3::new(0.0, PEDESTAL + 0.3, 0.0)) * random.between(0.5, 1.5);
        let velocity = outwards + random.in_ball() * 0.9 + Vec3::Y * random.between(0.2, 0.9);
        Self { center, velocity, axis: random.in_ball().normalize(), turns: random.between(0.2, 1.5) }
    }

    fn at(&self, rest: Vec3, time: f32) -> Vec3 {
        // Each falls until it lies on the floor.
        let fall = Vec3::Y * (-0.9 * time * time);
        let mut center = self.center + self.velocity * time + fall;
        center.y = center.y.max(CELL.min(self.center.y));
        let (sin, cos) = super::super::parts::sin_cos(self.turns * time);
        let arm = rest - self.center;
        let along = self.axis * self.axis.dot(arm);
        center + along + (arm - along) * cos + self.axis.cross(arm) * sin
    }
}
