//! Builders with changed fields over a triangle soup: refused in one line, or a valid tree whose hits are those of
//! brute force, differences judged by the oracle: it lets rays hit or miss at edges, and near triangles without area.

use phr::builders::{NAMES, Recipe};
use phr::geometry::{Hit, Mesh, Ray, Tracer};
use phr::glam::Vec3;
use phr::trace::verify::compare_closest;
use phr::trace::{BruteForce, BvhTracer};

/// A builder of the list with `changes` (`FIELD=VALUE+FIELD=VALUE`), over triangles whose corners are those of
/// `vertices`: whether the configuration can be.
pub fn check(builder: u8, changes: &str, vertices: Vec<[f32; 3]>, triangles: &[[u8; 3]]) -> bool {
    if triangles.len() > 300 || vertices.is_empty() {
        return false;
    }
    let base = NAMES[builder as usize % NAMES.len()];
    let name = if changes.is_empty() { base.to_owned() } else { format!("{base}[{changes}]") };
    let recipe = match Recipe::parse(&name) {
        Ok(recipe) => recipe,
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
            return false;
        }
    };
    let count = vertices.len() as u32;
    let triangles = triangles.iter().map(|t| t.map(|v| u32::from(v) % count)).collect();
    let Ok((mesh, _)) = Mesh::new(vertices, triangles) else { return false };
    check_width::<4>(&recipe, &mesh);
    check_width::<8>(&recipe, &mesh);
    true
}

fn check_width<const N: usize>(recipe: &Recipe, mesh: &Mesh) {
    let build = recipe.builder::<N>().build(mesh);
    assert_eq!(build.tree.validate(mesh), Ok(()), "{}", recipe.name());
    let bounds = mesh.bounds();
    let size = bounds.extent().max_element();
    // Beyond, products of three lengths may leave single precision.
    if !(1e-6..1e9).contains(&size) {
        return;
    }
    let center = 0.5 * (bounds.min + bounds.max);
    let rays: Vec<Ray> = (0..8)
        .map(|i| {
            let dir = Vec3::new(1.0 + i as f32, 3.0 - i as f32, 0.5 * i as f32 - 1.7);
            Ray { org: Vec3::from(center) - dir * size, tnear: 0.0, dir, tfar: f32::INFINITY }
        })
        .collect();
    let (mut found, mut expected) = (vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]);
    BvhTracer::new(&build.tree).closest(&rays, &mut found);
    BruteForce(mesh).closest(&rays, &mut expected);
    let verdict = compare_closest(mesh, &rays, &expected, &found);
    assert!(verdict.is_ok(), "{}: {verdict}", recipe.name());
}
