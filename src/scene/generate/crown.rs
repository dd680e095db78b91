//! A crown on a cushion: a finely cut, curved jewel of pearls, stones and wire, everything touching.

use super::generated_scene::{Generator, view};
use super::parts::{Frame, Layout, Random, Shape, mix, sin_cos};
use glam::Vec3;

/// The stand-in for Crown.
pub const CROWN: Generator = Generator {
    name: "crown-like",
    triangles: 4_868_000,
    about: "a crown with arches of pearls, stones and filigree, on a cushion with tassels",
    seed: 15,
    layout: |layout| {
        let table = Frame::at(0.0, -1.3, 0.0).sized(30.0);
        layout.add_plain(Shape::Sheet, &table, [8, 8]);
        cushion(layout);
        crown(layout);
    },
    views: &[
        view([0.4, 2.2, 6.2], [0.0, 0.7, 0.0], 40.0),
        view([-2.6, 1.0, 2.6], [-0.3, 0.8, 0.2], 42.0),
        view([1.7, 3.2, 1.8], [0.1, 0.8, -0.1], 45.0),
    ],
};

/// Radius of the band.
const RADIUS: f32 = 1.4;

fn crown(layout: &mut Layout) {
    const BAND: [[f32; 2]; 9] = [
        [0.97, 0.0],
        [1.03, 0.02],
        [1.0, 0.08],
        [1.0, 0.36],
        [1.03, 0.42],
        [0.97, 0.44],
        [0.96, 0.36],
        [0.96, 0.08],
        [0.97, 0.0],
    ];
    let band = Frame::WORLD.scaled(RADIUS, 1.0, RADIUS);
    layout.add(Shape::Turned { profile: &BAND }, &band, [240.0, 4.0]);
    for (y, pearls) in [(0.02, 90), (0.42, 90)] {
        for i in 0..pearls {
            pearl(layout, &around(i as f32 / pearls as f32, RADIUS * 1.04, y), 0.085);
        }
    }
    for i in 0..16 {
        let turns = i as f32 / 16.0;
        jewel(layout, &around(turns, RADIUS * 1.01, 0.22), i % 2 == 0, &mut layout.random(i));
        filigree(layout, &around(turns + 1.0 / 32.0, RADIUS * 1.01, 0.22));
    }
    for i in 0..8 {
        let turns = i as f32 / 8.0;
        if i % 2 == 0 {
            cross(layout, &around(turns, RADIUS, 0.44), &mut layout.random(100 + i));
        } else {
            lily(layout, &around(turns, RADIUS, 0.44));
        }
    }
    for i in 0..4 {
        arch(layout, &Frame::WORLD.turned(1, i as f32 / 8.0 + 1.0 / 16.0));
    }
    let globe = Frame::at(0.0, 2.05, 0.0);
    layout.add(Shape::Ball, &globe.sized(0.42), [80.0, 56.0]);
    layout.add(Shape::Ring { thickness: 0.08 }, &globe.sized(0.45), [96.0, 16.0]);
    layout.add(Shape::Ring { thickness: 0.08 }, &globe.turned(0, 0.25).sized(0.45), [96.0, 16.0]);
    cross(layout, &globe.moved(0.0, 0.2, 0.0), &mut layout.random(99));

    // The velvet cap within.
    let cap = Frame::at(0.0, 0.35, 0.0).scaled(RADIUS * 1.9, 2.2, RADIUS * 1.9);
    layout.add(Shape::Ball, &cap, [260.0, 180.0]);
    for i in 0..layout.many(500.0) {
        let mut random = layout.random(5_000 + i as u64);
        let tuft = around(random.unit(), RADIUS * 1.02, random.between(-0.28, -0.05));
        let seed = mix(random.bits());
        layout.add_plain(Shape::Leaves { seed, length: 1.0 }, &tuft.sized(0.12), [24, 6]);
    }
}

/// The frame on the circle of `radius` whose z axis points outwards.
fn around(turns: f32, radius: f32, height: f32) -> Frame {
    Frame::WORLD.turned(1, turns).moved(0.0, height, radius)
}

fn pearl(layout: &mut Layout, at: &Frame, size: f32) {
    layout.add(Shape::Ball, &at.sized(size), [22.0, 14.0]);
}

/// A cut stone (few large facets) or a polished one (many), in a setting with claws and small pearls.
fn jewel(layout: &mut Layout, at: &Frame, polished: bool, random: &mut Random) {
    let (width, height) = (random.between(0.17, 0.22), random.between(0.2, 0.26));
    let stone = at.scaled(width, height, 0.14);
    if polished {
        layout.add(Shape::Ball, &stone, [44.0, 28.0]);
    } else {
        layout.add_plain(Shape::Ball, &stone.turned(0, 0.25), [8, 5]);
    }
    let facing = at.turned(0, 0.25);
    layout.add(
        Shape::Ring { thickness: 0.1 },
        &facing.scaled(width * 1.15, 0.3, height * 1.15),
        [56.0, 12.0],
    );
    for i in 0..14 {
        let (sin, cos) = sin_cos(i as f32 / 14.0);
        pearl(layout, &at.moved(sin * width * 0.72, cos * height * 0.72, 0.02), 0.035);
    }
}

/// Curled wire.
fn filigree(layout: &mut Layout, at: &Frame) {
    for (x, y, size) in
        [(0.0, 0.0, 0.12), (0.0, 0.08, 0.07), (0.0, -0.08, 0.07), (0.05, 0.04, 0.05), (-0.05, -0.04, 0.05)]
    {
        let ring = at.moved(x, y, 0.0).turned(0, 0.25).sized(size);
        layout.add(Shape::Ring { thickness: 0.14 }, &ring, [36.0, 10.0]);
    }
}

/// Four arms that widen outwards, a stone between them.
fn cross(layout: &mut Layout, foot: &Frame, random: &mut Random) {
    let center = foot.moved(0.0, 0.24, 0.0);
    for i in 0..4 {
        let arm = center.turned(2, 0.25 * i as f32).scaled(0.14, 0.22, 0.07);
        layout.add(Shape::Tube { top: 2.0, closed: true }, &arm, [40.0, 14.0]);
        let tip = center.turned(2, 0.25 * i as f32).moved(0.0, 0.24, 0.0);
        for side in [-0.09, 0.0, 0.09] {
            pearl(layout, &tip.moved(side, 0.0, 0.0), 0.06);
        }
    }
    jewel(layout, &center.moved(0.0, 0.0, 0.05).sized(0.7), random.chance(0.5), random);
}

/// Three petals and a band.
fn lily(layout: &mut Layout, foot: &Frame) {
    for (lean, height) in [(-0.12, 0.32), (0.0, 0.42), (0.12, 0.32)] {
        let petal = foot.turned(2, lean).moved(0.0, 0.5 * height, 0.0).scaled(0.16, height, 0.07);
        layout.add(Shape::Ball, &petal, [36.0, 24.0]);
    }
    let band = foot.moved(0.0, 0.12, 0.0).scaled(0.24, 0.12, 0.12);
    layout.add(Shape::Ring { thickness: 0.3 }, &band, [40.0, 14.0]);
}

/// An arch over the crown in the frame's xy plane: two wires, pearls between, stones on top.
fn arch(layout: &mut Layout, frame: &Frame) {
    let at = |t: f32| {
        let (sin, cos) = sin_cos(t * 0.5);
        // Raised at its shoulders, low in the middle.
        let height = 0.44 + 1.45 * sin.max(0.0).sqrt() - 0.12 * sin * sin * sin;
        Vec3::new(-RADIUS * cos, height, 0.0)
    };
    let steps = 72;
    for i in 0..steps {
        let (a, b) = (at(i as f32 / steps as f32), at((i + 1) as f32 / steps as f32));
        for z in [-0.07, 0.07] {
            let side = Vec3::Z * z;
            layout.rod(frame, (a + side).to_array(), (b + side).to_array(), 0.035, [14.0, 2.0]);
        }
        let middle = 0.5 * (a + b);
        pearl(layout, &frame.moved(middle.x, middle.y + 0.02, 0.0), 0.075);
    }
}

/// A puffed square with piping and a tassel at each corner.
fn cushion(layout: &mut Layout) {
    let seed = layout.seed;
    for (flip, height) in [(0.0, 0.012), (0.5, 0.012)] {
        let cover = Frame::at(0.0, -0.85, 0.0).turned(2, flip).moved(0.0, 0.16, 0.0);
        layout.add(Shape::Hills { seed, bumps: 6.0 }, &cover.scaled(4.3, height * 2.0, 4.3), [300.0, 300.0]);
    }
    layout.add(Shape::Ball, &Frame::at(0.0, -0.78, 0.0).scaled(5.4, 0.85, 5.4), [200.0, 90.0]);
    for corner in 0..4 {
        let row = Frame::at(0.0, -0.85, 0.0).turned(1, 0.25 * corner as f32);
        layout.rod(&row, [-2.15, 0.0, 2.15], [2.15, 0.0, 2.15], 0.3, [48.0, 60.0]);
        for i in 0..60 {
            let x = -2.1 + 0.07 * i as f32;
            let ring = row.moved(x, 0.0, 2.15).turned(2, 0.21).sized(0.36);
            layout.add(Shape::Ring { thickness: 0.12 }, &ring, [24.0, 8.0]);
        }
        let tassel = row.moved(2.3, 0.0, 2.3);
        layout.add(Shape::Ball, &tassel.sized(0.3), [40.0, 28.0]);
        for i in 0..layout.many(160.0) {
            let mut random = layout.random(10_000 + i as u64);
            let tip = [random.between(-0.1, 0.35), -0.42, random.between(-0.1, 0.35)];
            layout.rod(&tassel, [0.0, -0.1, 0.0], tip, 0.015, [4.0, 4.0]);
        }
    }
}
