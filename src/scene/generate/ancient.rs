//! An ancient town: low houses around atria under barrel tiles, colonnades and temples, an arena, rubble.

use super::city::tree;
use super::generated_scene::{Generator, view};
use super::parts::{Frame, Layout, Random, Shape, sin_cos};

/// The stand-in for Pompeii.
pub const ANCIENT: Generator = Generator {
    name: "pompeii-like",
    triangles: 5_632_000,
    about: "an ancient town: tiled houses around atria, temples, an arena, paved streets",
    seed: 16,
    layout,
    views: &[
        view([-40.0, 70.0, -40.0], [130.0, 0.0, 120.0], 50.0),
        view([100.0, 1.8, 3.0], [99.6, 3.0, 60.0], 65.0),
        view([112.0, 9.0, 93.0], [146.0, 4.0, 130.0], 60.0),
    ],
};

/// Distance of streets, half the width of one.
const INSULA: f32 = 33.0;
const TOWN: usize = 8;

fn layout(layout: &mut Layout) {
    let size = INSULA * TOWN as f32;
    let ground = Frame::at(0.5 * size, -3.2, 0.5 * size).scaled(6.0 * size, 3.0, 6.0 * size);
    layout.add(Shape::Hills { seed: layout.seed, bumps: 25.0 }, &ground, [220.0, 220.0]);
    layout.block(&Frame::at(0.5 * size, -6.0, 0.5 * size), [0.0; 3], [size + 20.0, 6.0, size + 20.0], 3.0);
    for i in 0..TOWN * TOWN {
        let (x, z) = (i % TOWN, i / TOWN);
        let mut random = layout.random(i as u64);
        let middle = Frame::at((x as f32 + 0.5) * INSULA, 0.0, (z as f32 + 0.5) * INSULA);
        match (x, z) {
            (4, 3) | (2, 6) => temple(layout, &middle.turned(1, 0.25 * random.below(4) as f32)),
            (6, 1) => arena(layout, &middle),
            _ => insula(layout, &middle, &mut random),
        }
        paving(layout, &middle, &mut random);
    }
}

/// Four houses between the streets.
fn insula(layout: &mut Layout, middle: &Frame, random: &mut Random) {
    layout.block(middle, [0.0; 3], [29.0, 0.25, 29.0], 1.0);
    for corner in 0..4 {
        let house_frame = middle.turned(1, 0.25 * corner as f32).moved(7.2, 0.25, 7.2);
        house(layout, &house_frame, random);
        if random.chance(0.3) {
            let tall = random.between(4.0, 6.0);
            tree(layout, &house_frame.moved(0.0, 0.0, 0.0), tall, random);
        }
    }
}

/// Rooms on four sides of an atrium with columns; some have lost their roofs.
fn house(layout: &mut Layout, middle: &Frame, random: &mut Random) {
    let (half, depth) = (6.8, 4.0);
    for side in 0..4 {
        let wing = middle.turned(1, 0.25 * side as f32).moved(0.0, 0.0, half - 0.5 * depth);
        let height = random.between(3.0, 4.2);
        for z in [-0.5, 0.5] {
            let wall = wing.moved(0.0, 0.0, z * depth);
            for x in [-5.0, 0.0, 5.0] {
                layout.block(&wall, [x, 0.0, 0.0], [3.4, height, 0.4], 1.5);
            }
            for x in [-2.5, 2.5] {
                layout.block(&wall, [x, 2.2, 0.0], [1.6, height - 2.2, 0.4], 1.0);
            }
        }
        for x in [-2.2, 2.2] {
            layout.block(&wing, [x, 0.0, 0.0], [0.3, height, depth], 1.0);
        }
        if random.chance(0.75) {
            tiles(layout, &wing.moved(0.0, height, 0.0), 2.0 * half - depth, depth + 0.8);
        } else {
            rubble(layout, &wing, random);
        }
        for i in 0..3 {
            column(layout, &wing.moved((i as f32 - 1.0) * 1.6, 0.0, -0.5 * depth - 0.5), 2.8, 0.35);
        }
    }
}

/// Two slopes of barrel tiles over the x axis.
fn tiles(layout: &mut Layout, eaves: &Frame, length: f32, depth: f32) {
    let count = (length / 0.35) as usize;
    for side in [0.0, 0.5] {
        let slope = eaves.turned(1, side).moved(0.0, 0.0, 0.5 * depth).turned(0, 0.06);
        for i in 0..count {
            let x = (i as f32 + 0.5 - 0.5 * count as f32) * 0.35;
            for row in 0..4 {
                let tile = slope.moved(x, 0.02 * (row % 2) as f32, -0.15 * depth * (row as f32 + 0.5));
                layout.add(Shape::Arch { thickness: 0.1 }, &tile.scaled(0.36, 0.3, 0.16 * depth), [4.0, 0.7]);
            }
        }
        layout.block(&slope, [0.0, -0.08, -0.29 * depth], [length, 0.06, 0.6 * depth], 1.0);
    }
}

fn column(layout: &mut Layout, foot: &Frame, height: f32, width: f32) {
    const COLUMN: [[f32; 2]; 9] = [
        [0.62, 0.0],
        [0.62, 0.03],
        [0.52, 0.05],
        [0.50, 0.07],
        [0.48, 0.4],
        [0.42, 0.9],
        [0.50, 0.94],
        [0.62, 0.96],
        [0.62, 1.0],
    ];
    layout.add(Shape::Turned { profile: &COLUMN }, &foot.scaled(width, height, width), [14.0, 1.0]);
}

/// Steps, a hall within a colonnade, a gable.
fn temple(layout: &mut Layout, middle: &Frame) {
    for step in 0..5 {
        let (y, grow) = (0.4 * step as f32, 1.0 - 0.04 * step as f32);
        layout.block(middle, [0.0, y, 0.0], [16.0 * grow, 0.4, 26.0 * grow], 2.0);
    }
    let floor = middle.moved(0.0, 2.0, 0.0);
    for i in 0..6 {
        for z in [-1.0, 1.0] {
            column(layout, &floor.moved((i as f32 - 2.5) * 2.4, 0.0, 10.2 * z), 7.0, 1.0);
        }
    }
    for i in 1..8 {
        for x in [-1.0, 1.0] {
            column(layout, &floor.moved(6.0 * x, 0.0, (i as f32 / 8.0 - 0.5) * 20.4), 7.0, 1.0);
        }
    }
    layout.block(&floor, [0.0, 0.0, 0.0], [8.0, 7.0, 14.0], 3.0);
    layout.block(&floor, [0.0, 7.0, 0.0], [13.4, 1.2, 21.8], 4.0);
    for i in 0..60 {
        for side in [0.0, 0.5] {
            let slope =
                floor.moved(0.0, 8.2, 0.0).turned(1, side + 0.25).moved(0.0, 0.0, 6.9).turned(0, 0.05);
            let tile = slope.moved((i as f32 - 29.5) * 0.36, 0.0, -3.6).scaled(0.36, 0.3, 7.2);
            layout.add(Shape::Arch { thickness: 0.1 }, &tile, [6.0, 3.0]);
        }
    }
}

/// Rings of steps around an oval.
fn arena(layout: &mut Layout, middle: &Frame) {
    for tier in 0..16 {
        let (radius, height) = (6.5 + 0.6 * tier as f32, 0.5 * (tier + 1) as f32);
        let blocks = 72;
        for i in 0..blocks {
            let (sin, cos) = sin_cos(i as f32 / blocks as f32);
            let at = middle.moved(radius * sin, 0.0, 0.8 * radius * cos).turned(1, i as f32 / blocks as f32);
            let width = radius * 6.4 / blocks as f32;
            layout.block(&at, [0.0; 3], [width, height, 0.62], 1.0);
        }
    }
}

/// Polygonal paving stones along two sides of the insula.
fn paving(layout: &mut Layout, middle: &Frame, random: &mut Random) {
    for side in 0..2 {
        let row = middle.turned(1, 0.25 * side as f32).moved(0.0, -0.1, 0.5 * INSULA);
        for i in 0..120 {
            let at = row.moved((i / 4) as f32 * 1.1 - 16.0, 0.0, (i % 4) as f32 * 0.95 - 1.4);
            let stone = at.turned(1, random.unit()).scaled(1.1, random.between(0.12, 0.2), 0.95);
            layout.add_plain(Shape::Tube { top: 0.9, closed: true }, &stone, [6, 1]);
        }
    }
}

/// Broken stones.
fn rubble(layout: &mut Layout, wing: &Frame, random: &mut Random) {
    for _ in 0..60 {
        let p = random.in_ball();
        let at = wing.moved(p.x * 4.0, 0.1, p.z * 1.8).turned(1, random.unit()).turned(0, random.unit());
        let size = random.between(0.1, 0.5);
        layout.add(Shape::Ball, &at.scaled(size, 0.7 * size, 0.8 * size), [6.0, 4.0]);
    }
}
