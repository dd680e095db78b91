//! The path tracer: the same rays and image whatever the threads, recorded or not.

use crate::trace_support::*;
use glam::Vec3;
use phr::bvh::WideBvh;
use phr::geometry::{Mesh, Ray};
use phr::scene::View;
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{
    BvhTracer, Image, Isa, PathSettings, RayKind, any_in_parallel, closest_in_parallel, record, render,
};

/// A room with a hole in its ceiling, and things in it.
fn room() -> (Mesh, View) {
    let walls = walls(4);
    let open: Vec<[u32; 3]> = walls
        .triangles()
        .iter()
        .copied()
        .filter(|t| !t.iter().all(|&i| walls.vertices()[i as usize][1] == 1.0))
        .collect();
    let shell = mesh(walls.vertices().to_vec(), open);
    let things = soup(60, 2);
    let shrunk = mesh(
        things.vertices().iter().map(|v| [v[0] * 0.5, v[1] * 0.5 - 0.4, v[2] * 0.5]).collect(),
        things.triangles().to_vec(),
    );
    let view = View {
        eye: Vec3::new(0.1, 0.2, 0.95),
        target: Vec3::new(0.0, -0.3, 0.0),
        up: Vec3::Y,
        fov_y_deg: 70.0,
    };
    (joined(&shell, &shrunk), view)
}

const SETTINGS: PathSettings = PathSettings { width: 70, height: 45, max_depth: 8, seed: 3 };

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

#[test]
fn rays_and_image_do_not_depend_on_threads_or_recording() {
    let (mesh, view) = room();
    let tree: WideBvh<4> = median_tree(&mesh, 4);
    let tracer = BvhTracer::new(&tree);
    let one = with_threads(1, || record(&tracer, &mesh, &view, &SETTINGS));
    let four = with_threads(4, || record(&tracer, &mesh, &view, &SETTINGS));
    assert_eq!(one.batches, four.batches);
    assert_eq!(one.image, four.image);
    assert_eq!(one.image, with_threads(3, || render(&tracer, &mesh, &view, &SETTINGS)));
    assert_eq!(one.invalid, 0);

    let other = record(&tracer, &mesh, &view, &PathSettings { seed: 4, ..SETTINGS });
    assert_ne!(one.batches.primary, other.batches.primary);
}

#[test]
fn batches_hold_what_a_path_tracer_needs() {
    let (mesh, view) = room();
    let tree: WideBvh<8> = median_tree(&mesh, 8);
    let tracer = BvhTracer::new(&tree);
    let recording = record(&tracer, &mesh, &view, &SETTINGS);
    let batches = &recording.batches;
    let pixels = (SETTINGS.width * SETTINGS.height) as usize;
    assert_eq!(batches.primary.len(), pixels);
    assert!(batches.bounce.len() > 2 * pixels, "most paths stay in the room for a while");
    assert!(batches.bounce.len() <= 7 * pixels && batches.shadow.len() <= 8 * pixels);
    assert_eq!(batches.len(), batches.primary.len() + batches.shadow.len() + batches.bounce.len());
    for kind in RayKind::ALL {
        assert!(batches.get(kind).iter().all(Ray::is_valid));
    }
    // Scattered rays leave the triangle they start from: none is stopped at once by it.
    let hits = closest(&tracer, &batches.bounce);
    let stuck = hits.iter().filter(|hit| hit.is_hit() && hit.t < 1e-4).count();
    assert!(stuck * 200 < hits.len(), "{stuck} of {} bounces end where they start", hits.len());
    // No light, no depth: only what the camera sees.
    let flat = record(&tracer, &mesh, &view, &PathSettings { max_depth: 1, ..SETTINGS });
    assert!(flat.batches.bounce.is_empty() && flat.batches.primary == batches.primary);
    let none = record(&tracer, &mesh, &view, &PathSettings { max_depth: 0, ..SETTINGS });
    assert!(none.batches.is_empty());
    let empty = record(&tracer, &mesh, &view, &PathSettings { width: 0, ..SETTINGS });
    assert!(empty.image.rgb.is_empty() && empty.batches.is_empty());
}

#[test]
fn every_kernel_sees_the_recorded_rays_alike() {
    let (mesh, view) = room();
    let (four, eight): (WideBvh<4>, WideBvh<8>) = (median_tree(&mesh, 4), median_tree(&mesh, 3));
    let first = BvhTracer::with_isa(&four, Isa::Scalar);
    let second = BvhTracer::new(&eight);
    let batches = record(&first, &mesh, &view, &SETTINGS).batches;
    for kind in RayKind::ALL {
        let rays = batches.get(kind);
        let verdict = if kind.is_any_hit() {
            let (mut a, mut b) = (vec![false; rays.len()], vec![false; rays.len()]);
            any_in_parallel(&first, rays, &mut a);
            any_in_parallel(&second, rays, &mut b);
            compare_any(&mesh, rays, &a, &b, witness(&[&first, &second]))
        } else {
            let mut a = vec![phr::geometry::Hit::MISS; rays.len()];
            let mut b = a.clone();
            closest_in_parallel(&first, rays, &mut a);
            closest_in_parallel(&second, rays, &mut b);
            compare_closest(&mesh, rays, &a, &b)
        };
        assert!(verdict.is_ok() && verdict.edge * 200 <= verdict.rays, "{}: {verdict}", kind.name());
    }
}

#[test]
fn bad_views_are_counted_not_traced() {
    let (mesh, view) = room();
    let tree: WideBvh<4> = median_tree(&mesh, 4);
    let lost = View { eye: Vec3::new(f32::NAN, 0.0, 0.0), ..view };
    let recording = record(&BvhTracer::new(&tree), &mesh, &lost, &SETTINGS);
    assert!(recording.batches.is_empty());
    assert_eq!(recording.invalid, (SETTINGS.width * SETTINGS.height) as usize);
}

/// The picture to look at: `PHR_PICTURES=folder cargo test --test trace_path picture`.
#[test]
fn a_picture_has_light_and_shade() {
    let (mesh, view) = room();
    let tree: WideBvh<4> = median_tree(&mesh, 4);
    let tracer = BvhTracer::new(&tree);
    let samples = 16;
    let settings = PathSettings { width: 240, height: 160, ..SETTINGS };
    let mut image = Image::new(settings.width, settings.height);
    for seed in 0..samples {
        image.add(&render(&tracer, &mesh, &view, &PathSettings { seed, ..settings }), 1.0 / samples as f32);
    }
    let luminance: Vec<f32> = image.rgb.iter().map(|c| (c[0] + c[1] + c[2]) / 3.0).collect();
    assert!(luminance.iter().all(|x| x.is_finite() && *x >= 0.0));
    let mean = luminance.iter().sum::<f32>() / luminance.len() as f32;
    assert!((0.1..1.5).contains(&mean), "mean luminance {mean}");
    let dark = luminance.iter().filter(|&&x| x < 0.5 * mean).count();
    assert!(dark > luminance.len() / 50, "there are shadows");
    #[cfg(feature = "harness")]
    if let Some(folder) = std::env::var_os("PHR_PICTURES") {
        image.write_png(&std::path::Path::new(&folder).join("room.png")).unwrap();
    }
}
