//! Cities: a plain of two triangles, houses with facades, and street furniture down to single leaves and
//! rivets. Sizes of triangles span seven orders of magnitude.

use super::generated_scene::{Generator, view};
use super::parts::furniture::{chair, table};
use super::parts::{Frame, Layout, Random, Shape};

/// The built-in city.
pub const CITY: Generator = Generator {
    name: "city",
    triangles: 250_000,
    about: "a city on a plain of two triangles, with houses, trees, cars and cafe tables",
    seed: 4,
    layout: |layout| town(layout, [3, 3], 6.0),
    views: &[
        view([-55.0, 60.0, -45.0], [75.0, 0.0, 70.0], 48.0),
        view([47.0, 1.8, 4.0], [44.0, 4.0, 80.0], 65.0),
        view([91.0, 9.0, 30.0], [84.0, 5.0, 100.0], 60.0),
    ],
};

/// The stand-in for Vienna.
pub const VIENNA: Generator = Generator {
    name: "vienna-like",
    triangles: 8_637_000,
    about: "a city of perimeter blocks on a plain of two triangles, with ornate facades, trees and cars",
    seed: 18,
    layout: |layout| town(layout, [13, 13], 7.0),
    views: &[
        view([-90.0, 110.0, -70.0], [230.0, 0.0, 240.0], 50.0),
        view([272.0, 1.8, 180.0], [269.0, 4.0, 260.0], 65.0),
        view([316.0, 12.0, 299.0], [308.0, 6.0, 380.0], 60.0),
    ],
};

/// Distance of streets' middles and width of a street with its pavements.
const BLOCK: f32 = 45.0;
const STREET: f32 = 14.0;

/// `blocks` of perimeter houses towards +x and +z; `trees` per block at detail 1.
pub fn town(layout: &mut Layout, blocks: [usize; 2], trees: f32) {
    let size = [blocks[0] as f32 * BLOCK, blocks[1] as f32 * BLOCK];
    let plain = Frame::at(0.5 * size[0], 0.0, 0.5 * size[1]).sized(40.0 * size[0].max(size[1]));
    layout.add_plain(Shape::Sheet, &plain, [1, 1]);
    for bz in 0..blocks[1] {
        for bx in 0..blocks[0] {
            let mut random = layout.random((bx + 4096 * bz) as u64);
            let middle = Frame::at((bx as f32 + 0.5) * BLOCK, 0.0, (bz as f32 + 0.5) * BLOCK);
            let side = BLOCK - STREET;
            layout.block(&middle, [0.0; 3], [side + 6.0, 0.15, side + 6.0], 1.0);
            let ground = middle.moved(0.0, 0.15, 0.0);
            if random.chance(0.12) {
                square(layout, &ground, &mut random)
            } else {
                block(layout, &ground, &mut random)
            }
            street(layout, &middle, trees, &mut random);
        }
    }
}

/// Houses along the four sides around a yard.
fn block(layout: &mut Layout, middle: &Frame, random: &mut Random) {
    let (side, depth) = (BLOCK - STREET, 10.0);
    for turn in 0..4 {
        let row = middle.turned(1, 0.25 * turn as f32);
        // Each row starts at its own corner and ends where the next begins.
        let mut x = -0.5 * side;
        let end = 0.5 * side - depth;
        while end - x > 1.0 {
            let width = if end - x < 14.0 { end - x } else { random.between(6.0, 11.0) };
            let house_frame = row.moved(x + 0.5 * width, 0.0, 0.5 * (side - depth));
            house(layout, &house_frame, [width, random.between(9.0, 21.0), depth], random);
            x += width;
        }
    }
}

/// A house of the given size around the frame's origin, its facade towards +z.
pub fn house(layout: &mut Layout, frame: &Frame, [width, height, depth]: [f32; 3], random: &mut Random) {
    layout.block(frame, [0.0; 3], [width, height, depth], 1.0);
    let roof = random.between(2.0, 4.5);
    let hipped = frame.moved(0.0, height, 0.0).scaled(width * 1.03, roof, depth * 1.06);
    let corner = std::f32::consts::SQRT_2;
    let hipped = hipped.scaled(corner, 1.0, corner).with(&Frame::WORLD.turned(1, 0.125));
    layout.add_plain(Shape::Tube { top: random.between(0.1, 0.6), closed: true }, &hipped, [4, 1]);
    let chimney = [random.between(-0.3, 0.3) * width, height, random.between(-0.2, 0.2) * depth];
    layout.block(frame, chimney, [0.8, roof + 1.0, 0.6], 1.0);

    let front = frame.moved(0.0, 0.0, 0.5 * depth);
    layout.block(&front, [0.0, height - 0.5, 0.15], [width, 0.35, 0.5], 1.0);
    let storeys = ((height - 0.8) / 3.3) as usize;
    let columns = ((width / 2.2) as usize).max(1);
    let ornate = random.chance(0.2);
    for storey in 0..storeys {
        let y = 0.9 + 3.3 * storey as f32;
        layout.block(&front, [0.0, y + 2.25, 0.04], [width, 0.12, 0.2], 1.0);
        for column in 0..columns {
            let x = ((column as f32 + 0.5) / columns as f32 - 0.5) * width;
            if storey == 0 && column == columns / 2 {
                door(layout, &front.moved(x, 0.0, 0.0));
            } else {
                window(layout, &front.moved(x, y, 0.0), ornate);
            }
        }
    }
}

/// A window frame with its sill, and a gable or a balcony where the house is ornate.
fn window(layout: &mut Layout, at: &Frame, ornate: bool) {
    layout.block(at, [0.0, -0.08, 0.12], [1.4, 0.07, 0.3], 0.5);
    if !ornate {
        layout.block(at, [0.0, 0.0, 0.0], [1.15, 1.7, 0.08], 0.5);
        return;
    }
    for side in [-0.55, 0.0, 0.55] {
        layout.block(at, [side, 0.0, 0.03], [0.08, 1.7, 0.1], 0.5);
    }
    for y in [0.0, 1.1, 1.7] {
        layout.block(at, [0.0, y, 0.03], [1.15, 0.07, 0.1], 0.5);
    }
    let gable = at.moved(0.0, 1.8, 0.1).scaled(1.3, 0.7, 0.25);
    layout.add(Shape::Arch { thickness: 0.12 }, &gable, [8.0, 1.0]);
    for i in 0..7 {
        let x = (i as f32 / 6.0 - 0.5) * 1.3;
        layout.rod(at, [x, 0.0, 0.22], [x, 0.5, 0.22], 0.03, [4.0, 1.0]);
    }
    layout.rod(at, [-0.65, 0.5, 0.22], [0.65, 0.5, 0.22], 0.05, [6.0, 1.0]);
}

fn door(layout: &mut Layout, at: &Frame) {
    layout.block(at, [0.0, 0.0, 0.02], [1.2, 2.4, 0.08], 1.0);
    for side in [-0.75, 0.75] {
        layout.rod(at, [side, 0.0, 0.2], [side, 2.5, 0.2], 0.22, [12.0, 2.0]);
    }
    let arch = at.moved(0.0, 2.5, 0.15).scaled(1.8, 1.2, 0.4);
    layout.add(Shape::Arch { thickness: 0.15 }, &arch, [12.0, 1.0]);
    layout.add(Shape::Ball, &at.moved(0.4, 1.1, 0.1).sized(0.08), [8.0, 6.0]);
}

/// A square with a fountain and a cafe.
fn square(layout: &mut Layout, middle: &Frame, random: &mut Random) {
    const BASIN: [[f32; 2]; 9] = [
        [0.5, 0.0],
        [0.5, 0.12],
        [0.46, 0.12],
        [0.45, 0.05],
        [0.08, 0.05],
        [0.06, 0.3],
        [0.2, 0.38],
        [0.03, 0.40],
        [0.001, 0.6],
    ];
    layout.add(Shape::Turned { profile: &BASIN }, &middle.sized(7.0), [32.0, 2.0]);
    for i in 0..10 {
        let place = middle.turned(1, i as f32 / 10.0).moved(random.between(7.0, 10.0), 0.0, 0.0);
        table(layout, &place.scaled(1.0, 1.0, 1.0), 0.8, 0.8);
        for turn in 0..3 {
            let seat = place.turned(1, turn as f32 / 3.0).moved(0.0, 0.0, 0.75).turned(1, 0.5);
            chair(layout, &seat);
        }
        let shade = place.moved(0.0, 2.0, 0.0).scaled(2.4, 0.5, 2.4);
        layout.add(Shape::Tube { top: 0.02, closed: false }, &shade, [12.0, 2.0]);
        layout.rod(&place, [0.0, 0.0, 0.0], [0.0, 2.5, 0.0], 0.05, [6.0, 1.0]);
    }
}

/// Trees, lamps and cars around a block.
fn street(layout: &mut Layout, middle: &Frame, trees: f32, random: &mut Random) {
    let edge = 0.5 * (BLOCK - STREET) + 2.0;
    for i in 0..layout.many(trees) {
        let place = middle.turned(1, 0.25 * (i % 4) as f32).moved(random.between(-edge, edge), 0.15, edge);
        tree(layout, &place, random.between(4.0, 7.0), random);
    }
    for turn in 0..4 {
        let row = middle.turned(1, 0.25 * turn as f32);
        street_lamp(layout, &row.moved(edge + 0.7, 0.15, edge + 0.5));
        street_lamp(layout, &row.moved(0.0, 0.15, edge + 0.5));
        for _ in 0..2 {
            if random.chance(0.7) {
                let car_frame = row.moved(random.between(-edge + 3.0, edge - 3.0), 0.0, edge + 2.1);
                car(layout, &car_frame);
            }
        }
    }
}

/// A trunk with boughs and a crown of single leaves.
pub fn tree(layout: &mut Layout, foot: &Frame, height: f32, random: &mut Random) {
    let trunk = foot.scaled(0.05 * height, 0.6 * height, 0.05 * height);
    layout.add(Shape::Tube { top: 0.6, closed: false }, &trunk, [10.0, 4.0]);
    for _ in 0..5 {
        let tip = random.in_ball() * (0.22 * height);
        let tip = [tip.x, 0.72 * height + tip.y, tip.z];
        layout.rod(foot, [0.0, random.between(0.35, 0.6) * height, 0.0], tip, 0.018 * height, [6.0, 3.0]);
    }
    for _ in 0..3 {
        let at = random.in_ball() * (0.12 * height);
        let crown = foot.moved(at.x, 0.72 * height + at.y, at.z);
        let crown = crown.scaled(0.27 * height, 0.24 * height, 0.27 * height);
        let leaves = layout.many(150.0) as u32;
        layout.add_plain(Shape::Leaves { seed: random.bits(), length: 0.16 }, &crown, [leaves, 2]);
    }
}

fn street_lamp(layout: &mut Layout, foot: &Frame) {
    layout.rod(foot, [0.0, 0.0, 0.0], [0.0, 4.2, 0.0], 0.1, [8.0, 3.0]);
    layout.add(Shape::Ball, &foot.moved(0.0, 4.4, 0.0).sized(0.45), [14.0, 10.0]);
    layout.add(Shape::Tube { top: 0.5, closed: false }, &foot.scaled(0.3, 0.8, 0.3), [8.0, 2.0]);
}

/// A car, forward along x.
pub fn car(layout: &mut Layout, frame: &Frame) {
    let body = frame.moved(0.0, 0.55, 0.0);
    layout.add(Shape::Ball, &body.scaled(4.2, 0.8, 1.7), [24.0, 12.0]);
    layout.add(Shape::Ball, &body.moved(-0.2, 0.35, 0.0).scaled(2.4, 1.1, 1.5), [20.0, 12.0]);
    for (x, z) in [(-1.3, -0.75), (1.3, -0.75), (-1.3, 0.75), (1.3, 0.75)] {
        let wheel = frame.moved(x, 0.33, z).turned(0, 0.25);
        layout.add(Shape::Ring { thickness: 0.25 }, &wheel.sized(0.55), [20.0, 8.0]);
        layout.add(Shape::Tube { top: 1.0, closed: true }, &wheel.scaled(0.4, 0.08, 0.4), [12.0, 1.0]);
    }
}
