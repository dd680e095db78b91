//! Queries allocate nothing, neither of single rays nor of batches.

#![allow(unsafe_code)]

use phr::geometry::Ray;
use phr::trace::Camera;
use phr::{Bvh, BvhConfig, scene};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, counting the calls of each thread.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: all is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
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

#[test]
fn rays_allocate_nothing() {
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
