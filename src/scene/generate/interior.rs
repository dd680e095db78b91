//! Interiors: rooms along both sides, doors between them, windows outside, furniture within. Walls and floors
//! are parallel to the axes and of few large triangles, what stands in the rooms of many small ones.

use super::generated_scene::{Generator, view};
use super::parts::furniture::{bed, chair, desk, lamp, plant, shelf, sofa, table, vase};
use super::parts::{Frame, Layout, Random, Shape};

/// The built-in flat.
pub const ROOMS: Generator = Generator {
    name: "rooms",
    triangles: 200_000,
    about: "six furnished rooms seen from inside: large walls, small things",
    seed: 1,
    layout: |layout| {
        let rooms = [Kind::Living, Kind::Office, Kind::Dining, Kind::Sleeping, Kind::Office, Kind::Living];
        storey(layout, &Frame::WORLD, [3, 2], |i, _| rooms[i]);
    },
    views: &[
        view([0.4, 1.6, 3.6], [3.6, 0.7, 0.7], 70.0),
        view([9.5, 1.7, 3.6], [6.0, 0.7, 0.5], 70.0),
        view([14.6, 1.9, 0.4], [10.8, 0.6, 3.0], 70.0),
    ],
};

/// The stand-in for Soda Hall.
pub const OFFICES: Generator = Generator {
    name: "sodahall-like",
    triangles: 2_169_000,
    about: "an office building of five storeys, seen from inside",
    seed: 13,
    layout: |layout| {
        layout.add_plain(Shape::Sheet, &Frame::at(0.0, -0.2, 0.0).sized(300.0), [1, 1]);
        for floor in 0..5 {
            storey(layout, &Frame::at(0.0, 3.1 * floor as f32, 0.0), [10, 4], |_, random| {
                match random.below(8) {
                    0..4 => Kind::Office,
                    4 => Kind::Dining,
                    5 => Kind::Living,
                    _ => Kind::Bare,
                }
            });
        }
    },
    views: &[
        view([-16.0, 9.0, -24.0], [25.0, 7.0, 8.0], 55.0),
        view([0.5, 7.9, 2.0], [40.0, 7.2, 2.2], 65.0),
        view([27.5, 4.8, 15.4], [27.5, 4.0, 0.0], 65.0),
    ],
};

/// Width (x), height (y) and depth (z) of a room, and the walls' thickness.
pub const ROOM: [f32; 3] = [5.0, 2.8, 4.0];
const WALL: f32 = 0.12;

/// What a room is for.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Living,
    Dining,
    Sleeping,
    Office,
    Bare,
}

/// `rooms[0]` by `rooms[1]` rooms from the frame's origin towards +x and +z, with floor and ceiling.
pub fn storey(
    layout: &mut Layout,
    frame: &Frame,
    rooms: [usize; 2],
    kind: impl Fn(usize, &mut Random) -> Kind,
) {
    let [width, height, depth] = ROOM;
    let (across, along) = (rooms[0] as f32 * width, rooms[1] as f32 * depth);
    let slab = [across + WALL, 0.15, along + WALL];
    layout.block(frame, [0.5 * across, -0.15, 0.5 * along], slab, 2.0);
    layout.block(frame, [0.5 * across, height, 0.5 * along], slab, 2.0);

    for ix in 0..=rooms[0] {
        for iz in 0..rooms[1] {
            // A wall along z: its own x axis runs that way.
            let wall = frame.moved(ix as f32 * width, 0.0, (iz as f32 + 0.5) * depth).turned(1, 0.25);
            let outside = ix == 0 || ix == rooms[0];
            if outside { window_wall(layout, &wall, depth) } else { door_wall(layout, &wall, depth) }
        }
    }
    for iz in 0..=rooms[1] {
        for ix in 0..rooms[0] {
            let wall = frame.moved((ix as f32 + 0.5) * width, 0.0, iz as f32 * depth);
            let outside = iz == 0 || iz == rooms[1];
            if outside { window_wall(layout, &wall, width) } else { door_wall(layout, &wall, width) }
        }
    }
    for iz in 0..rooms[1] {
        for ix in 0..rooms[0] {
            let i = iz * rooms[0] + ix;
            let center = frame.moved((ix as f32 + 0.5) * width, 0.0, (iz as f32 + 0.5) * depth);
            let mut random = layout.random_at(&center);
            let kind = kind(i, &mut random);
            furnish(layout, &center, kind, &mut random);
        }
    }
}

/// A wall with a doorway in the middle, along the frame's x axis around its origin.
fn door_wall(layout: &mut Layout, frame: &Frame, length: f32) {
    let (height, door, top) = (ROOM[1], 0.95, 2.1);
    let side = 0.5 * (length - door);
    for sign in [-1.0, 1.0] {
        layout.block(frame, [sign * 0.5 * (length - side), 0.0, 0.0], [side, height, WALL], 3.0);
        layout.block(frame, [sign * 0.5 * (door + 0.06), 0.0, 0.0], [0.08, top, WALL + 0.04], 1.0);
    }
    layout.block(frame, [0.0, top, 0.0], [door, height - top, WALL], 1.0);
    layout.block(frame, [0.0, top - 0.06, 0.0], [door + 0.1, 0.08, WALL + 0.04], 1.0);
}

/// A wall with a window in the middle.
fn window_wall(layout: &mut Layout, frame: &Frame, length: f32) {
    let (height, sill, top, window) = (ROOM[1], 0.9, 2.2, 2.2);
    let side = 0.5 * (length - window);
    for sign in [-1.0, 1.0] {
        layout.block(frame, [sign * 0.5 * (length - side), 0.0, 0.0], [side, height, WALL], 2.0);
    }
    layout.block(frame, [0.0, 0.0, 0.0], [window, sill, WALL], 2.0);
    layout.block(frame, [0.0, top, 0.0], [window, height - top, WALL], 2.0);
    layout.block(frame, [0.0, sill, 0.0], [window, 0.03, WALL + 0.12], 2.0);
    for bar in 0..4 {
        let x = (bar as f32 / 3.0 - 0.5) * (window - 0.05);
        layout.block(frame, [x, sill, 0.0], [0.05, top - sill, 0.05], 1.0);
    }
    layout.block(frame, [0.0, 0.62 * top + 0.38 * sill, 0.0], [window, 0.04, 0.05], 1.0);
}

fn furnish(layout: &mut Layout, room: &Frame, kind: Kind, random: &mut Random) {
    let [width, height, depth] = ROOM;
    let skirting = |layout: &mut Layout, z: f32| {
        for sign in [-1.0, 1.0] {
            layout.block(room, [sign * 0.25 * (width + 1.0), 0.0, z], [0.5 * (width - 1.2), 0.08, 0.02], 1.0);
        }
    };
    skirting(layout, 0.5 * (depth - WALL));
    skirting(layout, -0.5 * (depth - WALL));
    let ceiling_lamp = room.moved(0.0, height - 0.5, 0.0);
    layout.rod(&ceiling_lamp, [0.0, 0.2, 0.0], [0.0, 0.5, 0.0], 0.015, [5.0, 2.0]);
    match kind {
        Kind::Bare => {}
        Kind::Living => {
            sofa(layout, &room.moved(-1.2, 0.0, -1.3));
            table(layout, &room.moved(-1.2, 0.0, 0.1).scaled(1.0, 0.6, 1.0), 1.2, 0.7);
            vase(layout, &room.moved(-1.2, 0.45, 0.1), 0.25);
            shelf(layout, &room.moved(1.5, 0.0, 1.7).turned(1, 0.5), 1.6, random);
            plant(layout, &room.moved(2.0, 0.0, -1.5), 1.5, random);
            lamp(layout, &room.moved(0.3, 0.0, -1.5), 1.6);
            let rug = room.moved(-0.6, 0.012, 0.2).scaled(2.6, 0.008, 1.9);
            layout.add(Shape::Hills { seed: 11, bumps: 40.0 }, &rug, [70.0, 50.0]);
        }
        Kind::Dining => {
            table(layout, room, 2.2, 1.0);
            for (x, z, turns) in [
                (-0.7, 0.75, 0.5),
                (0.0, 0.75, 0.5),
                (0.7, 0.75, 0.5),
                (-0.7, -0.75, 0.0),
                (0.0, -0.75, 0.0),
                (0.7, -0.75, 0.0),
            ] {
                chair(layout, &room.moved(x, 0.0, z).turned(1, turns + random.between(-0.03, 0.03)));
                let plate = room.moved(x, 0.74, z * 0.45).scaled(0.26, 0.03, 0.26);
                layout.add(Shape::Tube { top: 1.3, closed: true }, &plate, [24.0, 2.0]);
            }
            plant(layout, &room.moved(0.0, 0.74, 0.0), 0.5, random);
            shelf(layout, &room.moved(-1.6, 0.0, -1.75), 1.4, random);
        }
        Kind::Sleeping => {
            bed(layout, &room.moved(-1.2, 0.0, -0.7), random.bits());
            shelf(layout, &room.moved(1.6, 0.0, 1.7).turned(1, 0.5), 1.4, random);
            lamp(layout, &room.moved(-0.1, 0.0, -1.6), 1.2);
            desk(layout, &room.moved(1.5, 0.0, -1.4), random);
        }
        Kind::Office => {
            desk(layout, &room.moved(-1.2, 0.0, -1.3), random);
            desk(layout, &room.moved(1.3, 0.0, -1.3), random);
            shelf(layout, &room.moved(-1.6, 0.0, 1.75).turned(1, 0.5), 1.4, random);
            shelf(layout, &room.moved(1.6, 0.0, 1.75).turned(1, 0.5), 1.4, random);
            plant(layout, &room.moved(2.1, 0.0, 0.4), random.between(0.7, 1.4), random);
        }
    }
    layout.add(Shape::Ball, &ceiling_lamp.sized(0.4), [32.0, 20.0]);
}
