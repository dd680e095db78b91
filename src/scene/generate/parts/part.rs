//! Parts: the simple surfaces of which generated scenes consist.
//!
//! A scene is laid out as a list of parts whose triangles can be counted without making them; the detail that
//! gives a wanted number of triangles is found by counting alone, and the parts are made in parallel.

use super::figure;
use super::frame::{Frame, across, sin_cos};
use super::random::{Random, fractal, mix, noise};
use glam::Vec3;

/// A surface in its own coordinates. `n` is the part's tessellation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The square of side 1 around the origin in the xz plane, `n[0]` by `n[1]` cells.
    Sheet,
    /// The unit cube standing on the xz plane, `n[0]` cells sideways, `n[1]` upwards.
    Block,
    /// A tube of radius 1/2 below and `top`/2 above, 0 <= y <= 1, closed if `closed`; `n[0]` sides, `n[1]` stacks.
    Tube { top: f32, closed: bool },
    /// The ball of radius 1/2 around the origin; `n[0]` slices, `n[1]` stacks.
    Ball,
    /// A ring of radius 1/2 in the xz plane, as thick as `thickness`; `n[0]` around, `n[1]` around the thickness.
    Ring { thickness: f32 },
    /// A surface of revolution through points (radius, y); `n[0]` slices, `n[1]` stacks between two points.
    Turned { profile: &'static [[f32; 2]] },
    /// An arch in the xy plane: half a ring of outer radius 1/2 over the x axis, as thick as `thickness` and
    /// as deep as 1 along z; `n[0]` stones along, `n[1]` across.
    Arch { thickness: f32 },
    /// The sheet displaced along y by smooth bumps of size 1/`bumps` and height about 1.
    Hills { seed: u64, bumps: f32 },
    /// A strip of a seated statue 1 high, between two heights of its outline (0 to 1); `n[0]` around, `n[1]` up.
    Figure { seed: u64, from: f32, to: f32 },
    /// A curled hair within the unit ball; `n[0]` sides, `n[1]` segments.
    Hair { seed: u64, radius: f32 },
    /// Leaves in the unit ball, each about 0.1 long; `n[0]` leaves of `n[1]` pairs of triangles.
    Leaves { seed: u64, length: f32 },
}

/// A shape with its place and tessellation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The shape.
    pub shape: Shape,
    /// The place.
    pub frame: Frame,
    /// The tessellation.
    pub n: [u32; 2],
}

/// Vertices and triangles of the parts so far.
#[derive(Clone, Debug, Default)]
pub struct Draft {
    /// x, y, z.
    pub vertices: Vec<[f32; 3]>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// The coarsest tessellation that is a surface.
    pub fn least(&self) -> [u32; 2] {
        match self {
            Self::Sheet | Self::Block | Self::Hills { .. } | Self::Leaves { .. } => [1, 1],
            Self::Tube { .. } | Self::Turned { .. } | Self::Hair { .. } => [3, 1],
            Self::Ball => [3, 2],
            Self::Ring { .. } => [3, 3],
            Self::Arch { .. } => [2, 1],
            Self::Figure { .. } => [3, 1],
        }
    }
}

impl Part {
    /// How many triangles [`Part::draw`] makes.
    pub fn triangles(&self) -> usize {
        let [a, b] = self.n.map(|n| n as usize);
        match self.shape {
            Shape::Block => 8 * a * b + 4 * a * a,
            Shape::Tube { closed, .. } => 2 * a * b + if closed { 2 * (a - 2) } else { 0 },
            Shape::Ball => 2 * a * (b - 1),
            Shape::Turned { profile } => 2 * a * b * (profile.len() - 1),
            Shape::Arch { .. } => 8 * a * b,
            Shape::Sheet
            | Shape::Ring { .. }
            | Shape::Hills { .. }
            | Shape::Figure { .. }
            | Shape::Hair { .. }
            | Shape::Leaves { .. } => 2 * a * b,
        }
    }

    /// Appends the part's triangles.
    pub fn draw(&self, out: &mut Draft) {
        let [a, b] = self.n;
        let frame = self.frame;
        match self.shape {
            Shape::Sheet => out.grid(self.n, |u, v| frame.point(Vec3::new(u - 0.5, 0.0, 0.5 - v))),
            Shape::Hills { seed, bumps } => out.grid(self.n, |u, v| {
                let height = fractal(seed, Vec3::new(u * bumps, 0.5, v * bumps), 5);
                frame.point(Vec3::new(u - 0.5, height, 0.5 - v))
            }),
            Shape::Block => {
                let side = |x: Vec3, z: Vec3, out: &mut Draft| {
                    out.grid([a, b], |u, v| frame.point(x * (u - 0.5) + Vec3::Y * v + z * 0.5));
                };
                side(Vec3::X, Vec3::Z, out);
                side(-Vec3::Z, Vec3::X, out);
                side(-Vec3::X, -Vec3::Z, out);
                side(Vec3::Z, -Vec3::X, out);
                out.grid([a, a], |u, v| frame.point(Vec3::new(u - 0.5, 1.0, 0.5 - v)));
                out.grid([a, a], |u, v| frame.point(Vec3::new(u - 0.5, 0.0, v - 0.5)));
            }
            Shape::Tube { top, closed } => {
                let first = out.vertices.len() as u32;
                out.grid(self.n, |u, v| {
                    let (sin, cos) = sin_cos(u);
                    let radius = 0.5 * (1.0 + (top - 1.0) * v);
                    frame.point(Vec3::new(radius * sin, v, radius * cos))
                });
                if closed {
                    let last = first + (a + 1) * b;
                    for i in 1..a - 1 {
                        out.triangles.push([first, first + i + 1, first + i]);
                        out.triangles.push([last, last + i, last + i + 1]);
                    }
                }
            }
            Shape::Ball => out.ball(self.n, |d| frame.point(d * 0.5)),
            Shape::Ring { thickness } => out.grid(self.n, |u, v| {
                let ((sin, cos), (rise, reach)) = (sin_cos(u), sin_cos(v));
                let radius = 0.5 + reach * thickness * 0.5;
                frame.point(Vec3::new(radius * sin, rise * thickness * 0.5, radius * cos))
            }),
            Shape::Turned { profile } => {
                for pair in profile.windows(2) {
                    let ([r0, y0], [r1, y1]) = (pair[0], pair[1]);
                    out.grid(self.n, |u, v| {
                        let (sin, cos) = sin_cos(u);
                        let radius = r0 + (r1 - r0) * v;
                        frame.point(Vec3::new(radius * sin, y0 + (y1 - y0) * v, radius * cos))
                    });
                }
            }
            Shape::Arch { thickness } => {
                let at = |u: f32, radius: f32, z: f32| {
                    let (sin, cos) = sin_cos(u * 0.5);
                    frame.point(Vec3::new(-radius * cos, radius * sin, z))
                };
                let inner = 0.5 - thickness;
                out.grid(self.n, |u, v| at(u, 0.5, 0.5 - v));
                out.grid(self.n, |u, v| at(u, inner, v - 0.5));
                out.grid(self.n, |u, v| at(u, inner + thickness * v, 0.5));
                out.grid(self.n, |u, v| at(u, 0.5 - thickness * v, -0.5));
            }
            Shape::Figure { seed, from, to } => {
                out.grid(self.n, |u, v| frame.point(figure::surface(seed, u, from + (to - from) * v)));
            }
            Shape::Hair { seed, radius } => hair(out, &frame, self.n, seed, radius),
            Shape::Leaves { seed, length } => leaves(out, &frame, self.n, seed, length),
        }
    }
}

/// A random walk outwards from near the centre, swept by a polygon.
fn hair(out: &mut Draft, frame: &Frame, [sides, segments]: [u32; 2], seed: u64, radius: f32) {
    let mut random = Random::new(seed, 0);
    let start = random.in_ball();
    let mut direction = start.normalize();
    let mut p = direction * random.between(0.1, 0.35);
    let step = random.between(0.6, 1.0) / segments as f32;
    let first = out.vertices.len() as u32;
    for i in 0..=segments {
        let [x, z] = across(direction);
        let radius = radius * (1.0 - 0.7 * i as f32 / segments as f32);
        for side in 0..sides {
            let (sin, cos) = sin_cos(side as f32 / sides as f32);
            out.vertices.push(frame.point(p + x * (radius * cos) + z * (radius * sin)).to_array());
        }
        p += direction * step;
        // Neighbouring hairs feel the same curl, as locks do, and each its own.
        let curl = |axis: u64| noise(axis, p * 2.5) * 5.0 + noise(mix(seed) ^ axis, p * 6.0) * 4.0;
        let bend = Vec3::new(curl(1), curl(2), curl(3)) * step * 1.5;
        let inwards = if p.length() > 0.9 { -p * (step * 8.0) } else { Vec3::ZERO };
        direction = (direction + bend + inwards).normalize_or(direction);
    }
    for i in 0..segments {
        for side in 0..sides {
            let (a, b) = (first + i * sides + side, first + i * sides + (side + 1) % sides);
            out.triangles.push([a, b, b + sides]);
            out.triangles.push([a, b + sides, a + sides]);
        }
    }
}

/// Folded leaves at random places in the outer part of the unit ball, lying more or less along its surface.
fn leaves(out: &mut Draft, frame: &Frame, [count, pairs]: [u32; 2], seed: u64, length: f32) {
    let mut random = Random::new(seed, 0);
    for _ in 0..count {
        let p = random.in_ball();
        let p = p.normalize() * p.length().sqrt();
        let along = (random.in_ball() - p * 0.3).normalize_or(Vec3::X);
        let [x, z] = across(along);
        let length = length * random.between(0.7, 1.3);
        let width = length * random.between(0.2, 0.3);
        let first = out.vertices.len() as u32;
        // A strip of pairs of triangles, widest in the middle, folded along its length and bent downwards.
        for i in 0..=pairs {
            let t = i as f32 / pairs as f32;
            let half = width * (t * (1.0 - t) * 4.0 + 0.05);
            let middle = p + along * (length * t) + z * (length * 0.4 * t * t);
            for side in [-1.0, 1.0] {
                out.vertices.push(frame.point(middle + x * (half * side) + z * (half * 0.3)).to_array());
            }
        }
        for i in 0..pairs {
            let a = first + 2 * i;
            out.triangles.push([a, a + 1, a + 3]);
            out.triangles.push([a, a + 3, a + 2]);
        }
    }
}

impl Draft {
    /// A grid of `n[0]` by `n[1]` cells, two triangles each, through `at(u, v)` with u and v from 0 to 1.
    fn grid(&mut self, n: [u32; 2], at: impl Fn(f32, f32) -> Vec3) {
        let first = self.vertices.len() as u32;
        let row = n[0] + 1;
        for j in 0..=n[1] {
            for i in 0..=n[0] {
                self.vertices.push(at(i as f32 / n[0] as f32, j as f32 / n[1] as f32).to_array());
            }
        }
        for j in 0..n[1] {
            for i in 0..n[0] {
                let a = first + j * row + i;
                self.triangles.push([a, a + 1, a + row + 1]);
                self.triangles.push([a, a + row + 1, a + row]);
            }
        }
    }

    /// Slices and stacks around the y axis through `at` of unit vectors, with one vertex at each pole.
    fn ball(&mut self, [slices, stacks]: [u32; 2], at: impl Fn(Vec3) -> Vec3) {
        let south = self.vertices.len() as u32;
        self.vertices.push(at(-Vec3::Y).to_array());
        for j in 1..stacks {
            let (sin, cos) = sin_cos(0.5 * j as f32 / stacks as f32);
            for i in 0..slices {
                let (x, z) = sin_cos(i as f32 / slices as f32);
                self.vertices.push(at(Vec3::new(x * sin, -cos, z * sin)).to_array());
            }
        }
        let north = self.vertices.len() as u32;
        self.vertices.push(at(Vec3::Y).to_array());
        for i in 0..slices {
            let (a, b) = (south + 1 + i, south + 1 + (i + 1) % slices);
            self.triangles.push([south, b, a]);
            for j in 0..stacks - 2 {
                let (a, b) = (a + j * slices, b + j * slices);
                self.triangles.push([a, b, b + slices]);
                self.triangles.push([a, b + slices, a + slices]);
            }
            let up = (stacks - 2) * slices;
            self.triangles.push([a + up, b + up, north]);
        }
    }
}
