//! From a list of parts to a mesh with an exact number of triangles.

use super::frame::Frame;
use super::part::{Draft, Part, Shape};
use super::random::{Random, mix};
use crate::memory::huge_pages;
use rayon::prelude::*;

/// What memory is asked for.
const ARRAYS: &str = "a generated scene";

/// The list of parts of a scene, laid out for a given detail.
#[derive(Debug)]
pub struct Layout {
    /// Names the random choices.
    pub seed: u64,
    /// Factor on every tessellation; numbers of things grow with its square.
    detail: f32,
    /// Triangles wanted; no parts are kept once there are more.
    limit: usize,
    parts: Vec<Part>,
    triangles: usize,
}

impl Layout {
    fn new(seed: u64, detail: f32, limit: usize) -> Self {
        Self { seed, detail, limit, parts: Vec::new(), triangles: 0 }
    }

    /// Adds a shape cut into about `base` cells at detail 1. Fractions are rounded up in some places and down
    /// in others, so that the number of triangles grows smoothly with the detail.
    pub fn add(&mut self, shape: Shape, frame: &Frame, base: [f32; 2]) {
        let place = place(frame);
        let least = shape.least();
        let cells = |axis: usize| {
            let dither = Random::new(place, axis as u64).unit();
            ((base[axis] * self.detail + dither) as u32).max(least[axis])
        };
        self.add_plain(shape, frame, [cells(0), cells(1)]);
    }

    /// Adds a shape with the tessellation as given, whatever the detail.
    pub fn add_plain(&mut self, shape: Shape, frame: &Frame, n: [u32; 2]) {
        let part = Part { shape, frame: *frame, n };
        self.triangles += part.triangles();
        if self.triangles <= self.limit {
            huge_pages::push(&mut self.parts, part, ARRAYS);
        }
    }

    /// A number of things that is `base` at detail 1 and grows with the square of the detail.
    pub fn many(&self, base: f32) -> usize {
        ((base * self.detail * self.detail) as usize).max(1)
    }

    /// A number of cells that is `base` at detail 1, for parts that must fit each other.
    pub fn fine(&self, base: f32) -> u32 {
        ((base * self.detail) as u32).max(1)
    }

    /// Random numbers for what stands at the frame's origin.
    pub fn random_at(&self, frame: &Frame) -> Random {
        Random::new(self.seed, place(frame))
    }

    /// Random numbers for the thing called `stream`.
    pub fn random(&self, stream: u64) -> Random {
        Random::new(self.seed, stream)
    }
}

/// A number for the frame's origin.
fn place(frame: &Frame) -> u64 {
    let [x, y, z] = frame.origin.to_array().map(|x| u64::from(x.to_bits()));
    mix(x | y << 32) ^ z
}

/// Makes the scene that `lay` lays out, with the detail that comes closest to `triangles` from below; the few
/// that are missing come from halving triangles spread evenly over the scene.
pub fn draw(triangles: usize, seed: u64, lay: &dyn Fn(&mut Layout)) -> Draft {
    let layout = fitting(triangles, seed, lay);
    let parts = &layout.parts;
    let chunk = parts.len().div_ceil(256).max(1);
    let drafts: Vec<Draft> = parts
        .par_chunks(chunk)
        .map(|parts| {
            let mut draft = Draft::default();
            huge_pages::reserve(&mut draft.triangles, parts.iter().map(Part::triangles).sum(), ARRAYS);
            for part in parts {
                // No more than a corner of each cell for each triangle and each side of it.
                huge_pages::make_room(&mut draft.vertices, 2 * part.triangles(), ARRAYS);
                part.draw(&mut draft);
            }
            draft
        })
        .collect();
    let mut whole = Draft::default();
    let vertices = drafts.iter().map(|draft| draft.vertices.len()).sum::<usize>();
    huge_pages::reserve(&mut whole.vertices, vertices + triangles / 8, ARRAYS);
    huge_pages::reserve(&mut whole.triangles, triangles, ARRAYS);
    for draft in drafts {
        let first = whole.vertices.len() as u32;
        whole.vertices.extend(draft.vertices);
        whole.triangles.extend(draft.triangles.into_iter().map(|t| t.map(|i| first + i)));
    }
    halve_evenly(&mut whole, triangles);
    whole.triangles.truncate(triangles);
    whole
}

/// How many triangles [`draw`] makes before it halves some.
#[cfg(test)]
pub fn count(triangles: usize, seed: u64, lay: &dyn Fn(&mut Layout)) -> usize {
    fitting(triangles, seed, lay).triangles
}

/// The layout with at most `triangles`, as close as a bisection of the detail comes; only counts are made.
fn fitting(triangles: usize, seed: u64, lay: &dyn Fn(&mut Layout)) -> Layout {
    let at = |detail: f32| {
        let mut layout = Layout::new(seed, detail, triangles);
        lay(&mut layout);
        (layout.triangles <= triangles).then_some(layout)
    };
    let mut low = 1.0;
    let mut best = at(low);
    while best.is_none() && low > 1e-3 {
        low *= 0.5;
        best = at(low);
    }
    let Some(mut best) = best else {
        // Fewer triangles than the coarsest layout: a ball in its place, or a sheet.
        let mut layout = Layout::new(seed, 1.0, triangles.max(2));
        let (shape, n) = if triangles < 6 { (Shape::Sheet, [1, 1]) } else { (Shape::Ball, [3, 2]) };
        layout.add_plain(shape, &Frame::WORLD, n);
        return layout;
    };
    let mut high = low * 1.5;
    while let Some(layout) = at(high) {
        assert!(high < 1e4, "the layout does not grow with the detail");
        (low, best, high) = (high, layout, high * 1.5);
    }
    for _ in 0..14 {
        let middle = 0.5 * (low + high);
        match at(middle) {
            Some(layout) => (low, best) = (middle, layout),
            None => high = middle,
        }
    }
    best
}

/// Halves evenly spread triangles at the middle of their longest edges until there are `wanted`.
fn halve_evenly(draft: &mut Draft, wanted: usize) {
    while draft.triangles.len() < wanted && !draft.triangles.is_empty() {
        let given = draft.triangles.len();
        let missing = (wanted - given).min(given);
        huge_pages::make_room(&mut draft.vertices, missing, ARRAYS);
        huge_pages::make_room(&mut draft.triangles, missing, ARRAYS);
        for k in 0..missing {
            let victim = (k as u64 * given as u64 / missing as u64) as usize;
            let t = draft.triangles[victim];
            let corner = |i: usize| glam::Vec3::from_array(draft.vertices[t[i % 3] as usize]);
            let longest = (0..3)
                .max_by(|&i, &j| {
                    let length = |i| (corner(i + 1) - corner(i)).length_squared();
                    length(i).total_cmp(&length(j))
                })
                .unwrap_or(0);
            let [a, b, c] = [t[longest], t[(longest + 1) % 3], t[(longest + 2) % 3]];
            let middle = draft.vertices.len() as u32;
            draft.vertices.push(((corner(longest) + corner(longest + 1)) * 0.5).to_array());
            draft.triangles[victim] = [a, middle, c];
            draft.triangles.push([middle, b, c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_as_many_triangles_as_they_say() {
        let shapes = [
            Shape::Sheet,
            Shape::Block,
            Shape::Tube { top: 0.5, closed: false },
            Shape::Tube { top: 0.5, closed: true },
            Shape::Ball,
            Shape::Ring { thickness: 0.2 },
            Shape::Turned { profile: &[[0.5, 0.0], [0.4, 0.5], [0.1, 1.0]] },
            Shape::Arch { thickness: 0.1 },
            Shape::Hills { seed: 1, bumps: 4.0 },
            Shape::Figure { seed: 1, from: 0.2, to: 0.6 },
            Shape::Hair { seed: 1, radius: 0.01 },
            Shape::Leaves { seed: 1, length: 0.1 },
        ];
        for shape in shapes {
            for n in [shape.least(), [5, 4], [12, 7]] {
                let part = Part { shape, frame: Frame::WORLD, n };
                let mut draft = Draft::default();
                part.draw(&mut draft);
                assert_eq!(draft.triangles.len(), part.triangles(), "{part:?}");
                let vertices = draft.vertices.len() as u32;
                assert!(draft.triangles.iter().flatten().all(|&i| i < vertices), "{part:?}");
                assert!(draft.vertices.iter().flatten().all(|x| x.is_finite()), "{part:?}");
            }
        }
    }

    #[test]
    fn closed_shapes_enclose_a_volume_with_outward_normals() {
        let volume = |shape, n| {
            let mut draft = Draft::default();
            Part { shape, frame: Frame::WORLD, n }.draw(&mut draft);
            let corner = |i: u32| glam::Vec3::from_array(draft.vertices[i as usize]);
            draft
                .triangles
                .iter()
                .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0)
                .sum::<f32>()
        };
        let pi = std::f32::consts::PI;
        let cases = [
            ("block", volume(Shape::Block, [2, 3]), 1.0),
            ("tube", volume(Shape::Tube { top: 1.0, closed: true }, [64, 2]), pi / 4.0),
            ("ball", volume(Shape::Ball, [64, 64]), pi / 6.0),
            ("ring", volume(Shape::Ring { thickness: 0.2 }, [96, 64]), pi * 0.01 * pi),
        ];
        for (name, volume, expected) in cases {
            assert!((volume / expected - 1.0).abs() < 0.01, "{name}: {volume} instead of {expected}");
        }
    }

    #[test]
    fn halving_hits_any_number() {
        for wanted in [2, 3, 5, 17, 100] {
            let mut draft = Draft::default();
            Part { shape: Shape::Sheet, frame: Frame::WORLD, n: [1, 1] }.draw(&mut draft);
            halve_evenly(&mut draft, wanted);
            assert_eq!(draft.triangles.len(), wanted);
        }
    }
}
