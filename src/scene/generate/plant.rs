//! Industrial plant: racks of pipes, trusses of diagonal rods, tanks, stairs and gratings. Most triangles are
//! long and thin, many of them oblique, and boxes around them hold mostly air.

use super::generated_scene::{Generator, view};
use super::parts::{Frame, Layout, Random, Shape};
use glam::Vec3;

/// The built-in plant.
pub const PIPES: Generator = Generator {
    name: "pipes",
    triangles: 200_000,
    about: "pipes, trusses and tanks of a plant: long, thin and oblique triangles",
    seed: 5,
    layout: |layout| {
        ground(layout, [60.0, 50.0]);
        hall(layout, &Frame::WORLD, [3, 2, 2]);
    },
    views: &[
        view([-9.0, 7.0, 22.0], [12.0, 5.0, 8.0], 55.0),
        view([1.0, 1.7, 1.0], [20.0, 5.0, 10.0], 70.0),
        view([31.0, 12.0, -6.0], [10.0, 4.0, 8.0], 50.0),
    ],
};

/// The stand-in for Power Plant.
pub const POWER_PLANT: Generator = Generator {
    name: "powerplant-like",
    triangles: 12_759_000,
    about: "a power plant: ten storeys of pipes, gratings, tanks and trusses, two chimneys",
    seed: 19,
    layout: |layout| {
        ground(layout, [400.0, 400.0]);
        hall(layout, &Frame::WORLD, [10, 9, 8]);
        for x in [-20.0, -45.0] {
            let foot = Frame::at(x, 0.0, 30.0);
            layout.add(Shape::Tube { top: 0.6, closed: true }, &foot.scaled(12.0, 110.0, 12.0), [64.0, 90.0]);
            for i in 0..12 {
                let width = 12.0 - 0.38 * i as f32;
                let ring = foot.moved(0.0, 8.0 * (i + 1) as f32, 0.0).sized(width + 1.0);
                layout.add(Shape::Ring { thickness: 0.06 }, &ring, [64.0, 8.0]);
            }
        }
    },
    views: &[
        view([-85.0, 75.0, 140.0], [15.0, 30.0, 30.0], 55.0),
        view([0.6, 7.3, 0.9], [60.0, 10.0, 9.0], 70.0),
        view([43.5, 31.7, 66.0], [40.0, 25.0, 0.0], 65.0),
    ],
};

fn ground(layout: &mut Layout, size: [f32; 2]) {
    layout.add_plain(
        Shape::Sheet,
        &Frame::at(0.0, -0.02, 0.0).scaled(size[0] * 2.0, 1.0, size[1] * 2.0),
        [1, 1],
    );
}

/// Width, height and depth of a bay between columns.
const BAY: [f32; 3] = [8.0, 5.0, 8.0];

/// A steel structure of `bays` (x, y, z) with a tank, a machine or a rack of pipes in each.
pub fn hall(layout: &mut Layout, frame: &Frame, bays: [usize; 3]) {
    let [nx, ny, nz] = bays;
    for iy in 0..ny {
        for iz in 0..=nz {
            for ix in 0..=nx {
                let foot = frame.moved(ix as f32 * BAY[0], iy as f32 * BAY[1], iz as f32 * BAY[2]);
                column(layout, &foot);
                if ix < nx {
                    truss(layout, &foot.moved(0.0, BAY[1], 0.0), BAY[0]);
                }
                if iz < nz {
                    truss(layout, &foot.moved(0.0, BAY[1], 0.0).turned(1, -0.25), BAY[2]);
                }
                if ix < nx && iz < nz {
                    let mut random = layout.random_at(&foot);
                    bay(layout, &foot.moved(0.5 * BAY[0], 0.0, 0.5 * BAY[2]), iy, &mut random);
                }
            }
        }
    }
}

/// An I-shaped column with a foot plate and bolts.
fn column(layout: &mut Layout, foot: &Frame) {
    for z in [-0.14, 0.14] {
        layout.block(foot, [0.0, 0.0, z], [0.3, BAY[1], 0.03], 1.0);
    }
    layout.block(foot, [0.0, 0.0, 0.0], [0.02, BAY[1], 0.26], 1.0);
    layout.block(foot, [0.0, 0.0, 0.0], [0.5, 0.03, 0.5], 1.0);
    for (x, z) in [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)] {
        layout.rod(foot, [x, 0.0, z], [x, 0.07, z], 0.04, [6.0, 1.0]);
    }
}

/// A beam of two rails and zigzag rods along the frame's x axis, below its origin.
fn truss(layout: &mut Layout, frame: &Frame, length: f32) {
    for z in [-0.1, 0.1] {
        layout.rod(frame, [0.0, 0.0, z], [length, 0.0, z], 0.07, [6.0, 1.0]);
        layout.rod(frame, [0.0, -0.6, z], [length, -0.6, z], 0.07, [6.0, 1.0]);
        let steps = 10;
        for i in 0..steps {
            let (a, b) = (length * i as f32 / steps as f32, length * (i + 1) as f32 / steps as f32);
            let (ya, yb) = if i % 2 == 0 { (-0.6, 0.0) } else { (0.0, -0.6) };
            layout.rod(frame, [a, ya, z], [b, yb, z], 0.04, [5.0, 1.0]);
        }
    }
}

fn bay(layout: &mut Layout, center: &Frame, level: usize, random: &mut Random) {
    if level > 0 {
        grating(layout, center);
    }
    match random.below(4) {
        0 => tank(layout, center, random),
        1 => machine(layout, center, random),
        2 => pipes(layout, center, 14, random),
        _ => pipes(layout, center, 9, random),
    }
    pipes(layout, center, 10, random);
    stairs(layout, &center.moved(-3.2, 0.0, -2.5));
    if random.chance(0.6) {
        bracing(layout, center);
    }
}

/// A floor of thin bars with a railing.
fn grating(layout: &mut Layout, center: &Frame) {
    let bars = 60;
    for i in 0..bars {
        let x = (i as f32 / (bars - 1) as f32 - 0.5) * (BAY[0] - 0.5);
        layout.block(center, [x, -0.03, 0.0], [0.012, 0.03, BAY[2] - 0.5], 0.6);
    }
    for i in 0..12 {
        let z = (i as f32 / 11.0 - 0.5) * (BAY[2] - 0.5);
        layout.rod(center, [-3.75, -0.015, z], [3.75, -0.015, z], 0.015, [4.0, 1.0]);
    }
    for y in [0.5, 1.0] {
        layout.rod(center, [-3.75, y, 3.6], [3.75, y, 3.6], 0.04, [8.0, 1.0]);
    }
    for i in 0..8 {
        let x = (i as f32 / 7.0 - 0.5) * 7.5;
        layout.rod(center, [x, 0.0, 3.6], [x, 1.0, 3.6], 0.035, [6.0, 1.0]);
    }
}

/// Pipes that run parallel to an axis, turn with an elbow and go on, with flanges and valves.
fn pipes(layout: &mut Layout, center: &Frame, count: usize, random: &mut Random) {
    for _ in 0..count {
        let width = if random.chance(0.2) { random.between(0.2, 0.5) } else { random.between(0.04, 0.14) };
        let mut p = Vec3::new(random.between(-3.5, 3.5), random.between(0.4, 4.4), random.between(-3.5, 3.5));
        let mut axis = random.below(3);
        for _ in 0..4 {
            let reach = if axis == 1 { (0.3, 4.6) } else { (-3.7, 3.7) };
            let mut q = p;
            q[axis] = random.between(reach.0, reach.1);
            if (q[axis] - p[axis]).abs() < width * 2.0 {
                continue;
            }
            let sides = 8.0 + 24.0 * width;
            layout.rod(center, p.to_array(), q.to_array(), width, [sides, 1.2]);
            layout.add(Shape::Ball, &center.moved(q.x, q.y, q.z).sized(width * 1.12), [sides, 0.6 * sides]);
            let flange = p.lerp(q, random.between(0.2, 0.8));
            let along = (q - p).normalize();
            let disc = [flange.to_array(), (flange + along * (0.25 * width)).to_array()];
            layout.rod(center, disc[0], disc[1], width * 1.7, [sides, 1.0]);
            if random.chance(0.35) {
                let wheel = center.with(&Frame::along(flange, flange + along, 1.0)).turned(0, 0.25);
                let wheel = wheel.moved(0.0, width * 1.6, 0.0);
                layout.add(Shape::Ring { thickness: 0.15 }, &wheel.sized(width * 2.5), [16.0, 6.0]);
                layout.rod(&wheel, [0.0, -width * 1.6, 0.0], [0.0, 0.05, 0.0], width * 0.3, [6.0, 1.0]);
            }
            p = q;
            axis = (axis + 1 + random.below(2)) % 3;
        }
    }
}

/// A standing vessel with domes, rings and a ladder.
fn tank(layout: &mut Layout, center: &Frame, random: &mut Random) {
    let (radius, height) = (random.between(1.0, 2.0), random.between(2.5, 3.6));
    let body = center.moved(0.0, 0.4, 0.0);
    let tube = body.scaled(2.0 * radius, height, 2.0 * radius);
    layout.add(Shape::Tube { top: 1.0, closed: false }, &tube, [48.0, 8.0]);
    for y in [0.0, height] {
        let dome = body.moved(0.0, y, 0.0).scaled(2.0 * radius, 0.8, 2.0 * radius);
        layout.add(Shape::Ball, &dome, [48.0, 16.0]);
    }
    for i in 0..4 {
        let ring = body.moved(0.0, height * (i as f32 + 0.5) / 4.0, 0.0).sized(2.0 * radius + 0.05);
        layout.add(Shape::Ring { thickness: 0.04 }, &ring, [48.0, 6.0]);
    }
    for x in [-0.2, 0.2] {
        layout.rod(&body, [x, -0.4, radius + 0.15], [x, height, radius + 0.15], 0.03, [6.0, 1.0]);
    }
    for i in 0..14 {
        let y = height * i as f32 / 14.0;
        layout.rod(&body, [-0.2, y, radius + 0.15], [0.2, y, radius + 0.15], 0.02, [6.0, 1.0]);
    }
}

/// A lying cylinder on a foundation with cooling fins.
fn machine(layout: &mut Layout, center: &Frame, random: &mut Random) {
    let turned = center.turned(1, 0.25 * random.below(4) as f32);
    layout.block(&turned, [0.0, 0.0, 0.0], [4.5, 0.5, 2.0], 2.0);
    layout.rod(&turned, [-1.9, 1.4, 0.0], [1.2, 1.4, 0.0], 1.5, [40.0, 4.0]);
    layout.rod(&turned, [1.2, 1.4, 0.0], [2.2, 1.4, 0.0], 0.3, [20.0, 2.0]);
    for i in 0..30 {
        let x = -1.8 + 0.095 * i as f32;
        layout.rod(&turned, [x, 1.4, 0.0], [x + 0.02, 1.4, 0.0], 1.75, [32.0, 1.0]);
    }
    layout.block(&turned, [0.0, 2.2, 0.0], [0.8, 0.5, 0.6], 2.0);
}

/// A flight of steps with rails, rising along z.
fn stairs(layout: &mut Layout, foot: &Frame) {
    let steps = 20;
    for i in 0..steps {
        let t = (i as f32 + 0.5) / steps as f32;
        layout.block(foot, [0.0, t * BAY[1] - 0.02, t * 5.0], [0.9, 0.02, 0.24], 0.8);
    }
    for x in [-0.47, 0.47] {
        layout.rod(foot, [x, 0.0, 0.0], [x, BAY[1], 5.0], 0.08, [6.0, 1.0]);
        layout.rod(foot, [x, 1.0, 0.0], [x, BAY[1] + 1.0, 5.0], 0.04, [8.0, 1.0]);
        for i in 0..6 {
            let t = i as f32 / 5.0;
            layout.rod(foot, [x, t * BAY[1], t * 5.0], [x, t * BAY[1] + 1.0, t * 5.0], 0.03, [6.0, 1.0]);
        }
    }
}

/// Crossed rods from corner to corner of a bay.
fn bracing(layout: &mut Layout, center: &Frame) {
    let (x, y, z) = (0.5 * BAY[0], BAY[1], 0.5 * BAY[2]);
    for (a, b) in [([-x, 0.0, -z], [x, y, -z]), ([x, 0.0, -z], [-x, y, -z]), ([-x, 0.0, z], [x, y, -z])] {
        layout.rod(center, a, b, 0.06, [6.0, 1.0]);
    }
}
