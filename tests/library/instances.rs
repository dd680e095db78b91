//! Two levels: the hits of the same triangles in one mesh, and of Embree's instances; transforms that are refused.

use glam::{Affine3A, Mat3A, Quat, Vec3, Vec3A};
use phr::geometry::{Mesh, Ray};
use phr::query::{BvhError, InstanceHit};
use phr::random::SplitMix64;
use phr::scene::scalable;
use phr::{Bvh, BvhConfig, Instance, InstanceBvh};
use std::sync::Arc;

const OBJECTS: [usize; 3] = [1, 300, 2000];
const COUNT: usize = 150;

fn objects() -> Vec<Mesh> {
    OBJECTS.iter().zip(1..).map(|(&n, seed)| centred(&scalable(n, seed).mesh)).collect()
}

/// A mesh about the origin, of extent 1.
fn centred(mesh: &Mesh) -> Mesh {
    let (bounds, scale) = (mesh.bounds(), 1.0 / mesh.bounds().extent().max_element());
    moved(
        mesh,
        &(Affine3A::from_scale(Vec3::splat(scale)) * Affine3A::from_translation((-bounds.center()).into())),
    )
}

fn moved(mesh: &Mesh, transform: &Affine3A) -> Mesh {
    let vertex = |v: &[f32; 3]| transform.transform_point3a(Vec3A::from_array(*v)).to_array();
    Mesh::new(mesh.vertices().iter().map(vertex).collect(), mesh.triangles().to_vec()).unwrap().0
}

/// Where instances are: turned, scaled, some mirrored, some sheared; they overlap.
fn transforms() -> Vec<Affine3A> {
    let mut random = SplitMix64::new(5);
    (0..COUNT)
        .map(|i| {
            let mut point = |low, high| random.point(low, high);
            let rotation = Quat::from_scaled_axis(point(-3.0, 3.0));
            let mut scale = point(0.3, 1.0);
            scale.x *= if i % 4 == 0 { -1.0 } else { 1.0 };
            let mut transform = Affine3A::from_scale_rotation_translation(scale, rotation, point(-3.0, 3.0));
            if i % 3 == 0 {
                let shear = Mat3A::from_cols(Vec3A::X, Vec3A::new(0.7, 1.0, 0.0), Vec3A::new(0.0, -0.4, 1.0));
                transform.matrix3 *= shear;
            }
            transform
        })
        .collect()
}

fn rays(count: usize) -> Vec<Ray> {
    let mut random = SplitMix64::new(9);
    let mut point = |scale: f32| random.point(-scale, scale);
    (0..count)
        .map(|i| {
            let (org, at) = (point(6.0), point(3.0));
            let tfar = if i % 4 == 0 { 0.8 } else { f32::INFINITY };
            Ray { org, tnear: if i % 5 == 0 { 0.3 } else { 0.0 }, dir: (at - org) * 0.7, tfar }
        })
        .collect()
}

fn instances<B: Clone>(objects: &[B], transforms: &[Affine3A]) -> Vec<Instance<B>> {
    let place =
        |(i, &transform): (usize, &Affine3A)| Instance { bvh: objects[i % objects.len()].clone(), transform };
    transforms.iter().enumerate().map(place).collect()
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-4 * a.abs().max(b.abs())
}

/// The triangles of all instances in one mesh, and the instance and the triangle that each of them is.
fn flattened(meshes: &[Mesh], transforms: &[Affine3A]) -> (Mesh, Vec<(u32, u32)>) {
    let (mut vertices, mut triangles, mut owners) = (Vec::new(), Vec::new(), Vec::new());
    for (i, transform) in transforms.iter().enumerate() {
        let mesh = moved(&meshes[i % meshes.len()], transform);
        let first = vertices.len() as u32;
        triangles.extend(mesh.triangles().iter().map(|triangle| triangle.map(|v| v + first)));
        vertices.extend_from_slice(mesh.vertices());
        owners.extend((0..mesh.len() as u32).map(|prim| (i as u32, prim)));
    }
    let (all, dropped) = Mesh::new(vertices, triangles).unwrap();
    assert_eq!(dropped.total(), 0);
    (all, owners)
}

#[test]
fn instances_are_hit_as_the_same_triangles_in_one_mesh() {
    let (meshes, transforms) = (objects(), transforms());
    let (all, owners) = flattened(&meshes, &transforms);
    for (builder, width) in [("lbvh", 4), ("phr-turbo", 8), ("phr-quality", 4), ("phr-best", 8)] {
        let config = BvhConfig { builder, width };
        let flat = Bvh::build(&all, &config).unwrap();
        let bvhs: Vec<Arc<Bvh>> =
            meshes.iter().map(|mesh| Bvh::build(mesh, &config).unwrap().into()).collect();
        let two = InstanceBvh::build(instances(&bvhs, &transforms), &config).unwrap();
        let slack = two.bounds().extent() - all.bounds().extent();
        assert!(two.bounds().contains(all.bounds()) && slack.max_element() < 1.0);
        let (mut hits, mut differ) = (0, 0);
        for ray in &rays(4000) {
            let (expected, found) = (flat.intersect(ray), two.intersect(ray));
            hits += usize::from(expected.is_some());
            match (expected, found) {
                (None, None) => {}
                (Some(expected), Some(InstanceHit { instance, hit })) if near(expected.t, hit.t) => {
                    if owners[expected.prim as usize] == (instance, hit.prim) {
                        let error = (expected.normal - hit.normal).length() / expected.normal.length();
                        assert!(error < 1e-2, "{expected:?} {hit:?}");
                    }
                }
                _ => differ += 1,
            }
            differ += usize::from(flat.occluded(ray) != two.occluded(ray));
        }
        assert!(hits > 1000 && differ <= 8, "{builder}/{width}: {differ} of {hits} hits differ");
    }
}

/// Half of the triangles of each instance, another half of each.
#[test]
fn what_a_filter_turns_down_is_not_there() {
    let (meshes, transforms) = (objects(), transforms());
    let (all, owners) = flattened(&meshes, &transforms);
    let is_kept = |(instance, prim): (u32, u32)| (prim + instance).is_multiple_of(2);
    let kept: Vec<usize> = (0..owners.len()).filter(|&i| is_kept(owners[i])).collect();
    let rest = kept.iter().map(|&i| all.triangles()[i]).collect();
    let (rest, _) = Mesh::new(all.vertices().to_vec(), rest).unwrap();
    for (builder, width) in [("lbvh", 4), ("phr-quality", 8)] {
        let config = BvhConfig { builder, width };
        let flat = Bvh::build(&rest, &config).unwrap();
        let bvhs: Vec<Bvh> = meshes.iter().map(|mesh| Bvh::build(mesh, &config).unwrap()).collect();
        let world = instances(&bvhs.iter().collect::<Vec<_>>(), &transforms);
        let world = InstanceBvh::build(world, &config).unwrap();
        let (mut hits, mut refused, mut differ) = (0, 0, 0);
        for ray in &rays(4000) {
            let mut accepted = Vec::new();
            let found = world.intersect_filtered(ray, |hit| {
                let accepts = is_kept((hit.instance, hit.hit.prim));
                refused += usize::from(!accepts);
                accepted.extend(Some(*hit).filter(|_| accepts));
                accepts
            });
            assert!(found.is_none_or(|found| accepted.contains(&found)), "{found:?} among {accepted:?}");
            let occluded = world.occluded_filtered(ray, |hit| is_kept((hit.instance, hit.hit.prim)));
            let expected = flat.intersect(ray);
            hits += usize::from(expected.is_some());
            let same = match (expected, found) {
                (None, None) => true,
                (Some(expected), Some(found)) => near(expected.t, found.hit.t),
                _ => false,
            };
            differ += usize::from(!same) + usize::from(occluded != expected.is_some());
            assert_eq!(world.intersect_filtered(ray, |_| true), world.intersect(ray), "{ray:?}");
            assert!(
                !world.occluded_filtered(ray, |_| false)
                    && world.intersect_filtered(ray, |_| false).is_none()
            );
        }
        assert!(hits > 500 && refused > 1000, "{builder}/{width}: {hits} hits, {refused} turned down");
        assert!(differ <= 8, "{builder}/{width}: {differ} of {hits} hits differ");
    }
}

#[cfg(feature = "embree")]
#[test]
fn instances_are_hit_as_embrees() {
    use phr::embree::{Config, Device, EmbreeBuilder, Width};

    let (meshes, transforms) = (objects(), transforms());
    for width in Width::ALL {
        let device = Device::new(&Config { builder: EmbreeBuilder::Sah, width, threads: 1 }).unwrap();
        let scenes: Vec<_> =
            meshes.iter().map(|mesh| device.prepare(mesh).unwrap().commit().unwrap()).collect();
        let placed: Vec<_> = transforms
            .iter()
            .enumerate()
            .map(|(i, &transform)| (&scenes[i % scenes.len()], transform))
            .collect();
        let embree = device.instances(&placed).unwrap();
        let config = BvhConfig { builder: "phr-speed", width: width.lanes() };
        let bvhs: Vec<Bvh> = meshes.iter().map(|mesh| Bvh::build(mesh, &config).unwrap()).collect();
        let two =
            InstanceBvh::build(instances(&bvhs.iter().collect::<Vec<_>>(), &transforms), &config).unwrap();
        let (mut hits, mut same, mut differ) = (0, 0, 0);
        for ray in &rays(20_000) {
            let (expected, found) = (embree.closest(ray), two.intersect(ray));
            hits += usize::from(expected.is_some());
            match (expected, found) {
                (None, None) => {}
                (Some((instance, hit)), Some(found)) if near(hit.t, found.hit.t) => {
                    same += usize::from((instance, hit.prim) == (found.instance, found.hit.prim));
                }
                _ => differ += 1,
            }
            differ += usize::from(embree.any(ray) != two.occluded(ray));
        }
        // At edges rounding decides.
        assert!(hits > 5000 && differ <= 20, "{width:?}: {differ} of {hits} hits differ");
        assert!(same > hits * 99 / 100, "{width:?}: {same} of {hits} hits are of the same triangle");
    }
}

#[cfg(feature = "embree")]
#[test]
fn embree_refuses_scenes_of_another_device() {
    use phr::embree::{Config, Device, EmbreeBuilder, EmbreeError, Width};

    let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 1 };
    let (device, other) = (Device::new(&config).unwrap(), Device::new(&config).unwrap());
    let mesh = &objects()[1];
    let scene = other.prepare(mesh).unwrap().commit().unwrap();
    let refused = device.instances(&[(&scene, Affine3A::IDENTITY)]);
    assert!(matches!(refused, Err(EmbreeError::OtherDevice(0))));
    assert!(device.instances(&[]).unwrap().closest(&rays(1)[0]).is_none());
}

/// A hit may be rounded to where the ray begins: it is none again, and hides nothing.
#[test]
fn rays_go_on_behind_their_hits() {
    let wall = |z: f32| [[-10.0, -10.0, z], [10.0, -10.0, z], [0.0, 20.0, z]];
    let walls = Mesh::new([wall(0.0), wall(-1.0)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap().0;
    let object = Bvh::build(&walls, &BvhConfig::default()).unwrap();
    let world = instances(&[&object], &[Affine3A::IDENTITY]);
    let world = InstanceBvh::build(world, &BvhConfig::default()).unwrap();
    let mut random = SplitMix64::new(1);
    for _ in 0..2000 {
        let p = random.point(-1.0, 1.0);
        let org = Vec3::new(p.x, p.y, 3.0 + p.z);
        let ray = Ray { org, tnear: 0.0, dir: Vec3::new(p.y, p.z, -3.0).normalize(), tfar: f32::INFINITY };
        let mut begin = 0.0;
        for prim in 0..2 {
            let found = world.intersect(&Ray { tnear: begin, ..ray }).unwrap();
            assert!(found.hit.prim <= prim && found.hit.t > begin, "{ray:?}: {found:?} behind {begin}");
            begin = found.hit.t * (1.0 + 1e-6);
        }
        let first = world.intersect(&ray).unwrap().hit;
        assert!(world.intersect(&Ray { tnear: first.t, ..ray }).is_some(), "{ray:?}: {first:?}");
    }
}

#[test]
fn a_frame_later_all_is_elsewhere() {
    let config = BvhConfig { builder: "phr-turbo", width: 8 };
    let bvhs: Vec<Bvh> = objects().iter().map(|mesh| Bvh::build(mesh, &config).unwrap()).collect();
    let bvhs: Vec<&Bvh> = bvhs.iter().collect();
    let mut transforms = transforms();
    let mut world = InstanceBvh::build(instances(&bvhs, &transforms), &config).unwrap();
    for frame in 1..4 {
        for transform in &mut transforms {
            transform.translation.x += 0.5 * frame as f32;
        }
        transforms.truncate(COUNT - frame);
        world.rebuild(instances(&bvhs, &transforms)).unwrap();
        let fresh = InstanceBvh::build(instances(&bvhs, &transforms), &config).unwrap();
        assert_eq!(world.len(), COUNT - frame);
        assert!(rays(500).iter().all(|ray| world.intersect(ray) == fresh.intersect(ray)));
    }
    let before: Vec<_> = rays(100).iter().map(|ray| world.intersect(ray)).collect();
    transforms[7] = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    assert!(world.rebuild(instances(&bvhs, &transforms)).is_err());
    assert_eq!(rays(100).iter().map(|ray| world.intersect(ray)).collect::<Vec<_>>(), before);
}

#[test]
fn transforms_that_are_of_no_use_are_refused_in_one_line() {
    let mesh = &objects()[1];
    let object = Bvh::build(mesh, &BvhConfig::default()).unwrap();
    let build = |transform| {
        let all = vec![Affine3A::IDENTITY, transform];
        InstanceBvh::build(instances(&[&object], &all), &BvhConfig::default())
    };
    let singular = Affine3A::from_mat3(glam::Mat3::from_cols(Vec3::X, Vec3::Y, Vec3::new(0.3, 0.7, 0.0)));
    let far = Affine3A::from_translation(Vec3::splat(3e18));
    let nan = Affine3A::from_translation(Vec3::new(0.0, f32::NAN, 0.0));
    let turned = Affine3A::from_rotation_x(1.0);
    let flat = turned * Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0)) * turned;
    for (transform, word) in [
        (Affine3A::ZERO, "flattens"),
        (singular, "flattens"),
        (flat, "flattens"),
        (Affine3A::from_scale(Vec3::splat(1e-40)), "range"),
        (far, "beyond"),
        (nan, "finite"),
        (Affine3A::from_scale(Vec3::splat(f32::INFINITY)), "finite"),
    ] {
        let alone = Instance { bvh: &object, transform };
        let error = build(transform).unwrap_err();
        assert!(alone.check().is_err_and(|reason| error.to_string().contains(reason)));
        assert!(matches!(error, BvhError::Transform { instance: 1, .. }), "{error}");
        let line = error.to_string();
        assert!(
            line.contains(word) && line.starts_with("the transform of instance 1 ") && !line.contains('\n')
        );
    }
    for fine in [1e-12, 1e12] {
        assert!(build(Affine3A::from_scale(Vec3::splat(fine))).is_ok(), "{fine}");
    }
}

#[test]
fn what_cannot_be_placed_is_left_out() {
    let bvhs: Vec<Arc<Bvh>> =
        objects().iter().map(|mesh| Bvh::build(mesh, &BvhConfig::default()).unwrap().into()).collect();
    let (bad, mut transforms) = ([0, 7, 8, COUNT - 1], transforms());
    for (i, index) in bad.into_iter().enumerate() {
        let far = Affine3A::from_translation(Vec3::splat(3e18));
        transforms[index] = [Affine3A::ZERO, far][i % 2];
    }
    let all = instances(&bvhs, &transforms);
    let good: Vec<_> = all.iter().filter(|instance| instance.check().is_ok()).cloned().collect();
    let mut world = InstanceBvh::build(vec![], &BvhConfig::default()).unwrap();
    assert_eq!(world.rebuild_skipping(all), Ok(bad.to_vec()));
    let expected = InstanceBvh::build(good.clone(), &BvhConfig::default()).unwrap();
    assert!(rays(500).iter().all(|ray| world.intersect(ray) == expected.intersect(ray)));
    assert_eq!((world.len(), world.rebuild_skipping(good.clone())), (COUNT - bad.len(), Ok(vec![])));

    for (i, Instance { bvh, transform }) in (0..).zip(&good) {
        assert!(world.object(i).is_some_and(|object| Arc::ptr_eq(object, bvh)));
        assert_eq!(world.transform(i), Some(*transform));
    }
    let beyond = good.len() as u32;
    assert!(world.object(beyond).is_none() && world.transform(beyond).is_none());
}

/// An object that deforms is taken out of the world while it is rebuilt.
#[test]
fn an_empty_list_gives_the_objects_back() {
    let [mesh, _, other] = &objects()[..] else { panic!("three objects") };
    let mut object = Arc::new(Bvh::build(mesh, &BvhConfig::default()).unwrap());
    let place = |object: &Arc<Bvh>| vec![Instance { bvh: object.clone(), transform: Affine3A::IDENTITY }];
    let mut world = InstanceBvh::build(place(&object), &BvhConfig::default()).unwrap();
    assert!(Arc::get_mut(&mut object).is_none());
    world.rebuild(vec![]).unwrap();
    Arc::get_mut(&mut object).unwrap().rebuild(other).unwrap();
    world.rebuild(place(&object)).unwrap();
    assert!(world.bounds().contains(other.bounds()));
}

#[test]
fn nothing_is_hit_where_nothing_is() {
    let empty = Bvh::build(&Mesh::new(vec![], vec![]).unwrap().0, &BvhConfig::default()).unwrap();
    let some = Bvh::build(&objects()[0], &BvhConfig::default()).unwrap();
    let world: InstanceBvh<&Bvh> = InstanceBvh::build(vec![], &BvhConfig::default()).unwrap();
    assert!(world.is_empty() && world.bounds().is_empty());
    let holes = InstanceBvh::build(
        instances(&[&empty, &some], &[Affine3A::IDENTITY, Affine3A::from_translation(Vec3::splat(50.0))]),
        &BvhConfig::default(),
    )
    .unwrap();
    let only = InstanceBvh::build(
        instances(&[&some], &[Affine3A::from_translation(Vec3::splat(50.0))]),
        &BvhConfig::default(),
    );
    assert_eq!(holes.bounds(), only.unwrap().bounds());
    for ray in &rays(100) {
        assert!(world.intersect(ray).is_none() && !world.occluded(ray));
        assert!(holes.intersect(ray).is_none() && !holes.occluded(ray));
        let bad = Ray { org: Vec3::NAN, ..*ray };
        assert!(holes.intersect(&bad).is_none() && !holes.occluded(&bad));
    }
}

#[test]
fn trees_are_shared_among_threads() {
    fn shared<T: Send + Sync + 'static>() {}
    shared::<InstanceBvh<Arc<Bvh>>>();
}
