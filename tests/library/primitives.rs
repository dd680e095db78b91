//! Trees over boxes of anything: whole trees, the hits of brute force, bad boxes.

use glam::{DVec3, Vec3, Vec3A};
use phr::builders::{Boxes, BoxesError, NAMES, over_boxes};
use phr::bvh::{Child, IdBlock, LeafBlock as _, Link, WideBvh};
use phr::geometry::{Aabb, Ray};
use phr::query::BvhError;
use phr::random::SplitMix64;
use phr::trace::{Isa, ProvenTree};
use phr::{BvhConfig, PrimitiveBvh, Primitives};
use std::panic::{RefUnwindSafe, UnwindSafe};
use std::sync::Arc;

/// Spheres: centre and radius. Boxes are a little larger, as the test is rounded.
struct Spheres(Vec<(Vec3, f32)>);

impl Spheres {
    fn random(count: usize, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let mut sphere = || {
            let centre = random.point(0.0, 1.0);
            (centre, 0.002 + 0.05 * random.unit().powi(3))
        };
        Self((0..count).map(|_| sphere()).collect())
    }

    /// Where a ray enters a sphere, or leaves it from inside.
    fn hit(&self, id: u32, ray: &Ray) -> Option<f32> {
        let (centre, radius) = self.0[id as usize];
        let (to, dir) = ((ray.org - centre).as_dvec3(), ray.dir.as_dvec3());
        let (a, b, c) = (dir.length_squared(), to.dot(dir), to.length_squared() - f64::from(radius).powi(2));
        let root = (b * b - a * c).sqrt();
        let mut distances = [(-b - root) / a, (-b + root) / a].into_iter().map(|t| t as f32);
        distances.find(|&t| ray.tnear < t && t <= ray.tfar)
    }
}

impl Primitives for Spheres {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, id: u32) -> Aabb {
        let (centre, radius) = self.0[id as usize];
        let (centre, radius) = (Vec3A::from(centre), Vec3A::splat(radius * 1.001 + 1e-6));
        Aabb::new(centre - radius, centre + radius)
    }
}

fn rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut random = SplitMix64::new(seed);
    let mut point = |low, high| random.point(low, high);
    let ray = |(i, [org, dir]): (usize, [Vec3; 2])| Ray {
        org,
        tnear: if i % 3 == 0 { 0.05 } else { 0.0 },
        dir,
        tfar: if i % 5 == 0 { 0.4 } else { f32::INFINITY },
    };
    (0..count).map(|_| [point(-0.2, 1.2), point(-1.0, 1.0)]).enumerate().map(ray).collect()
}

/// The closest distance by trying all.
fn brute_force(count: usize, ray: &Ray, hit: impl Fn(u32, &Ray) -> Option<f32>) -> Option<f32> {
    (0..count as u32).filter_map(|id| hit(id, ray)).min_by(f32::total_cmp)
}

fn agree(a: Option<f32>, b: Option<f32>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-5 * a.abs().max(b.abs()),
        (a, b) => a == b,
    }
}

/// Checks that boxes nest; returns each primitive with the box of its leaf.
fn leaves<const N: usize>(tree: &WideBvh<N, IdBlock>) -> Vec<(u32, Aabb)> {
    let (mut found, mut pending) = (Vec::new(), vec![(tree.root, tree.bounds)]);
    while let Some((link, bounds)) = pending.pop() {
        match link.get() {
            Child::Empty => assert_eq!(link, Link::EMPTY),
            Child::Inner(index) => {
                for (child, link) in tree.nodes[index].children() {
                    assert!(bounds.contains(child) && !child.is_empty());
                    pending.push((link, child));
                }
            }
            Child::Leaf { first, count } => {
                let blocks = &tree.blocks[first..first + count];
                assert!(blocks.iter().all(|block| block.ids().next().is_some()), "an empty block");
                blocks.iter().for_each(|block| found.extend(block.ids().map(|id| (id, bounds))));
            }
        }
    }
    found
}

fn check_whole<const N: usize>(name: &str, boxes: &[Aabb]) {
    let built = Boxes::new(boxes.to_vec()).unwrap();
    let tree = over_boxes::<N>(name).unwrap().build(&built).tree;
    assert_eq!(tree.validate_links(boxes.len()), Ok(()), "{name}/{N}");
    let mut leaves = leaves(&tree);
    assert!(leaves.iter().all(|&(id, bounds)| bounds.contains(boxes[id as usize])), "{name}/{N}");
    leaves.sort_by_key(|&(id, _)| id);
    assert!(leaves.iter().map(|&(id, _)| id).eq(0..boxes.len() as u32), "{name}/{N}: each is in one leaf");
}

#[test]
fn trees_over_boxes_are_whole_with_every_builder() {
    let spheres = Spheres::random(10_000, 1);
    let random: Vec<Aabb> = (0..10_000).map(|id| spheres.bounds(id)).collect();
    let unit = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
    let point = |x: f32| Aabb::new(Vec3A::splat(x), Vec3A::splat(x));
    let sets: [Vec<Aabb>; 6] = [
        vec![],
        vec![unit],
        vec![unit; 1000],
        (0..1000).map(|i| point(i as f32)).collect(),
        (0..200).map(|i| Aabb::new(Vec3A::ZERO, Vec3A::splat(1.2f32.powi(i)))).collect(),
        random,
    ];
    for name in NAMES {
        for boxes in &sets {
            check_whole::<4>(name, boxes);
            check_whole::<8>(name, boxes);
        }
    }
    if cfg!(feature = "serde") {
        check_whole::<8>("phr-hq[delta=8]", &sets[5]);
    }
}

#[test]
fn spheres_are_hit_as_by_brute_force() {
    let spheres = Spheres::random(3000, 2);
    let rays = rays(600, 3);
    let expected: Vec<Option<f32>> =
        rays.iter().map(|ray| brute_force(spheres.len(), ray, |id, ray| spheres.hit(id, ray))).collect();
    let hit = expected.iter().flatten().count();
    assert!((100..550).contains(&hit), "{hit} hits");
    for name in NAMES {
        for width in [4, 8] {
            let bvh = PrimitiveBvh::build(&spheres, &BvhConfig { builder: name, width }).unwrap();
            for (ray, &expected) in rays.iter().zip(&expected) {
                let found = bvh.intersect_with(ray, |id, ray| spheres.hit(id, ray));
                assert!(
                    agree(found.map(|hit| hit.t), expected),
                    "{name}/{width}: {ray:?} {found:?} {expected:?}"
                );
                if let Some(found) = found {
                    assert_eq!(spheres.hit(found.id, ray), Some(found.t));
                }
                let occluded = bvh.occluded_with(ray, |id, ray| spheres.hit(id, ray).is_some());
                assert_eq!(occluded, expected.is_some(), "{name}/{width}: {ray:?}");
            }
        }
    }
}

#[test]
fn all_instructions_and_any_number_of_threads_give_the_same() {
    let spheres = Spheres::random(20_000, 4);
    let boxes = Boxes::of(&spheres).unwrap();
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| over_boxes::<8>("phr-speed").unwrap().build(&boxes).tree)
    };
    let tree = build(1);
    assert!([2, 8].iter().all(|&threads| build(threads) == tree));
    let tree = ProvenTree::new(tree).unwrap();
    for ray in &rays(2000, 5) {
        let by = |isa| {
            let hit = tree.closest_with(isa, ray, |id, ray| spheres.hit(id, ray));
            (hit.is_hit().then_some(hit.t), tree.any_with(isa, ray, |id, ray| spheres.hit(id, ray).is_some()))
        };
        let (expected, occluded) = by(Isa::Scalar);
        assert_eq!(occluded, expected.is_some());
        for isa in Isa::available() {
            assert!(agree(by(isa).0, expected) && by(isa).1 == occluded, "{isa}: {ray:?}");
        }
    }
}

/// Thin triangles that are split.
struct Blades(Vec<[DVec3; 3]>);

impl Blades {
    fn hit(&self, id: u32, ray: &Ray) -> Option<f32> {
        let [a, b, c] = self.0[id as usize];
        let (org, dir, e1, e2) = (ray.org.as_dvec3(), ray.dir.as_dvec3(), b - a, c - a);
        let p = dir.cross(e2);
        let (det, to) = (e1.dot(p), org - a);
        let q = to.cross(e1);
        let (u, v, t) = (to.dot(p) / det, dir.dot(q) / det, (e2.dot(q) / det) as f32);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ray.tnear < t && t <= ray.tfar).then_some(t)
    }
}

impl Primitives for Blades {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, id: u32) -> Aabb {
        self.0[id as usize].iter().fold(Aabb::EMPTY, |all, corner| grown(all, *corner))
    }

    fn splits(&self) -> bool {
        true
    }

    fn split(&self, id: u32, part: Aabb, axis: usize, position: f32) -> [Aabb; 2] {
        let (corners, plane) = (self.0[id as usize], f64::from(position));
        let mut sides = [Aabb::EMPTY; 2];
        for (i, a) in corners.into_iter().enumerate() {
            let b = corners[(i + 1) % 3];
            for (side, is_there) in sides.iter_mut().zip([a[axis] <= plane, a[axis] >= plane]) {
                *side = if is_there { grown(*side, a) } else { *side };
            }
            if (a[axis] < plane) != (b[axis] < plane) {
                let crossing = a + (b - a) * ((plane - a[axis]) / (b[axis] - a[axis]));
                sides = sides.map(|side| grown(side, crossing));
            }
        }
        sides.map(|side| side.intersection(part))
    }
}

/// A box with a point more, and a little slack for rounding.
fn grown(bounds: Aabb, point: DVec3) -> Aabb {
    bounds.grow(point.as_vec3a() - 1e-6).grow(point.as_vec3a() + 1e-6)
}

#[test]
fn what_can_be_split_is_and_is_hit_as_by_brute_force() {
    let mut random = SplitMix64::new(6);
    let blades = Blades(
        (0..1500)
            .map(|_| {
                let mut point = |scale| random.point(0.0, scale).as_dvec3();
                let (a, b) = (point(1.0), point(1.0));
                [a, b, a + point(0.02)]
            })
            .collect(),
    );
    let rays = rays(500, 7);
    for name in ["phr-speed", "phr-hq", "phr-quality", "phr-best"] {
        let boxes = Boxes::of(&blades).unwrap();
        let tree = over_boxes::<4>(name).unwrap().build(&boxes).tree;
        assert_eq!(tree.validate_links(blades.len()), Ok(()));
        let references = leaves(&tree).len();
        // Those of the paper cut boxes at the plane, not primitives, and split fewer.
        let clips = matches!(name, "phr-quality" | "phr-best");
        let least = if clips { blades.len() / 20 } else { 1 };
        assert!(references >= blades.len() + least, "{name}: {references} references");
        let bvh = PrimitiveBvh::build(&blades, &BvhConfig { builder: name, width: 4 }).unwrap();
        for ray in &rays {
            let expected = brute_force(blades.len(), ray, |id, ray| blades.hit(id, ray));
            let found = bvh.intersect_with(ray, |id, ray| blades.hit(id, ray)).map(|hit| hit.t);
            assert!(agree(found, expected), "{name}: {ray:?} {found:?} {expected:?}");
            assert_eq!(bvh.occluded_with(ray, |id, ray| blades.hit(id, ray).is_some()), expected.is_some());
        }
    }
}

#[test]
fn distances_out_of_the_interval_are_no_hits() {
    // Others far away, so that the tree has a node: of few primitives it is a leaf, and no box is tested.
    let at = |x: f32| Aabb::new(Vec3A::splat(x), Vec3A::splat(x + 1.0));
    let boxes: Vec<Aabb> = (0..40).map(|i| at(100.0 * i as f32)).collect();
    let first = |t: f32| move |id: u32, _: &Ray| (id == 0).then_some(t);
    let ray = Ray { org: Vec3::new(-1.0, 0.5, 0.5), tnear: 1.0, dir: Vec3::X, tfar: 4.0 };
    for width in [4, 8] {
        let bvh = PrimitiveBvh::build(&boxes, &BvhConfig { width, ..BvhConfig::default() }).unwrap();
        // No box is there.
        assert_eq!(bvh.intersect_with(&Ray { org: Vec3::splat(-50.0), ..ray }, |_, _| Some(2.0)), None);
        assert_eq!(bvh.intersect_with(&ray, first(2.0)).map(|hit| (hit.id, hit.t)), Some((0, 2.0)));
        for t in [f32::NAN, -1.0, 0.0, 1.0, 4.5, f32::INFINITY] {
            assert_eq!(bvh.intersect_with(&ray, first(t)), None, "{t}");
        }
        assert!(bvh.occluded_with(&ray, |_, _| true) && !bvh.occluded_with(&ray, |_, _| false));
        let none = Ray { org: Vec3::splat(0.5), dir: Vec3::ZERO, ..ray };
        for bad in
            [none, Ray { dir: Vec3::NAN, ..ray }, Ray { tnear: -1.0, ..ray }, Ray { tfar: f32::NAN, ..ray }]
        {
            assert_eq!(bvh.intersect_with(&bad, |_, _| Some(2.0)), None);
            assert!(!bvh.occluded_with(&bad, |_, _| true));
        }
    }
}

#[test]
fn references_to_primitives_are_primitives() {
    let spheres = Spheres::random(500, 9);
    let boxes: Vec<Aabb> = (0..500).map(|id| spheres.bounds(id)).collect();
    let blades = || Blades(vec![[DVec3::ZERO, DVec3::ONE, DVec3::new(0.5, 0.4, 0.3)]; 20]);
    fn tree(primitives: &(impl Primitives + ?Sized)) -> Option<WideBvh<8, IdBlock>> {
        let mut bvh = PrimitiveBvh::build(primitives, &BvhConfig::new("phr-quality", 8)).unwrap();
        let built = bvh.as_bvh8().cloned();
        bvh.rebuild(primitives).unwrap();
        assert_eq!(bvh.as_bvh8().cloned(), built);
        built
    }
    let expected = tree(&spheres);
    assert_eq!(
        (tree(&boxes), tree(&boxes[..]), tree(&&boxes[..])),
        (expected.clone(), expected.clone(), expected)
    );

    let (boxed, shared): (Box<dyn Primitives>, Arc<dyn Primitives + Send>) =
        (Box::new(blades()), Arc::new(blades()));
    assert!(boxed.splits() && shared.splits() && !boxed.is_empty());
    let expected = tree(&blades());
    assert_eq!((tree(&boxed), tree(&*boxed), tree(&shared)), (expected.clone(), expected.clone(), expected));
}

#[test]
fn trees_are_built_anew_in_their_memory() {
    let mut spheres = Spheres::random(5000, 8);
    let mut bvh = PrimitiveBvh::build(&spheres, &BvhConfig { builder: "phr-turbo", width: 8 }).unwrap();
    for frame in 0..4u64 {
        spheres = Spheres::random(if frame == 2 { 0 } else { 4000 + 500 * frame as usize }, frame);
        bvh.rebuild(&spheres).unwrap();
        let fresh = PrimitiveBvh::build(&spheres, &BvhConfig { builder: "phr-turbo", width: 8 }).unwrap();
        assert_eq!(bvh.as_bvh8(), fresh.as_bvh8());
    }
    let before = bvh.as_bvh8().cloned();
    spheres.0[17].1 = f32::NAN;
    let error = bvh.rebuild(&spheres).unwrap_err();
    assert!(matches!(error, BvhError::Boxes(BoxesError::Invalid { id: 17, .. })), "{error}");
    assert_eq!(bvh.as_bvh8().cloned(), before);
}

#[test]
fn what_cannot_be_built_is_refused_in_one_line() {
    let unit = vec![Aabb::new(Vec3A::ZERO, Vec3A::ONE)];
    let refused = |builder, width| PrimitiveBvh::build(&unit, &BvhConfig { builder, width }).unwrap_err();
    assert!(refused("nobody", 8).to_string().starts_with("no builder is called nobody"));
    assert_eq!(refused("lbvh", 6), BvhError::NoSuchWidth(6));
    #[cfg(feature = "serde")]
    for (name, what) in [("phr-hq[delta=1e99]", "delta"), ("phr-hq[width=8]", "width")] {
        let told = refused(name, 8).to_string();
        assert!(told.contains(what) && !told.contains("no builder is called"), "{told}");
    }
    #[cfg(not(feature = "serde"))]
    for name in ["phr-hq[delta=8]", "phr-hq-clip[delta=8]"] {
        let told = refused(name, 8);
        assert!(matches!(&told, BvhError::Changes(line) if line.contains("feature `serde`")), "{told}");
        assert!(told.to_string().starts_with(name) && !told.to_string().contains('\n'), "{told}");
    }
    assert!(matches!(refused("nobody[delta=8]", 8), BvhError::NoSuchBuilder(_)));
    let nothing = PrimitiveBvh::build(&Vec::<Aabb>::new(), &BvhConfig::default()).unwrap();
    assert!(nothing.bounds().is_empty() && nothing.as_bvh4().is_none());
    assert_eq!(nothing.intersect_with(&rays(1, 1)[0], |_, _| Some(1.0)), None);
}

#[test]
fn trees_are_shared_among_threads() {
    fn shared<T: Send + Sync + UnwindSafe + RefUnwindSafe + 'static>() {}
    shared::<PrimitiveBvh>();
}
