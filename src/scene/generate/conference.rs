//! A conference room: one hall, a ring of tables, rows of chairs, panelled walls, a grid of lamps.

use super::generated_scene::{Generator, view};
use super::parts::furniture::{chair, plant, table, vase};
use super::parts::{Frame, Layout, Shape};

/// The stand-in for Conference.
pub const CONFERENCE: Generator = Generator {
    name: "conference-like",
    triangles: 331_000,
    about: "a conference room with a ring of tables, chairs, panelled walls and a grid of lamps",
    seed: 11,
    layout,
    views: &[
        view([-8.3, 1.7, 5.2], [3.0, 1.0, -2.0], 65.0),
        view([8.4, 2.2, 0.4], [-4.0, 0.9, 0.0], 65.0),
        view([-2.0, 1.2, -5.4], [4.0, 1.0, 4.0], 70.0),
    ],
};

/// Half the width (x), the height and half the depth (z) of the hall.
const HALL: [f32; 3] = [9.0, 3.6, 6.0];

fn layout(layout: &mut Layout) {
    let [x, height, z] = HALL;
    let hall = Frame::WORLD;
    layout.block(&hall, [0.0, -0.2, 0.0], [2.0 * x, 0.2, 2.0 * z], 4.0);
    layout.block(&hall, [0.0, height, 0.0], [2.0 * x, 0.2, 2.0 * z], 4.0);
    for (turns, reach, width) in [(0.0, z, x), (0.5, z, x), (0.25, x, z), (0.75, x, z)] {
        wall(layout, &hall.turned(1, turns).moved(0.0, 0.0, -reach), 2.0 * width);
    }
    for i in 0..8 {
        for j in 0..5 {
            let at = hall.moved((i as f32 - 3.5) * 2.1, height, (j as f32 - 2.0) * 2.2);
            lamp(layout, &at);
        }
    }
    ring_of_tables(layout);
    for row in 0..2 {
        for i in 0..14 {
            let mut random = layout.random(40 * row + i);
            let seat = hall.moved((i as f32 - 6.5) * 0.75, 0.0, 4.2 + 0.9 * row as f32);
            chair(layout, &seat.turned(1, 0.5 + random.between(-0.02, 0.02)));
        }
    }
    for (i, sign) in [(0, -1.0), (1, 1.0)] {
        let mut random = layout.random(900 + i);
        plant(layout, &hall.moved(sign * 8.3, 0.0, -5.3), 1.7, &mut random);
        layout.rod(&hall, [sign * 4.5, 0.0, -5.6], [sign * 4.5, height, -5.6], 0.5, [40.0, 3.0]);
    }
    // A screen and a lectern.
    layout.block(&hall, [0.0, 1.1, -5.8], [3.6, 2.0, 0.04], 3.0);
    layout.block(&hall, [3.0, 0.0, -4.6], [0.7, 1.1, 0.5], 3.0);
}

/// A wall of panels with skirting and cornice, its inner side towards +z.
fn wall(layout: &mut Layout, frame: &Frame, length: f32) {
    let height = HALL[1];
    layout.block(frame, [0.0, 0.0, -0.1], [length, height, 0.2], 4.0);
    layout.block(frame, [0.0, 0.0, 0.02], [length, 0.15, 0.04], 2.0);
    layout.block(frame, [0.0, height - 0.12, 0.05], [length, 0.12, 0.1], 2.0);
    let panels = (length / 1.2) as usize;
    for i in 0..panels {
        let x = ((i as f32 + 0.5) / panels as f32 - 0.5) * length;
        layout.block(frame, [x, 0.3, 0.015], [1.0, 0.9, 0.03], 1.5);
        layout.block(frame, [x, 1.35, 0.015], [1.0, 1.9, 0.03], 1.5);
        layout.rod(frame, [x - 0.5, 0.3, 0.03], [x - 0.5, 3.25, 0.03], 0.03, [6.0, 2.0]);
    }
}

/// A louvred lamp in the ceiling.
fn lamp(layout: &mut Layout, at: &Frame) {
    for side in [-0.5, 0.5] {
        layout.block(at, [side, -0.08, 0.0], [0.03, 0.08, 0.6], 1.0);
        layout.block(at, [0.0, -0.08, 0.6 * side], [1.0, 0.08, 0.03], 1.0);
    }
    for i in 0..8 {
        layout.block(at, [(i as f32 - 3.5) * 0.12, -0.07, 0.0], [0.01, 0.06, 0.57], 0.7);
    }
    for z in [-0.15, 0.15] {
        layout.rod(at, [-0.47, -0.02, z], [0.47, -0.02, z], 0.035, [10.0, 1.0]);
    }
}

/// Tables around a free middle, each with two chairs, microphones, papers and glasses.
fn ring_of_tables(layout: &mut Layout) {
    let sides = [(0.0, 2.2, 5), (0.5, 2.2, 5), (0.25, 4.6, 2), (0.75, 4.6, 2)];
    for (turns, reach, count) in sides {
        for i in 0..count {
            let x = (i as f32 - 0.5 * (count - 1) as f32) * 1.62;
            let place = Frame::WORLD.turned(1, turns).moved(x, 0.0, reach - 0.9);
            let mut random = layout.random_at(&place);
            table(layout, &place, 1.6, 0.7);
            for side in [-0.4, 0.4] {
                let seat = place.moved(side, 0.0, 0.75 + random.between(0.0, 0.15));
                chair(layout, &seat.turned(1, 0.5 + random.between(-0.05, 0.05)));
                let top = place.moved(side, 0.74, 0.0);
                let paper = top.turned(1, random.between(-0.04, 0.04));
                layout.block(&paper, [0.0, 0.0, 0.15], [0.21, 0.006, 0.29], 1.0);
                layout.rod(&top, [0.2, 0.0, -0.1], [0.2, 0.02, -0.1], 0.12, [16.0, 1.0]);
                layout.rod(&top, [0.2, 0.02, -0.1], [0.14, 0.3, 0.05], 0.012, [6.0, 4.0]);
                layout.add(Shape::Ball, &top.moved(0.14, 0.31, 0.05).sized(0.03), [12.0, 8.0]);
                vase(layout, &top.moved(-0.2, 0.0, 0.0), 0.13);
            }
        }
    }
}
