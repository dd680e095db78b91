//! Furniture, each piece standing on the floor (y = 0) of the frame it is given. Metres.

use super::frame::Frame;
use super::layout::Layout;
use super::part::Shape;
use super::random::{Random, mix};
use glam::Vec3;

const VASE: [[f32; 2]; 8] = [
    [0.001, 0.0],
    [0.30, 0.0],
    [0.45, 0.25],
    [0.38, 0.55],
    [0.18, 0.75],
    [0.26, 1.0],
    [0.22, 0.98],
    [0.10, 0.7],
];
const SHADE: [[f32; 2]; 5] = [[0.30, 0.0], [0.26, 0.25], [0.18, 0.5], [0.10, 0.62], [0.02, 0.66]];
const LEG: [[f32; 2]; 7] =
    [[0.30, 0.0], [0.5, 0.1], [0.35, 0.2], [0.42, 0.5], [0.5, 0.72], [0.4, 0.78], [0.5, 1.0]];

impl Layout {
    /// A block with its base's centre at `at`.
    pub fn block(&mut self, frame: &Frame, at: [f32; 3], size: [f32; 3], cells: f32) {
        let frame = frame.moved(at[0], at[1], at[2]).scaled(size[0], size[1], size[2]);
        self.add(Shape::Block, &frame, [cells, cells]);
    }

    /// A closed rod between two points of `frame`.
    pub fn rod(&mut self, frame: &Frame, from: [f32; 3], to: [f32; 3], width: f32, cells: [f32; 2]) {
        let along = Frame::along(Vec3::from_array(from), Vec3::from_array(to), width);
        self.add(Shape::Tube { top: 1.0, closed: true }, &frame.with(&along), cells);
    }
}

pub fn chair(layout: &mut Layout, frame: &Frame) {
    layout.block(frame, [0.0, 0.44, 0.0], [0.44, 0.04, 0.44], 2.0);
    let cushion = frame.moved(0.0, 0.485, 0.0).scaled(0.42, 0.07, 0.42);
    layout.add(Shape::Ball, &cushion, [12.0, 6.0]);
    for (x, z) in [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)] {
        let leg = frame.moved(x, 0.0, z).scaled(0.045, 0.44, 0.045);
        layout.add(Shape::Turned { profile: &LEG }, &leg, [6.0, 0.6]);
    }
    for i in 0..5 {
        let x = -0.18 + 0.09 * i as f32;
        layout.rod(frame, [x, 0.48, -0.2], [x * 1.1, 0.92, -0.26], 0.02, [6.0, 1.5]);
    }
    layout.block(frame, [0.0, 0.90, -0.26], [0.46, 0.09, 0.03], 2.0);
}

pub fn table(layout: &mut Layout, frame: &Frame, width: f32, depth: f32) {
    layout.block(frame, [0.0, 0.70, 0.0], [width, 0.04, depth], 3.0);
    layout.block(frame, [0.0, 0.62, 0.0], [width - 0.16, 0.08, depth - 0.16], 2.0);
    for (x, z) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
        let leg = frame.moved(x * (width - 0.12), 0.0, z * (depth - 0.12)).scaled(0.07, 0.7, 0.07);
        layout.add(Shape::Turned { profile: &LEG }, &leg, [8.0, 1.0]);
    }
}

/// A table with screen, keyboard, lamp and cup, and its chair.
pub fn desk(layout: &mut Layout, frame: &Frame, random: &mut Random) {
    table(layout, frame, 1.5, 0.75);
    chair(
        layout,
        &frame.moved(random.between(-0.2, 0.2), 0.0, 0.55).turned(1, 0.5 + random.between(-0.06, 0.06)),
    );
    let top = frame.moved(random.between(-0.2, 0.2), 0.74, -0.1);
    layout.block(&top, [0.0, 0.12, -0.1], [0.55, 0.33, 0.03], 2.0);
    layout.block(&top, [0.0, 0.0, -0.1], [0.22, 0.015, 0.16], 1.0);
    layout.rod(&top, [0.0, 0.0, -0.12], [0.0, 0.2, -0.12], 0.03, [6.0, 1.0]);
    layout.block(&top, [0.0, 0.0, 0.2], [0.46, 0.015, 0.15], 1.0);
    for key in 0..48 {
        let (x, z) = ((key % 12) as f32 * 0.036 - 0.2, (key / 12) as f32 * 0.034 + 0.145);
        layout.block(&top, [x, 0.015, z], [0.03, 0.008, 0.028], 0.4);
    }
    lamp(layout, &frame.moved(-0.6, 0.74, -0.2), 0.45);
    vase(layout, &frame.moved(0.55, 0.74, 0.1), 0.10);
}

/// A stand with a shade, `height` high.
pub fn lamp(layout: &mut Layout, frame: &Frame, height: f32) {
    let frame = frame.sized(height);
    layout.add(Shape::Tube { top: 0.7, closed: true }, &frame.scaled(0.4, 0.04, 0.4), [14.0, 1.0]);
    layout.rod(&frame, [0.0, 0.0, 0.0], [0.0, 0.8, 0.0], 0.04, [6.0, 3.0]);
    layout.add(Shape::Turned { profile: &SHADE }, &frame.moved(0.0, 0.62, 0.0), [18.0, 1.5]);
    layout.add(Shape::Ball, &frame.moved(0.0, 0.78, 0.0).sized(0.12), [10.0, 6.0]);
}

/// A vase or cup, `height` high.
pub fn vase(layout: &mut Layout, frame: &Frame, height: f32) {
    layout.add(Shape::Turned { profile: &VASE }, &frame.sized(height), [16.0, 1.5]);
}

/// A pot with a leafy plant, `height` high.
pub fn plant(layout: &mut Layout, frame: &Frame, height: f32, random: &mut Random) {
    vase(layout, frame, height * 0.3);
    let crown = frame.moved(0.0, height * 0.62, 0.0).scaled(height * 0.3, height * 0.4, height * 0.3);
    let leaves = layout.many(90.0) as u32;
    layout.add_plain(Shape::Leaves { seed: mix(random.bits()), length: 0.5 }, &crown, [leaves, 3]);
    layout.rod(frame, [0.0, height * 0.2, 0.0], [0.0, height * 0.7, 0.0], height * 0.02, [5.0, 3.0]);
}

/// Shelves full of books, `width` wide, 2 m high, against the wall behind it.
pub fn shelf(layout: &mut Layout, frame: &Frame, width: f32, random: &mut Random) {
    layout.block(frame, [0.0, 0.0, -0.14], [width, 2.0, 0.02], 2.0);
    for side in [-0.5, 0.5] {
        layout.block(frame, [side * width, 0.0, 0.0], [0.03, 2.0, 0.3], 1.0);
    }
    for level in 0..6 {
        let y = 0.05 + level as f32 * 0.38;
        layout.block(frame, [0.0, y - 0.03, 0.0], [width, 0.03, 0.3], 1.5);
        if level == 5 {
            break;
        }
        let mut x = -0.5 * width + 0.03;
        while x < 0.5 * width - 0.1 {
            if random.chance(0.06) {
                vase(layout, &frame.moved(x + 0.08, y, 0.0), 0.2);
                x += 0.18;
                continue;
            }
            let (thickness, height) = (random.between(0.015, 0.05), random.between(0.18, 0.31));
            let lean = if random.chance(0.1) { 0.02 } else { 0.0 };
            let book = frame.moved(x + 0.5 * thickness, y, random.between(0.0, 0.04)).turned(2, lean);
            layout.block(&book, [0.0; 3], [thickness, height, 0.2], 0.7);
            x += thickness + 0.003;
        }
    }
}

/// A sofa for three.
pub fn sofa(layout: &mut Layout, frame: &Frame) {
    layout.block(frame, [0.0, 0.12, 0.0], [2.0, 0.22, 0.85], 4.0);
    layout.block(frame, [0.0, 0.12, -0.42], [2.0, 0.7, 0.18], 4.0);
    for side in [-1.0, 1.0] {
        layout.block(frame, [side, 0.12, 0.0], [0.2, 0.5, 0.9], 3.0);
    }
    for seat in [-0.6, 0.0, 0.6] {
        let cushion = frame.moved(seat, 0.38, 0.05);
        layout.add(Shape::Ball, &cushion.scaled(0.68, 0.24, 0.8), [24.0, 12.0]);
        let back = cushion.moved(0.0, 0.26, -0.3).turned(0, -0.03);
        layout.add(Shape::Ball, &back.scaled(0.62, 0.52, 0.24), [24.0, 12.0]);
    }
    for (x, z) in [(-0.9, -0.35), (0.9, -0.35), (-0.9, 0.35), (0.9, 0.35)] {
        layout.rod(frame, [x, 0.0, z], [x, 0.13, z], 0.06, [8.0, 1.0]);
    }
}

/// A bed along z with blanket and pillows.
pub fn bed(layout: &mut Layout, frame: &Frame, seed: u64) {
    layout.block(frame, [0.0, 0.1, 0.0], [1.6, 0.25, 2.1], 3.0);
    layout.block(frame, [0.0, 0.0, -1.05], [1.7, 1.0, 0.06], 3.0);
    let blanket = frame.moved(0.0, 0.46, 0.25).scaled(1.7, 0.03, 1.6);
    layout.add(Shape::Hills { seed, bumps: 6.0 }, &blanket, [40.0, 40.0]);
    layout.block(frame, [0.0, 0.33, 0.0], [1.55, 0.08, 2.0], 2.0);
    for side in [-0.4, 0.4] {
        let pillow = frame.moved(side, 0.5, -0.75).scaled(0.6, 0.18, 0.4);
        layout.add(Shape::Ball, &pillow, [20.0, 12.0]);
    }
}
