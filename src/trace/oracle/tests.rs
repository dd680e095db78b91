use super::*;

fn mesh() -> Mesh {
    let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    Mesh::new(vertices, vec![[0, 1, 2], [0, 1, 1]]).unwrap().0
}

fn down(x: f32, y: f32) -> Ray {
    Ray { org: Vec3::new(x, y, 2.0), tnear: 0.0, dir: Vec3::NEG_Z, tfar: f32::INFINITY }
}

fn of(mesh: &Mesh, prim: u32, ray: &Ray) -> Option<Crossing> {
    Crossing::new(mesh, prim, ray, Model::RoundedCoordinates)
}

/// With the errors on thin triangles allowed for.
fn thin(mesh: &Mesh, prim: u32, ray: &Ray) -> Crossing {
    Crossing::new(mesh, prim, ray, Model::ThinTriangles).unwrap()
}

/// A thousand long and a hundred thousandth wide; the ray goes through its middle.
#[test]
fn a_thin_triangle_has_no_wider_band_than_another() {
    let at = |x: f32| [1000.0 * x, 1000.0 * x, 0.0];
    let vertices = vec![at(0.0), at(1.0), [500.0, 500.02, 0.0]];
    let thin = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap().0;
    let down = down(500.0, 500.007);
    let exact = of(&thin, 0, &down).unwrap();
    assert!((exact.inside - 0.005).abs() < 1e-4 && exact.slack < 1e-3, "{exact:?}");
    assert!(exact.is_certain());
    assert!((exact.t - 2.0).abs() < 1e-12);
    let single = Crossing::new(&thin, 0, &down, Model::ThinTriangles).unwrap();
    assert!(!single.is_certain() && single.slack > exact.slack && single.inside == exact.inside);
}

#[test]
fn distances_from_the_border() {
    let mesh = mesh();
    let crossing = |x, y| of(&mesh, 0, &down(x, y)).unwrap();
    assert!((crossing(0.25, 0.5).inside - 0.25f64 * 0.5f64.sqrt()).abs() < 1e-12);
    assert!((crossing(0.1, 0.5).inside - 0.1).abs() < 1e-6);
    assert!((crossing(-3.0, -4.0).inside + 5.0).abs() < 1e-12);
    assert_eq!(crossing(0.25, 0.25).t, 2.0);
}

#[test]
fn verdicts_on_a_face_an_edge_and_beside() {
    let mesh = mesh();
    let judge = |ray: Ray| {
        let crossing = of(&mesh, 0, &ray).unwrap();
        (crossing.is_possible(), crossing.is_certain())
    };
    assert_eq!(judge(down(0.25, 0.25)), (true, true));
    assert_eq!(judge(down(0.5, 0.5)), (true, false));
    assert_eq!(judge(down(-1e-7, 0.5)), (true, false));
    assert_eq!(judge(down(-1e-3, 0.5)), (false, false));
    assert_eq!(judge(Ray { tfar: 2.0, ..down(0.25, 0.25) }), (true, false));
    assert_eq!(judge(Ray { tfar: 1.9, ..down(0.25, 0.25) }), (false, false));
    assert_eq!(judge(Ray { tnear: 2.1, ..down(0.25, 0.25) }), (false, false));
    let beside = Ray { dir: Vec3::X, ..down(0.25, 0.25) };
    assert_eq!(judge(beside), (true, false), "parallel rays are never certain");
    assert!(!of(&mesh, 1, &down(0.25, 0.25)).unwrap().is_possible());
    assert!(of(&mesh, 2, &down(0.25, 0.25)).is_none());
    assert!(of(&mesh, 0, &Ray { dir: Vec3::ZERO, ..down(0.0, 0.0) }).is_none());
}

/// Along z, 8192 long, two equal corners: what a fuzzer found.
fn segment() -> Mesh {
    let vertices = vec![[1.8e-4; 3], [2.4e-12, 6e-33, 8192.0]];
    Mesh::new(vertices, vec![[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0], [1, 1, 1]]).unwrap().0
}

/// Meets the middle of [`segment`] at a parameter of 8192.
fn through_its_middle() -> Ray {
    let (middle, dir) = (Vec3::new(9e-5, 9e-5, 4096.0), Vec3::new(2.0, 2.0, -1.2));
    Ray { org: middle - 8192.0 * dir, tnear: 0.0, dir, tfar: f32::INFINITY }
}

#[test]
fn without_area_a_hit_on_the_segment_is_possible_and_none_is_certain() {
    let (mesh, ray) = (segment(), through_its_middle());
    for prim in 0..3 {
        let exact = of(&mesh, prim, &ray).unwrap();
        assert!(exact.allows(8192.0) && !exact.allows(4778.7) && !exact.is_certain(), "{exact:?}");
        // The kernel's answer, 4778.7: a distance that is rounding error alone.
        let single = thin(&mesh, prim, &ray);
        assert!(single.allows(8192.0) && single.allows(4778.7) && !single.is_certain(), "{single:?}");
        // As for an edge: less than a millionth of the coordinates.
        assert!(exact.slack < 0.05 && single.slack < 0.1, "{exact:?} {single:?}");
    }
    // Another corner between, all three in a line, exactly.
    let line = vec![[0.0; 3], [1.0, 2.0, 3.0], [3.0, 6.0, 9.0]];
    let line = Mesh::new(line, vec![[0, 1, 2], [1, 2, 0], [2, 0, 1]]).unwrap().0;
    for prim in 0..3 {
        let at = |z: f32| Ray { org: Vec3::new(z / 3.0, 0.0, z), dir: Vec3::Y, ..ray };
        let judge = |z| of(&line, prim, &at(z)).unwrap().is_possible();
        assert_eq!([-0.1, 0.0, 1.5, 6.0, 9.0, 9.1].map(judge), [false, true, true, true, true, false]);
    }
}

#[test]
fn without_area_a_hit_beside_the_segment_is_impossible() {
    let (mesh, ray) = (segment(), through_its_middle());
    // Across ray and segment.
    let aside = |by: f32| Ray { org: ray.org + by * Vec3::new(0.5, -0.5, 0.0).normalize(), ..ray };
    for model in [Model::RoundedCoordinates, Model::ThinTriangles] {
        for prim in 0..3 {
            let is_possible = |ray: &Ray| Crossing::new(&mesh, prim, ray, model).unwrap().is_possible();
            assert!(is_possible(&aside(0.001)) && ![aside(82.0), aside(-82.0)].iter().any(is_possible));
        }
    }
    // Beyond an end of the segment, or of the interval, of which the kernel's arithmetic knows nothing.
    let beyond = Ray { org: ray.org + Vec3::new(0.0, 0.0, 4096.0 + 82.0), ..ray };
    let [before, behind] = [Ray { tfar: 8100.0, ..ray }, Ray { tnear: 8300.0, ..ray }];
    for ray in [beyond, before, behind] {
        assert!(!of(&mesh, 0, &ray).unwrap().is_possible() && thin(&mesh, 0, &ray).is_possible());
    }
    let along = Ray { org: Vec3::new(9e-5, 9e-5, -100.0), dir: Vec3::Z, ..ray };
    assert!(of(&mesh, 0, &along).is_some_and(|along| along.is_possible() && !along.is_certain()));
}

#[test]
fn a_point_is_met_within_rounding_of_it() {
    let mesh = segment();
    let [x, y, z] = mesh.vertices()[1];
    let at = |by: f32| Ray { org: Vec3::new(x + by, y, z + 100.0), ..down(0.0, 0.0) };
    for model in [Model::RoundedCoordinates, Model::ThinTriangles] {
        let crossing = |by: f32| Crossing::new(&mesh, 4, &at(by), model).unwrap();
        let met = crossing(0.0);
        assert!(met.allows(100.0) && !met.is_certain() && !crossing(1.0).is_possible());
        assert!(!Crossing::new(&mesh, 3, &at(0.0), model).unwrap().is_certain());
    }
}

/// Corners in a line, and a ray onto that line: with fused multiplication the determinant is the error of 4097 x 5003,
/// what is compared with it zero, and kernels hit at 2, beyond the ends as well.
#[test]
fn beyond_the_ends_a_hit_is_the_error_of_single_precision() {
    let [a, b] = [4097.0 / 4096.0, 5003.0 / 4096.0];
    let line = Mesh::new(vec![[0.0; 3], [-a, -a, 0.0], [b, b, 0.0]], vec![[0, 1, 2]]).unwrap().0;
    for x in [-1.0, 0.0, 0.5, 1.2] {
        let (exact, single) = (of(&line, 0, &down(x, x)).unwrap(), thin(&line, 0, &down(x, x)));
        assert!(exact.allows(2.0) && !exact.allows(1.0) && !exact.is_certain(), "{exact:?}");
        assert!(single.allows(2.0) && single.allows(1.0) && !single.is_certain(), "{single:?}");
    }
    for x in [-1.1, 1.3, 4.0, 1000.0] {
        let (exact, single) = (of(&line, 0, &down(x, x)).unwrap(), thin(&line, 0, &down(x, x)));
        assert!(!exact.is_possible(), "{exact:?}");
        assert!(single.allows(2.0) && !single.is_certain(), "{single:?}");
        assert!(!thin(&line, 0, &down(x, 1.001 * x)).is_possible(), "beside the line");
    }
}

/// Nearly in a line: the first corner is beside that of the others by less than edges of their length can tell. A ray
/// meets the line 104 beyond the end; kernels hit at 8, without fused multiplication too.
#[test]
fn a_triangle_thinner_than_its_edges_are_exact_is_a_line() {
    let needle = |y: f32, z: f32| {
        let vertices = vec![[0.0, y, z], [4.0; 3], [-2.0; 3]];
        Mesh::new(vertices, vec![[0, 1, 2]]).unwrap().0
    };
    let at = |x: f32, aside: f32| Ray {
        org: Vec3::new(x + aside, x + 8.0, x - 8.0),
        dir: Vec3::new(0.0, -1.0, 1.0),
        ..down(0.0, 0.0)
    };
    let lost = needle(2f32.powi(-23), 2f32.powi(-22));
    let (exact, single) = (of(&lost, 0, &at(1.0, 0.0)).unwrap(), thin(&lost, 0, &at(1.0, 0.0)));
    assert!(exact.allows(8.0) && single.allows(8.0) && !single.is_certain(), "{exact:?} {single:?}");
    let (exact, single) = (of(&lost, 0, &at(64.0, 0.0)).unwrap(), thin(&lost, 0, &at(64.0, 0.0)));
    assert!(!exact.is_possible() && single.allows(8.0) && single.allows(9.0), "{exact:?} {single:?}");
    // Not beside the line, however thin.
    assert!(!thin(&lost, 0, &at(1.0, 0.01)).is_possible() && !thin(&lost, 0, &at(64.0, 10.0)).is_possible());
    // A thousandth wide, it has ends.
    let wide = needle(1e-3, 0.0);
    assert!(thin(&wide, 0, &at(1.0, 0.0)).allows(8.0) && !thin(&wide, 0, &at(64.0, 0.0)).is_possible());
}
