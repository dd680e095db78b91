//! A statue wrung about its axis while it sways and swells: neighbours stay neighbours, but boxes around what is
//! wrung fit worse and worse.

use super::super::generated_scene::view;
use super::super::parts::{Frame, draw, sin_cos};
use super::super::statue::figure;
use super::animation::{Animated, Animation, append, floor};
use glam::Vec3;

/// The wrung statue.
pub const WRUNG: Animated = Animated {
    name: "wrung",
    triangles: 200_000,
    about: "a statue wrung twice about its axis while it sways",
    seed: 21,
    make,
};

/// Turns of the head by the end.
const TURNS: f32 = 2.0;

fn make(animated: &Animated, triangles: usize) -> Animation {
    let mut draft = floor(3.0);
    let fixed = draft.triangles.len();
    let statue = draw(triangles - fixed, animated.seed, &|layout| {
        figure(layout, &Frame::WORLD, layout.seed, [220.0, 7.2])
    });
    append(&mut draft, statue);
    let views = [
        view([0.65, 0.95, 2.3], [0.0, 0.42, 0.0], 38.0),
        view([-1.2, 0.62, 0.9], [0.0, 0.5, 0.0], 45.0),
        view([0.3, 1.9, 0.9], [0.0, 0.5, 0.0], 45.0),
    ];
    let still = 4;
    animated.animation(
        draft,
        fixed,
        &views,
        Box::new(move |i, rest, time| if i < still { rest } else { wrung(rest, time) }),
    )
}

fn wrung(rest: Vec3, time: f32) -> Vec3 {
    let (sin, cos) = sin_cos(TURNS * time * rest.y);
    let (wave, _) = sin_cos(2.0 * rest.y - 3.0 * time);
    let swell = 1.0 + 0.25 * time * wave;
    let (sway, _) = sin_cos(2.0 * time);
    let bend = 0.3 * sway * rest.y * rest.y;
    Vec3::new(
        swell * (cos * rest.x + sin * rest.z) + bend,
        rest.y,
        swell * (cos * rest.z - sin * rest.x) + 0.5 * bend,
    )
}
