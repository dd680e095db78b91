//! Scenes of any size and mixed character, to see how builders grow: fields with a statue, a hair ball, trees,
//! furniture, a bay of pipes or a house on each.

use super::parts::furniture;
use super::parts::{Frame, Layout, Shape, draw};
use super::{city, hair, plant, statue};
use crate::geometry::Mesh;
use crate::scene::model::Scene;
use crate::scene::views::View;
use glam::Vec3;

/// Side of a field, metres; triangles that one takes at detail 1.
const FIELD: f32 = 12.0;
const PER_FIELD: usize = 60_000;

/// What the names of these scenes begin with; triangles follow, as in `scalable-500k` or `scalable-32M`.
const PREFIX: &str = "scalable-";
/// Thousands and millions of triangles in names.
const UNITS: [(&str, usize); 2] = [("M", 1_000_000), ("k", 1000)];

/// The name of the scene of `triangles`, in the largest unit that needs no fraction.
pub fn scalable_name(triangles: usize) -> String {
    let unit = UNITS.into_iter().find(|(_, unit)| triangles > 0 && triangles.is_multiple_of(*unit));
    let (letter, unit) = unit.unwrap_or(("", 1));
    format!("{PREFIX}{}{letter}", triangles / unit)
}

/// How many triangles the scene called `name` has; `None` if none is called so or it would have too many.
pub fn scalable_triangles(name: &str) -> Option<usize> {
    let number = name.strip_prefix(PREFIX)?;
    let in_unit = |(letter, unit)| number.strip_suffix(letter).map(|digits| (digits, unit));
    let (digits, unit) = UNITS.into_iter().find_map(in_unit).unwrap_or((number, 1));
    let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    let triangles = digits.parse::<usize>().ok().filter(|_| is_number)?.checked_mul(unit)?;
    (triangles > 0 && triangles <= Mesh::MAX_TRIANGLES).then_some(triangles)
}

/// A scene of exactly `triangles` (at most [`Mesh::MAX_TRIANGLES`]); more triangles are more fields of the
/// same kinds, as in a larger part of the same world.
pub fn scalable(triangles: usize, seed: u64) -> Scene {
    let triangles = triangles.min(Mesh::MAX_TRIANGLES);
    let fields = ((triangles as f64 / PER_FIELD as f64).sqrt().ceil() as usize).max(1);
    let draft = draw(triangles, seed, &|layout: &mut Layout| world(layout, fields));
    let (mesh, dropped) =
        Mesh::new(draft.vertices, draft.triangles).expect("no more triangles than a mesh may have were made");
    let (size, up) = (fields as f32 * FIELD, Vec3::Y);
    let view = |eye: [f32; 3], target: [f32; 3], fov_y_deg| View {
        eye: Vec3::from_array(eye),
        target: Vec3::from_array(target),
        up,
        fov_y_deg,
    };
    let views = vec![
        view([-0.3 * size, 0.45 * size + 4.0, -0.3 * size], [0.5 * size, 0.0, 0.5 * size], 45.0),
        view([0.5 * size, 3.0, -8.0], [0.5 * size, 2.0, 20.0], 60.0),
        view([size + 6.0, 7.0, 0.4 * size], [0.0, 0.0, 0.5 * size], 55.0),
    ];
    Scene::new(scalable_name(triangles), mesh, dropped, views, format!("generated, seed {seed}"))
}

fn world(layout: &mut Layout, fields: usize) {
    let size = fields as f32 * FIELD;
    let ground = Frame::at(0.5 * size, -0.45, 0.5 * size).scaled(3.0 * size, 0.2, 3.0 * size);
    let cells = 8.0 * fields as f32;
    layout.add(Shape::Hills { seed: layout.seed, bumps: 6.0 * fields as f32 }, &ground, [cells, cells]);
    for i in 0..fields * fields {
        let mut random = layout.random(i as u64);
        let at = |k: usize| (k as f32 + 0.5) * FIELD;
        let middle = Frame::at(at(i % fields), 0.0, at(i / fields)).turned(1, 0.25 * random.below(4) as f32);
        match random.below(6) {
            0 => statue::figure(layout, &middle.sized(8.0), random.bits(), [200.0, 2.0]),
            1 => hair::ball(layout, &middle.moved(0.0, 4.5, 0.0).sized(4.5), 400.0, 0.006),
            2 => {
                for _ in 0..8 {
                    let (x, z) = (random.between(-5.0, 5.0), random.between(-5.0, 5.0));
                    let height = random.between(4.0, 9.0);
                    city::tree(layout, &middle.moved(x, 0.0, z), height, &mut random);
                    let crown = middle.moved(x, 0.75 * height, z).sized(0.25 * height);
                    let leaves = layout.many(900.0) as u32;
                    layout.add_plain(
                        Shape::Leaves { seed: random.bits(), length: 0.15 },
                        &crown,
                        [leaves, 3],
                    );
                }
            }
            3 => {
                for k in 0..6 {
                    let place = middle.moved((k % 3) as f32 * 3.5 - 3.5, 0.0, (k / 3) as f32 * 4.0 - 2.0);
                    furniture::desk(layout, &place, &mut random);
                    furniture::shelf(layout, &place.moved(0.0, 0.0, -1.5), 2.0, &mut random);
                }
            }
            4 => plant::hall(layout, &middle.moved(-4.0, 0.0, -4.0), [1, 2, 1]),
            _ => {
                for turn in 0..4 {
                    let side = middle.turned(1, 0.25 * turn as f32).moved(0.0, 0.0, 1.5);
                    city::house(layout, &side, [9.0, random.between(7.0, 12.0), 6.0], &mut random);
                }
            }
        }
    }
}
