//! A ball of curled hair: long thin triangles in every direction, boxes that overlap everywhere.

use super::generated_scene::{Generator, view};
use super::parts::{Frame, Layout, Shape, mix};

/// The built-in hair ball.
pub const HAIRBALL: Generator = Generator {
    name: "hair",
    triangles: 200_000,
    about: "a ball of curled hair: long thin triangles in every direction",
    seed: 3,
    layout: |layout| ball(layout, &Frame::WORLD.sized(5.0), 1_400.0, 0.006),
    views: &[
        view([0.0, 2.0, 13.5], [0.0, 0.0, 0.0], 45.0),
        view([-6.0, 1.0, 3.5], [-1.5, 0.2, 0.4], 45.0),
        view([1.2, 3.9, 2.4], [0.2, 0.8, 0.4], 60.0),
    ],
};

/// The stand-in for Hairball.
pub const HAIRBALL_FULL: Generator = Generator {
    name: "hairball-like",
    triangles: 2_880_000,
    seed: 14,
    layout: |layout| ball(layout, &Frame::WORLD.sized(5.0), 1_400.0, 0.003),
    ..HAIRBALL
};

/// About `hairs` at detail 1, around a core.
pub fn ball(layout: &mut Layout, frame: &Frame, hairs: f32, radius: f32) {
    layout.add(Shape::Ball, &frame.sized(0.5), [24.0, 16.0]);
    for hair in 0..layout.many(hairs) {
        let seed = mix(layout.seed ^ mix(hair as u64));
        layout.add_plain(Shape::Hair { seed, radius }, frame, [3, 24]);
    }
}
