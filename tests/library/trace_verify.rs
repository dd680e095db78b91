//! The comparison of hits must find what is wrong and excuse only what rounding explains.

use crate::trace_support::*;
use glam::Vec3;
use phr::geometry::{Hit, Ray};
use phr::trace::verify::{compare_any, compare_closest, witness};
use phr::trace::{BruteForce, BvhTracer, Isa, hit_hash};

#[test]
fn every_forged_answer_is_found() {
    let mesh = soup(400, 3);
    let rays = rays(&mesh, 4000, 4);
    let reference = closest(&BruteForce(&mesh), &rays);
    assert_eq!(compare_closest(&mesh, &rays, &reference, &reference).equal, rays.len());

    let interior = |hit: &Hit| hit.is_hit() && hit.u > 0.05 && hit.v > 0.05 && hit.u + hit.v < 0.95;
    type Forgery = (&'static str, fn(Hit) -> Hit);
    let forgeries: [Forgery; 5] = [
        ("lost", |_| Hit::MISS),
        ("farther", |hit| Hit { t: hit.t * 1.01, ..hit }),
        ("nearer", |hit| Hit { t: hit.t * 0.99, ..hit }),
        ("NaN", |hit| Hit { t: f32::NAN, ..hit }),
        ("no such triangle", |hit| Hit { prim: 77_777, ..hit }),
    ];
    for (name, forge) in forgeries {
        let mut forged = 0;
        let hits: Vec<Hit> = reference
            .iter()
            .map(|hit| {
                if interior(hit) && hit.t > 0.01 {
                    forged += 1;
                    forge(*hit)
                } else {
                    *hit
                }
            })
            .collect();
        for (a, b) in [(&reference, &hits), (&hits, &reference)] {
            let verdict = compare_closest(&mesh, &rays, a, b);
            assert_eq!(
                verdict.rays,
                verdict.equal + verdict.ties + verdict.edge + verdict.near_misses + verdict.mismatched
            );
            // Rays that start on the surface or graze it are rightly doubtful.
            assert!(
                verdict.mismatched + verdict.edge + verdict.near_misses == forged,
                "{name}: {verdict}, {forged} forged"
            );
            assert!(verdict.mismatched * 100 > forged * 97, "{name}: {verdict}, {forged} forged");
        }
    }
    let invented: Vec<Hit> = reference
        .iter()
        .map(|hit| if hit.is_hit() { *hit } else { Hit { t: 1.0, u: 0.2, v: 0.2, prim: 0 } })
        .collect();
    let misses = reference.iter().filter(|hit| !hit.is_hit()).count();
    let verdict = compare_closest(&mesh, &rays, &reference, &invented);
    assert!(verdict.mismatched * 100 > misses * 99, "{verdict}, {misses} invented");
}

#[test]
fn forged_shadows_are_found() {
    let mesh = soup(400, 5);
    let rays = rays(&mesh, 4000, 6);
    let brute = BruteForce(&mesh);
    let reference = any(&brute, &rays);
    let inverted: Vec<bool> = reference.iter().map(|x| !x).collect();
    for (a, b) in [(&reference, &inverted), (&inverted, &reference)] {
        let verdict = compare_any(&mesh, &rays, a, b, witness(&[&brute]));
        assert!(verdict.mismatched * 100 > rays.len() * 97, "{verdict}");
        for example in verdict.mismatches {
            let shown = example.reference.is_hit() || example.hit.is_hit();
            assert_eq!(shown, reference[example.ray], "{example}");
        }
    }
}

#[test]
fn a_shadow_behind_a_grazed_edge_is_still_a_shadow() {
    // The ray passes exactly through an edge of the first triangle and the middle of the second.
    let mesh = mesh(
        vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, -1.0, -1.0],
            [2.0, -1.0, -1.0],
            [-1.0, 2.0, -1.0],
        ],
        vec![[0, 1, 2], [3, 4, 5]],
    );
    let brute = BruteForce(&mesh);
    let long = ray([0.25, 0.0, 1.0], [0.0, 0.0, -1.0]);
    let short = Ray { tfar: 1.5, ..long };
    let verdict = compare_any(&mesh, &[long, short], &[true, true], &[false, false], witness(&[&brute]));
    assert_eq!((verdict.mismatched, verdict.edge), (1, 1));
    assert_eq!(verdict.mismatches[0].ray, 0);
    assert_eq!(verdict.mismatches[0].reference.prim, 1);
}

#[test]
fn coplanar_twins_tie_and_edges_are_counted_apart() {
    let triangle = one_triangle();
    let mesh = joined(&triangle, &triangle);
    let hit = |prim| Hit { t: 1.0, u: 0.25, v: 0.25, prim };
    let down = ray([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
    let verdict = compare_closest(&mesh, &[down], &[hit(0)], &[hit(1)]);
    assert_eq!((verdict.ties, verdict.is_ok()), (1, true));

    let edge = ray([0.5, 0.5, 1.0], [0.0, 0.0, -1.0]);
    let verdict = compare_closest(&mesh, &[edge], &[hit(0)], &[Hit::MISS]);
    assert_eq!((verdict.edge, verdict.is_ok()), (1, true));

    let beside = ray([0.7, 0.7, 1.0], [0.0, 0.0, -1.0]);
    let verdict = compare_closest(&mesh, &[beside], &[hit(0)], &[Hit::MISS]);
    assert_eq!(verdict.mismatched, 1);
    let text = verdict.to_string();
    assert!(
        text.contains("0 near misses, 1 mismatches (ray 0: reference hit triangle 0 at 1e0, not nothing)"),
        "{text}"
    );
}

/// A thousand long, a hundredth wide, at an angle to the ray: the computed normal is off.
#[test]
fn what_only_thin_triangles_explain_is_a_near_miss() {
    let thin = mesh(vec![[0.0, 0.0, 0.0], [1000.0, 1000.0, 300.0], [500.0, 500.02, 150.0]], vec![[0, 1, 2]]);
    let down = ray([500.0, 500.007, 500.0], [0.0, 0.0, -1.0]);
    let hit = Hit { t: 350.0, u: 0.3, v: 0.3, prim: 0 };
    let verdict = compare_closest(&thin, &[down], &[hit], &[Hit::MISS]);
    assert_eq!((verdict.near_misses, verdict.edge, verdict.is_ok()), (1, 0, true), "{verdict}");
    let wrong = Hit { t: 100.0, ..hit };
    assert_eq!(compare_closest(&thin, &[down], &[wrong], &[hit]).mismatched, 1);
}

/// A triangle with two equal corners, 8192 long, and rays through its middle. By fused multiplication its normal is the
/// rounding error of a product, and the second ray hits it at 4779, not 8192, under kernels with Embree's arithmetic.
#[test]
fn a_triangle_of_no_area_may_be_hit_or_missed_near_its_segment() {
    let segment = mesh(vec![[1.8e-4; 3], [2.4e-12, 6e-33, 8192.0]], vec![[1, 0, 0]]);
    let rays: Vec<Ray> = (0..8)
        .map(|i| {
            let dir = Vec3::new(1.0 + i as f32, 3.0 - i as f32, 0.5 * i as f32 - 1.7);
            let org = Vec3::new(9e-5, 9e-5, 4096.0) - 8192.0 * dir;
            ray(org.to_array(), dir.to_array())
        })
        .collect();
    let missed = vec![Hit::MISS; rays.len()];
    let at = |t: f32| vec![Hit { t, u: 0.0, v: 0.0, prim: 0 }; rays.len()];
    for (t, edge, near_misses) in [(8192.0, rays.len(), 0), (4778.7, 0, rays.len())] {
        for (a, b) in [(&at(t), &missed), (&missed, &at(t))] {
            let verdict = compare_closest(&segment, &rays, a, b);
            assert_eq!(
                (verdict.edge, verdict.near_misses, verdict.is_ok()),
                (edge, near_misses, true),
                "{verdict}"
            );
        }
    }
    // Across ray and segment, by a hundredth of its length.
    let aside = |ray: &Ray| Ray { org: ray.org + 82.0 * ray.dir.cross(Vec3::Z).normalize(), ..*ray };
    let beside: Vec<Ray> = rays.iter().map(aside).collect();
    for t in [8192.0, 4778.7] {
        let verdict = compare_closest(&segment, &beside, &missed, &at(t));
        assert_eq!(verdict.mismatched, rays.len(), "{verdict}");
    }

    let tree = median_tree::<4>(&segment, 4);
    let brute = BruteForce(&segment);
    let (reference, occluded) = (closest(&brute, &rays), any(&brute, &rays));
    for isa in Isa::available() {
        let tracer = BvhTracer::with_isa(&tree, isa);
        let hits = closest(&tracer, &rays);
        let verdict = compare_closest(&segment, &rays, &reference, &hits);
        assert!(verdict.is_ok(), "{isa}: {verdict}");
        let shadows = any(&tracer, &rays);
        let verdict = compare_any(&segment, &rays, &occluded, &shadows, witness(&[&brute, &tracer]));
        assert!(verdict.is_ok(), "{isa}: {verdict}");
    }
}

/// Corners in a line, exactly or but for the rounding of edges, and a ray that meets the line beyond its ends: there
/// kernels compare rounding errors, and hit. Another triangle widens the box, or the ray would not come that far.
#[test]
fn beyond_the_ends_of_a_needle_a_kernel_may_hit() {
    let [a, b] = [4097.0 / 4096.0, 5003.0 / 4096.0];
    let fused = [[0.0; 3], [-a, -a, 0.0], [b, b, 0.0]];
    let rounded = [[0.0, 2f32.powi(-23), 2f32.powi(-22)], [4.0; 3], [-2.0; 3]];
    let far = mesh(vec![[100.0; 3], [101.0, 100.0, 100.0], [100.0, 101.0, 100.0]], vec![[0, 1, 2]]);
    for (corners, passing, t, needs_fused) in [
        (fused, ray([4.0, 4.0, 2.0], [0.0, 0.0, -1.0]), 2.0, true),
        (rounded, ray([64.0, 72.0, 56.0], [0.0, -1.0, 1.0]), 8.0, false),
    ] {
        let needle = joined(&mesh(corners.to_vec(), vec![[0, 1, 2]]), &far);
        let hit = Hit { t, u: 0.0, v: 0.0, prim: 0 };
        let verdict = compare_closest(&needle, &[passing], &[Hit::MISS], &[hit]);
        assert_eq!((verdict.near_misses, verdict.is_ok()), (1, true), "{verdict}");
        let aside = Ray { org: passing.org + Vec3::X, ..passing };
        let verdict = compare_closest(&needle, &[aside], &[Hit::MISS], &[hit]);
        assert_eq!(verdict.mismatched, 1, "{verdict}");

        let tree = median_tree::<4>(&needle, 4);
        let brute = BruteForce(&needle);
        let reference = closest(&brute, &[passing]);
        assert_eq!(reference, [Hit::MISS]);
        for isa in Isa::available() {
            let tracer = BvhTracer::with_isa(&tree, isa);
            let hits = closest(&tracer, &[passing]);
            assert!(hits[0].is_hit() || needs_fused, "{isa}");
            let verdict = compare_closest(&needle, &[passing], &reference, &hits);
            assert_eq!(verdict.near_misses, usize::from(hits[0].is_hit()), "{isa}: {verdict}");
            assert!(verdict.is_ok(), "{isa}: {verdict}");
            let (occluded, shadows) = (any(&brute, &[passing]), any(&tracer, &[passing]));
            let verdict = compare_any(&needle, &[passing], &occluded, &shadows, witness(&[&brute, &tracer]));
            assert!(verdict.is_ok(), "{isa}: {verdict}");
        }
    }
}

/// The distance of a hit without area may be anything, but what lies certainly before it is not to be missed.
#[test]
fn a_hit_without_area_excuses_no_lost_one_before_it() {
    let segment = mesh(vec![[0.25, -1.75, -3.0], [0.25, -1.75, -5.0]], vec![[0, 1, 1]]);
    let both = joined(&one_triangle(), &segment);
    // Through the triangle at 1 and the segment at 5.
    let ray = ray([0.25, 0.75, 1.0], [0.0, -0.5, -1.0]);
    let near = Hit { t: 1.0, u: 0.25, v: 0.25, prim: 0 };
    for t in [3.0, 5.0] {
        let verdict = compare_closest(&both, &[ray], &[near], &[Hit { t, prim: 1, ..near }]);
        assert_eq!(verdict.mismatched, 1, "{verdict}");
    }
    let before = Hit { t: 0.5, prim: 1, ..near };
    let verdict = compare_closest(&both, &[ray], &[near], &[before]);
    assert_eq!((verdict.near_misses, verdict.is_ok()), (1, true), "{verdict}");
}

#[test]
fn verdicts_add_up() {
    let mesh = one_triangle();
    let down = ray([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
    let hit = Hit { t: 1.0, u: 0.25, v: 0.25, prim: 0 };
    let good = compare_closest(&mesh, &[down; 3], &[hit; 3], &[hit; 3]);
    let bad = compare_closest(&mesh, &[down], &[hit], &[Hit::MISS]);
    let both = good.and(&bad);
    assert_eq!((both.rays, both.equal, both.mismatched, both.mismatches[0].ray), (4, 3, 1, 3));
}

#[test]
fn hashes_forgive_last_bits_but_not_more() {
    let hits: Vec<Hit> = (1..1000).map(|i| Hit { t: i as f32 * 0.37, ..Hit::MISS }).collect();
    let hits: Vec<Hit> = hits.iter().map(|hit| Hit { prim: 1, ..*hit }).collect();
    let changed = |i: usize, t: f32| {
        let mut hits = hits.clone();
        hits[i].t = t;
        hit_hash(&hits)
    };
    let hash = hit_hash(&hits);
    let forgiven = (0..999).filter(|&i| changed(i, hits[i].t.next_up()) == hash).count();
    assert!(forgiven > 990, "{forgiven}");
    assert!((0..999).all(|i| changed(i, hits[i].t * 1.001) != hash));
    let mut swapped = hits.clone();
    swapped.swap(3, 4);
    assert_ne!(hit_hash(&swapped), hash);
    assert_ne!(hit_hash(&hits[1..]), hash);
}

/// From some 1e13 on the products of the test overflow: hits are lost, nearly alike in all trees.
#[test]
fn scenes_too_large_for_the_test_are_not_called_wrong() {
    let small = soup(400, 3);
    for scale in [1e6f32, 1e12, 1e13, 1e14, 1e15, 1e16] {
        let vertices = small.vertices().iter().map(|v| v.map(|x| x * scale)).collect();
        let mesh = phr::geometry::Mesh::new(vertices, small.triangles().to_vec()).unwrap().0;
        let rays: Vec<Ray> = rays(&small, 2000, 4)
            .into_iter()
            .map(|ray| Ray {
                org: ray.org * scale,
                dir: ray.dir.normalize(),
                tnear: ray.tnear * scale,
                ..ray
            })
            .map(|ray| Ray { tfar: f32::INFINITY, ..ray })
            .collect();
        let (four, eight) = (median_tree::<4>(&mesh, 4), median_tree::<8>(&mesh, 4));
        let (four, eight) = (BvhTracer::new(&four), BvhTracer::new(&eight));
        let (a, b) = (closest(&four, &rays), closest(&eight, &rays));
        let verdict = compare_closest(&mesh, &rays, &a, &b);
        assert!(verdict.mismatched * 1000 <= verdict.rays, "{scale:e}: {verdict}");
        assert!(verdict.is_ok() || scale > 1e12, "{scale:e}: {verdict}");
        // As Embree gives them.
        let infinite: Vec<Hit> =
            a.iter().map(|hit| if hit.is_hit() { *hit } else { Hit { prim: 7, ..*hit } }).collect();
        let verdict = compare_closest(&mesh, &rays, &infinite, &infinite);
        assert_eq!(verdict.equal, rays.len(), "{scale:e}: {verdict}");
    }
}
