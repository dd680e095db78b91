//! Queries allocate nothing, neither of single rays nor of batches; builds and saved trees for which there is no
//! memory are errors, whichever of their large arrays it is.

#![allow(unsafe_code)]

use glam::{Affine3A, Vec3, Vec3A};
use phr::builders::{Builder as _, Phr, PhrConfig, RefitError};
use phr::bvh::saved::SavedError;
use phr::bvh::{Bvh4, Invalid, WideNode};
use phr::geometry::{Aabb, Mesh, Ray};
use phr::query::BvhError;
use phr::random::SplitMix64;
use phr::trace::{Camera, ProvenTree, WatertightTracer};
use phr::{Bvh, BvhConfig, Instance, InstanceBvh, PrimitiveBvh, scene};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicIsize, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// The system's allocator, counting the calls of each thread, and failing when [`FAILING`] says so.
struct Counting;

/// Allocations of at least [`LEAST`] bytes before one fails; never where it is negative.
static FAILING: AtomicIsize = AtomicIsize::new(-1);
/// Smaller ones never fail.
static LEAST: AtomicUsize = AtomicUsize::new(LARGE);
/// Less than eight bytes for each of 80 thousand triangles, and more than a task has of its own.
const LARGE: usize = 600_000;
/// Tests of one process take turns.
static TURN: Mutex<()> = Mutex::new(());

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: all is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
        let counts = FAILING.load(Relaxed) >= 0 && layout.size() >= LEAST.load(Relaxed);
        if counts && FAILING.fetch_sub(1, Relaxed) == 0 {
            return std::ptr::null_mut();
        }
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of `f`.
fn calls(f: impl FnOnce()) -> usize {
    let before = CALLS.get();
    f();
    CALLS.get() - before
}

/// The results of `f` while its first large allocation fails, then while its second does, and so on; the last is
/// without a failure.
fn failing<T>(f: impl FnMut() -> T) -> Vec<T> {
    failing_from(LARGE, f)
}

/// The same with allocations of at least so many bytes.
fn failing_from<T>(bytes: usize, mut f: impl FnMut() -> T) -> Vec<T> {
    LEAST.store(bytes, Relaxed);
    let mut results = Vec::new();
    loop {
        FAILING.store(results.len() as isize, Relaxed);
        results.push(f());
        if FAILING.swap(-1, Relaxed) >= 0 {
            return results;
        }
    }
}

/// What `f` makes for a call that is to fail; it does not fail itself.
fn spared<T>(f: impl FnOnce() -> T) -> T {
    let failing = FAILING.swap(-1, Relaxed);
    let made = f();
    FAILING.store(failing, Relaxed);
    made
}

/// The result of the last attempt; for those before, of which there are at least so many, there was no memory.
#[track_caller]
fn assert_told<T>(mut attempts: Vec<Result<T, BvhError>>, least: usize, what: &str) -> T {
    let last = attempts.pop().unwrap().unwrap();
    assert!(attempts.len() >= least, "{what}: {}", attempts.len());
    for attempt in attempts {
        assert!(matches!(attempt, Err(BvhError::OutOfMemory(_))), "{what}: {:?}", attempt.err());
    }
    last
}

/// 80 thousand triangles, and needles through all of them that are split into hundreds of pieces each.
fn mesh() -> Mesh {
    let mesh = scene::scalable(80_000, 1).mesh;
    let Aabb { min, max } = mesh.bounds();
    let (mut vertices, mut triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
    for i in 1..=72u8 {
        let first = vertices.len() as u32;
        let beside = min + Vec3A::Y * ((max - min).y * 1e-5 * f32::from(i));
        vertices.extend([min, max, beside].map(|corner| corner.to_array()));
        triangles.push([first, first + 1, first + 2]);
    }
    Mesh::new(vertices, triangles).unwrap().0
}

#[test]
fn no_large_array_ends_the_process() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = mesh();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tree");
    for builder in ["lbvh", "phr-speed-aux-sah", "phr-speed", "phr-quality"] {
        let builds = failing(|| Bvh::build(&mesh, &BvhConfig { builder, width: 8 }));
        let bvh = assert_told(builds, 3, builder);
        let mut checks = failing(|| bvh.as_bvh8().unwrap().validate(&mesh));
        assert_eq!(checks.pop(), Some(Ok(())));
        assert!(!checks.is_empty() && checks.iter().all(|it| matches!(it, Err(Invalid::OutOfMemory(_)))));
        bvh.save(&mesh, &path).unwrap();
    }
    let mut loads = failing(|| Bvh::load(&mesh, &path));
    let bvh = loads.pop().unwrap().unwrap();
    assert!(loads.len() > 1);
    for load in loads {
        assert!(matches!(load, Err(SavedError::OutOfMemory { .. })), "{load:?}");
    }
    let tree = bvh.as_bvh8().unwrap();
    let uploads = failing(|| tree.try_block_bytes().map_err(BvhError::from));
    assert_eq!(assert_told(uploads, 1, "bytes").len(), 160 * tree.blocks.len());
    let mut tracers = failing(|| WatertightTracer::try_new(tree, &mesh).map(drop));
    assert_eq!(tracers.pop(), Some(Ok(())));
    assert!(
        !tracers.is_empty() && tracers.iter().all(|it| it.as_ref().unwrap_err().contains("no memory for"))
    );
    let mut scenes = failing(|| std::panic::catch_unwind(|| scene::scalable(300_000, 1).mesh.len()));
    assert_eq!(scenes.pop().unwrap().unwrap(), 300_000);
    assert!(scenes.len() > 1 && scenes.iter().all(Result::is_err));
}

#[test]
fn nor_does_one_over_boxes_or_instances() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = scene::scalable(80_000, 1).mesh;
    let boxes: Vec<Aabb> = (0..mesh.len() as u32).map(|prim| mesh.bounds_of(prim)).collect();
    let config = BvhConfig { builder: "phr-speed", width: 4 };
    let mut bvh = assert_told(failing(|| PrimitiveBvh::build(&boxes, &config)), 4, "boxes");
    assert_told(failing(|| bvh.rebuild(&boxes)), 1, "boxes again");
    assert_eq!(bvh.as_bvh4().unwrap().validate_links(boxes.len()), Ok(()));

    let object = Bvh::build(&scene::scalable(100, 1).mesh, &BvhConfig::default()).unwrap();
    let place = |i: u16| Affine3A::from_translation(Vec3::new(f32::from(i % 300), f32::from(i / 300), 0.0));
    let instances =
        || (0..60_000).map(|i| Instance { bvh: &object, transform: place(i) }).collect::<Vec<_>>();
    let config = BvhConfig { builder: "lbvh", width: 8 };
    let builds = failing(|| InstanceBvh::build(spared(instances), &config));
    let mut world = assert_told(builds, 3, "instances");
    let rebuilds = failing(|| {
        let rebuilt = world.rebuild(spared(instances));
        // What it tells of itself and what rays meet are the same list.
        assert!(
            world.is_empty() == world.upper().bounds().is_empty()
                && world.is_empty() == world.bounds().is_empty()
        );
        rebuilt
    });
    assert_told(rebuilds, 2, "instances again");
    assert_eq!((world.len(), world.upper().as_bvh8().unwrap().validate_links(60_000)), (60_000, Ok(())));
}

#[test]
fn nor_does_a_refit() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = scene::scalable(80_000, 1).mesh;
    let mut tree = phr::builders::by_name::<4>("lbvh").unwrap().build(&mesh).tree;
    let mut refits = failing(|| tree.refit(&mesh));
    assert_eq!(refits.pop(), Some(Ok(())));
    assert!(!refits.is_empty() && refits.iter().all(|it| matches!(it, Err(RefitError::OutOfMemory(_)))));
    let refined = failing(|| {
        let mut phr = spared(|| Phr::<4>::new("refining", PhrConfig::FAST).unwrap());
        spared(|| phr.build(&mesh));
        phr.refit(&mesh).map(|build| build.tree.nodes.len())
    });
    assert!(refined.last().is_some_and(Result::is_ok));
    let told = refined.iter().rev().skip(1).all(|it| matches!(it, Err(RefitError::OutOfMemory(_))));
    assert!(told && refined.len() > 1, "{}", refined.len());
}

/// Of no triangle is a tree without memory for its successor, but not out of use.
#[test]
fn nor_does_a_tree_that_follows_its_mesh() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = scene::scalable(80_000, 1).mesh;
    let config = BvhConfig::new("phr-speed", 8);
    let mut bvh = Bvh::build(&mesh, &config).unwrap();
    let fresh = bvh.as_bvh8().cloned();
    let mut refits = failing(|| bvh.refit(&mesh));
    assert_eq!(refits.pop(), Some(Ok(())));
    assert!(!refits.is_empty() && refits.iter().all(|it| matches!(it, Err(RefitError::OutOfMemory(_)))));
    let rebuilds = failing(|| {
        let rebuilt = bvh.rebuild(&mesh);
        assert!(rebuilt.is_ok() || (bvh.is_empty() && bvh.bounds().is_empty()));
        rebuilt
    });
    assert_told(rebuilds, 3, "a tree again");
    assert_eq!((bvh.len(), bvh.as_bvh8().cloned()), (mesh.len(), fresh));
}

#[test]
fn nor_does_the_proof_of_a_large_tree() {
    const NODES: usize = 200_000;
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    // Nodes that nothing leads to have flags, too.
    let tree = || Bvh4 { nodes: vec![WideNode::EMPTY; NODES], ..Bvh4::default() };
    assert_told(failing_from(NODES, || Bvh::try_from(spared(tree))), 1, "flags");
    let proofs = failing_from(NODES, || ProvenTree::new(spared(tree)).err());
    assert!(matches!(&proofs[..], [Some(error), None] if error.contains("no memory for")), "{proofs:?}");
}

#[test]
fn rays_allocate_nothing() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let scene = scene::scalable(20_000, 1);
    let bvh = Bvh::build(&scene.mesh, &BvhConfig::default()).unwrap();
    let camera = Camera::new(&scene.views[0], 256, 64);
    let rays: Vec<Ray> = (0..256 * 64).map(|i| camera.ray(i % 256, i / 256, [0.5; 2])).collect();
    let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
    assert!(calls(|| drop(vec![0u8; 100])) == 1);
    let single = calls(|| {
        for (ray, hit) in rays.iter().zip(&mut hits) {
            *hit = bvh.intersect(ray);
            assert_eq!(bvh.occluded(ray), hit.is_some());
        }
    });
    assert_eq!(single, 0);
    // Of scattered rays batches are other code.
    let mut scattered = rays.clone();
    let mut random = SplitMix64::new(1);
    (1..scattered.len()).for_each(|i| scattered.swap(i, random.below(i + 1)));
    for rays in [&rays, &scattered] {
        let batches = calls(|| {
            bvh.intersect_batch(rays, &mut hits);
            bvh.occluded_batch(rays, &mut occluded);
        });
        assert_eq!(batches, 0);
        assert!(hits.iter().zip(&occluded).all(|(hit, occluded)| hit.is_some() == *occluded));
    }
    let boxes: Vec<Aabb> = (0..scene.mesh.len() as u32).map(|prim| scene.mesh.bounds_of(prim)).collect();
    let of_boxes = PrimitiveBvh::build(&boxes, &BvhConfig::default()).unwrap();
    let place =
        |x: f32| Instance { bvh: &bvh, transform: Affine3A::from_translation(Vec3::new(x, 0.0, 0.0)) };
    let world =
        InstanceBvh::build((0..50u8).map(|i| place(i.into())).collect(), &BvhConfig::default()).unwrap();
    let mut found = [0; 3];
    let others = calls(|| {
        for ray in rays.iter().step_by(8) {
            found[0] += usize::from(bvh.intersect_filtered(ray, |hit| hit.prim % 2 == 0).is_some());
            bvh.occluded_filtered(ray, |hit| hit.prim % 2 == 0);
            found[1] += usize::from(
                of_boxes.intersect_with(ray, |id, ray| (id % 2 == 0).then_some(ray.tfar.min(1.0))).is_some(),
            );
            of_boxes.occluded_with(ray, |id, _| id % 2 == 0);
            found[2] += usize::from(world.intersect(ray).is_some());
            world.occluded(ray);
        }
    });
    assert_eq!(others, 0);
    assert!(found.iter().all(|&hits| hits > 100), "{found:?}");
}
