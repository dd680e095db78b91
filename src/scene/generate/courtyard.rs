//! A courtyard: arcades on two floors around it, cafe tables on its paving, trees and creepers of single
//! leaves, which are most of its triangles.

use super::city::tree;
use super::generated_scene::{Generator, view};
use super::parts::furniture::{chair, plant, table, vase};
use super::parts::{Frame, Layout, Shape};

/// The stand-in for San Miguel.
pub const COURTYARD: Generator = Generator {
    name: "sanmiguel-like",
    triangles: 7_880_000,
    about: "a courtyard with arcades, cafe tables, trees and creepers of single leaves",
    seed: 17,
    layout,
    views: &[
        view([-11.0, 1.6, -8.0], [6.0, 2.0, 6.0], 65.0),
        view([-17.6, 1.7, -4.0], [10.0, 2.4, -13.0], 65.0),
        view([8.0, 6.2, 13.0], [-4.0, 1.5, -4.0], 65.0),
    ],
};

/// Half the side of the court, width of an arch, height of a floor.
const HALF: f32 = 15.0;
const BAY: f32 = 3.0;
const FLOOR: f32 = 4.6;

fn layout(layout: &mut Layout) {
    paving(layout);
    for side in 0..4 {
        let row = Frame::WORLD.turned(1, 0.25 * side as f32).moved(0.0, 0.0, -HALF);
        for floor in 0..2 {
            arcade(layout, &row.moved(0.0, FLOOR * floor as f32, 0.0), floor);
        }
        roof(layout, &row.moved(0.0, 2.0 * FLOOR, 0.0));
        for i in 0..10 {
            let mut random = layout.random(700 + 16 * side + i);
            let x = (i as f32 - 4.5) * BAY;
            // A creeper hangs over the parapet, thin against the wall.
            let hanging = row.moved(x, FLOOR + random.between(-0.9, 0.3), 0.45);
            let hanging = hanging.scaled(1.5, random.between(0.8, 1.7), 0.3);
            let leaves = layout.many(1_100.0) as u32;
            layout.add_plain(Shape::Leaves { seed: random.bits(), length: 0.1 }, &hanging, [leaves, 3]);
            let tall = random.between(1.0, 1.7);
            plant(layout, &row.moved(x + 0.5 * BAY, 0.0, 1.1), tall, &mut random);
            plant(layout, &row.moved(x + 0.9, FLOOR + 0.9, 0.1), 0.6, &mut random);
        }
    }
    for i in 0..7 {
        let mut random = layout.random(i);
        let turned = Frame::WORLD.turned(1, i as f32 / 7.0);
        let foot = turned.moved(random.between(7.5, 9.5), 0.0, 0.0);
        big_tree(layout, &foot, random.between(8.0, 11.0), i);
    }
    for i in 0..36 {
        let mut random = layout.random(300 + i);
        let place = Frame::WORLD.moved((i % 6) as f32 * 4.2 - 10.5, 0.05, (i / 6) as f32 * 4.2 - 10.5);
        let place = place.moved(random.between(-0.5, 0.5), 0.0, random.between(-0.5, 0.5));
        if place.origin.length() > 4.2 {
            let turned = place.turned(1, random.unit());
            cafe_table(layout, &turned);
        }
    }
    fountain(layout);
}

fn paving(layout: &mut Layout) {
    layout.add_plain(Shape::Sheet, &Frame::at(0.0, -0.02, 0.0).sized(120.0), [1, 1]);
    let stones = 44;
    for i in 0..stones * stones {
        let mut random = layout.random(20_000 + i);
        let size = 2.0 * HALF / stones as f32;
        let at = |k: u64| (k as f32 + 0.5) * size - HALF;
        let height = random.between(0.03, 0.05);
        layout.block(
            &Frame::WORLD,
            [at(i % stones), 0.0, at(i / stones)],
            [size - 0.02, height, size - 0.02],
            1.0,
        );
    }
}

/// Ten arches along x that open towards +z, with the wall and the ceiling behind them.
fn arcade(layout: &mut Layout, row: &Frame, floor: usize) {
    const COLUMN: [[f32; 2]; 10] = [
        [0.5, 0.0],
        [0.5, 0.04],
        [0.42, 0.07],
        [0.36, 0.09],
        [0.34, 0.5],
        [0.30, 0.88],
        [0.36, 0.91],
        [0.46, 0.95],
        [0.5, 0.96],
        [0.5, 1.0],
    ];
    let (spring, radius) = (2.4, 0.5 * BAY - 0.15);
    for i in 0..=10 {
        let column = row.moved((i as f32 - 5.0) * BAY, 0.0, 0.0);
        layout.add(Shape::Turned { profile: &COLUMN }, &column.scaled(0.55, spring, 0.55), [28.0, 4.0]);
        layout.block(&column, [0.0, spring, 0.0], [0.34, FLOOR - spring - 0.1, 0.4], 2.0);
    }
    for i in 0..10 {
        let bay = row.moved((i as f32 - 4.5) * BAY, 0.0, 0.0);
        let arch = bay.moved(0.0, spring, 0.0);
        layout.add(
            Shape::Arch { thickness: 0.09 },
            &arch.scaled(2.0 * radius, 2.0 * radius, 0.5),
            [24.0, 2.0],
        );
        // The spandrels, in steps under the arch's curve.
        for step in 0..12 {
            let x = (step as f32 + 0.5) / 12.0 * 2.0 - 1.0;
            let y = spring + radius * (1.0 - x * x).max(0.0).sqrt();
            layout.block(&bay, [x * radius, y, 0.0], [radius / 6.0, FLOOR - 0.1 - y, 0.36], 1.0);
        }
        let behind = bay.moved(0.0, 0.0, -3.6);
        layout.block(&behind, [0.0, 0.0, 0.0], [BAY, FLOOR, 0.3], 3.0);
        layout.block(&behind, [0.0, 0.0, 0.2], [1.1, 2.5, 0.12], 3.0);
        layout.block(&behind, [0.0, 2.5, 0.22], [1.4, 0.2, 0.2], 2.0);
        for beam in 0..4 {
            let x = (beam as f32 - 1.5) * 0.75;
            layout.block(&bay, [x, FLOOR - 0.35, -1.8], [0.14, 0.2, 3.6], 2.0);
        }
        layout.block(&bay, [0.0, FLOOR - 0.15, -1.8], [BAY, 0.15, 4.2], 2.0);
        if floor > 0 {
            layout.block(&bay, [0.0, 0.9, 0.1], [BAY, 0.1, 0.3], 2.0);
            for baluster in 0..9 {
                let x = (baluster as f32 - 4.0) * 0.3;
                vase(layout, &bay.moved(x, 0.0, 0.1).scaled(0.25, 1.0, 0.25), 0.9);
            }
        }
    }
}

/// Rows of barrel tiles, sloping down towards +z.
fn roof(layout: &mut Layout, row: &Frame) {
    let slope = row.moved(0.0, 0.0, 0.6).turned(0, 0.06);
    for i in 0..100 {
        for j in 0..9 {
            let x = (i as f32 - 49.5) * 0.3;
            let tile = slope.moved(x, 0.03 * (j % 2) as f32, -0.25 - 0.5 * j as f32).scaled(0.3, 0.24, 0.55);
            layout.add(Shape::Arch { thickness: 0.07 }, &tile, [8.0, 1.0]);
        }
    }
    layout.block(&slope, [0.0, -0.1, -2.2], [30.0, 0.08, 4.5], 2.0);
}

fn big_tree(layout: &mut Layout, foot: &Frame, height: f32, stream: u64) {
    let mut random = layout.random(500 + stream);
    tree(layout, foot, height, &mut random);
    for _ in 0..16 {
        let at = random.in_ball() * (0.26 * height);
        let crown = foot.moved(at.x, 0.74 * height + 0.7 * at.y, at.z);
        let tip = [at.x, 0.74 * height + 0.7 * at.y, at.z];
        layout.rod(foot, [0.0, 0.45 * height, 0.0], tip, 0.012 * height, [8.0, 5.0]);
        let size = random.between(0.10, 0.17) * height;
        let leaves = layout.many(1_800.0) as u32;
        layout.add_plain(
            Shape::Leaves { seed: random.bits(), length: 0.09 },
            &crown.sized(size),
            [leaves, 3],
        );
    }
}

fn cafe_table(layout: &mut Layout, place: &Frame) {
    table(layout, place, 1.0, 1.0);
    for turn in 0..4 {
        let side = place.turned(1, 0.25 * turn as f32);
        chair(layout, &side.moved(0.0, 0.0, 0.8).turned(1, 0.5));
        let plate = side.moved(0.0, 0.74, 0.32).scaled(0.25, 0.02, 0.25);
        layout.add(Shape::Tube { top: 1.4, closed: true }, &plate, [32.0, 3.0]);
        vase(layout, &side.moved(0.2, 0.74, 0.2), 0.12);
    }
    vase(layout, &place.moved(0.0, 0.74, 0.0), 0.22);
}

fn fountain(layout: &mut Layout) {
    const FOUNTAIN: [[f32; 2]; 12] = [
        [0.5, 0.0],
        [0.5, 0.16],
        [0.46, 0.17],
        [0.45, 0.06],
        [0.10, 0.05],
        [0.07, 0.10],
        [0.06, 0.30],
        [0.24, 0.38],
        [0.22, 0.39],
        [0.05, 0.36],
        [0.03, 0.55],
        [0.001, 0.60],
    ];
    layout.add(Shape::Turned { profile: &FOUNTAIN }, &Frame::WORLD.sized(5.0), [96.0, 8.0]);
}
