//! Queries allocate nothing, neither of single rays nor of batches; builds and saved trees for which there is no
//! memory are errors, whichever of their large arrays it is.

#![allow(unsafe_code)]

use phr::bvh::Invalid;
use phr::geometry::Ray;
use phr::query::BvhError;
use phr::trace::Camera;
use phr::{Bvh, BvhConfig, scene};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicIsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// The system's allocator, counting the calls of each thread, and failing when [`FAILING`] says so.
struct Counting;

/// Allocations of at least [`LARGE`] bytes before one fails; never where it is negative.
static FAILING: AtomicIsize = AtomicIsize::new(-1);
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
        if layout.size() >= LARGE && FAILING.load(Relaxed) >= 0 && FAILING.fetch_sub(1, Relaxed) == 0 {
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
fn failing<T>(mut f: impl FnMut() -> T) -> Vec<T> {
    let mut results = Vec::new();
    loop {
        FAILING.store(results.len() as isize, Relaxed);
        results.push(f());
        if FAILING.swap(-1, Relaxed) >= 0 {
            return results;
        }
    }
}

#[test]
fn no_large_array_ends_the_process() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let mesh = scene::scalable(80_000, 1).mesh;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tree");
    for builder in ["lbvh", "phr-speed", "phr-quality"] {
        let mut builds = failing(|| Bvh::build(&mesh, &BvhConfig { builder, width: 8 }));
        let bvh = builds.pop().unwrap().unwrap();
        assert!(builds.len() >= 3, "{builder}: {}", builds.len());
        for build in builds {
            assert!(matches!(build, Err(BvhError::OutOfMemory(_))), "{builder}: {:?}", build.err());
        }
        let mut checks = failing(|| bvh.as_bvh8().unwrap().validate(&mesh));
        assert_eq!(checks.pop(), Some(Ok(())));
        assert!(!checks.is_empty() && checks.iter().all(|it| matches!(it, Err(Invalid::OutOfMemory(_)))));
        bvh.save(&mesh, &path).unwrap();
    }
    let mut loads = failing(|| Bvh::load(&mesh, &path));
    assert!(loads.pop().unwrap().is_ok() && loads.len() > 1);
    for load in loads {
        assert!(load.unwrap_err().to_string().contains("no memory for"));
    }
    let mut scenes = failing(|| std::panic::catch_unwind(|| scene::scalable(300_000, 1).mesh.len()));
    assert_eq!(scenes.pop().unwrap().unwrap(), 300_000);
    assert!(scenes.len() > 1 && scenes.iter().all(Result::is_err));
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
    let batches = calls(|| {
        bvh.intersect_batch(&rays, &mut hits);
        bvh.occluded_batch(&rays, &mut occluded);
    });
    assert_eq!(batches, 0);
    assert!(hits.iter().zip(&occluded).all(|(hit, occluded)| hit.is_some() == *occluded));
}
