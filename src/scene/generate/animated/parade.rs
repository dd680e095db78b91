//! Statues on wheels and cars on their rounds through a town: rigid parts among static ones, which are most.

use super::super::city::{car, town};
use super::super::generated_scene::view;
use super::super::parts::{Draft, Frame, draw};
use super::super::statue::figure;
use super::animation::{Animated, Animation, append};
use glam::Vec3;

/// The parade.
pub const PARADE: Animated = Animated {
    name: "parade",
    triangles: 250_000,
    about: "turning statues and cars on their rounds through a town that stands still",
    seed: 24,
    make,
};

/// Side of a block of houses with its streets, as in the town.
const BLOCK: f32 = 45.0;
/// Statues and cars; the share of triangles of all statues, and of all cars.
const STATUES: usize = 16;
const CARS: usize = 24;
const SHARES: [f32; 2] = [0.24, 0.06];
/// How much of a round about a block each part goes.
const ROUND: f32 = 0.8;

/// A part that goes a round about one of the four blocks.
struct Mover {
    block: [f32; 2],
    /// Where on the round it starts, and how far it goes, in rounds; backwards if negative.
    start: f32,
    way: f32,
    /// Turns about itself, besides those of the street.
    spin: f32,
    /// How far from the middle of the street.
    aside: f32,
}

fn make(animated: &Animated, triangles: usize) -> Animation {
    let [statue_size, car_size] = [(SHARES[0], STATUES), (SHARES[1], CARS)]
        .map(|(share, count)| (share * triangles as f32 / count as f32) as usize);
    let fixed = triangles - statue_size * STATUES - car_size * CARS;
    let mut draft = draw(fixed, animated.seed, &|layout| town(layout, [2, 2], 5.0));
    let still = draft.vertices.len();
    let (mut mover_of, mut movers) = (Vec::new(), Vec::new());
    let mut add = |mover: Mover, part: Draft, draft: &mut Draft| {
        mover_of.resize(mover_of.len() + part.vertices.len(), movers.len() as u32);
        movers.push(mover);
        append(draft, part);
    };
    for i in 0..STATUES {
        let statue = draw(statue_size, animated.seed + 1 + i as u64, &|layout| {
            figure(layout, &Frame::WORLD.sized(7.0), layout.seed, [60.0, 2.0]);
        });
        let way = if i % 2 == 0 { ROUND } else { -ROUND };
        add(Mover { way, spin: 2.0, aside: 0.0, ..Mover::of(i, STATUES) }, statue, &mut draft);
    }
    for i in 0..CARS {
        let made = draw(car_size, animated.seed + 101 + i as u64, &|layout| car(layout, &Frame::WORLD));
        let (way, aside) = if i % 2 == 0 { (2.0 * ROUND, 4.6) } else { (-2.0 * ROUND, -4.6) };
        add(Mover { way, spin: 0.0, aside, ..Mover::of(i, CARS) }, made, &mut draft);
    }
    let views = [
        view([-30.0, 34.0, -26.0], [45.0, 0.0, 44.0], 50.0),
        view([45.0, 2.2, -12.0], [45.0, 4.0, 60.0], 65.0),
        view([-8.0, 12.0, 45.0], [60.0, 2.0, 46.0], 55.0),
    ];
    let motion = move |i: usize, rest: Vec3, time: f32| match i.checked_sub(still) {
        Some(i) => movers[mover_of[i] as usize].at(time).point(rest),
        None => rest,
    };
    animated.animation(draft, fixed, &views, Box::new(motion))
}

impl Mover {
    fn of(i: usize, count: usize) -> Self {
        let block = [(i % 2) as f32 * BLOCK, (i / 2 % 2) as f32 * BLOCK];
        Self { block, start: i as f32 / count as f32, way: 0.0, spin: 0.0, aside: 0.0 }
    }

    /// The frame at `time`: along the four sides of the block, through the middle of the streets, with turned corners.
    fn at(&self, time: f32) -> Frame {
        let round = self.start + self.way * time;
        let at = (round - round.floor()) * 4.0;
        let side = at.floor();
        let corner = Frame::at(self.block[0] + 0.5 * BLOCK, 0.0, self.block[1] + 0.5 * BLOCK);
        let street = corner.turned(1, 0.25 * side);
        let along = street.moved((at - side - 0.5) * BLOCK, 0.0, 0.5 * BLOCK + self.aside);
        along.turned(1, self.spin * time)
    }
}
