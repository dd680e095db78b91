//! A scanned statue: one closed, noisy surface of many small triangles of uneven size.

use super::generated_scene::{Generator, view};
use super::parts::{Frame, Layout, Shape};

/// The built-in statue.
pub const STATUE: Generator = Generator {
    name: "statue",
    triangles: 200_000,
    about: "a seated figure as if scanned: one closed surface, small triangles of uneven size",
    seed: 2,
    layout: |layout| figure(layout, &Frame::WORLD, layout.seed, [220.0, 7.2]),
    views: &[
        view([0.55, 0.75, 1.75], [0.0, 0.44, 0.0], 38.0),
        view([-0.95, 0.62, 0.55], [0.0, 0.55, 0.0], 45.0),
        view([0.22, 0.86, 0.62], [0.0, 0.72, 0.0], 40.0),
    ],
};

/// The stand-in for Happy Buddha.
pub const BUDDHA: Generator =
    Generator { name: "buddha-like", triangles: 1_087_000, seed: 12, about: STATUE.about, ..STATUE };

/// The figure, 1 high in `frame`, as strips that share their edges; about `base` cells around and per strip.
pub fn figure(layout: &mut Layout, frame: &Frame, seed: u64, base: [f32; 2]) {
    const STRIPS: u32 = 64;
    let n = [layout.fine(base[0]).max(3), layout.fine(base[1])];
    for strip in 0..STRIPS {
        let (from, to) = (strip as f32 / STRIPS as f32, (strip + 1) as f32 / STRIPS as f32);
        layout.add_plain(Shape::Figure { seed, from, to }, frame, n);
    }
}
