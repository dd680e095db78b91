//! What `rtcBuildBVH` calls back, on all its threads, to make nodes and leaves: records in Embree's own memory.
//!
//! No callback panics. One that gets no memory returns null, which Embree passes on to the others as any node and
//! whoever collects the records finds.

#![allow(unsafe_code)]

use crate::embree::scene::GEOMETRY;
use crate::geometry::{Aabb, Mesh};
use embree_sys as sys;
use glam::Vec3A;
use std::ffi::{c_uint, c_void};
use std::{ptr, slice};

/// The head of a record. Behind that of a leaf lie the numbers of its triangles.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Head {
    /// Children, or triangles of a leaf.
    pub count: u32,
    pub is_leaf: bool,
}

/// The record of an inner node.
#[repr(C)]
pub(super) struct Node<const N: usize> {
    head: Head,
    pub children: [*const Head; N],
    pub bounds: [Aabb; N],
}

/// Triangle `prim` of `mesh`, as Embree takes it.
pub(super) fn element(mesh: &Mesh, prim: u32) -> sys::RTCBuildPrimitive {
    let sys::RTCBounds { lower_x, lower_y, lower_z, upper_x, upper_y, upper_z, .. } =
        embree_bounds(mesh.bounds_of(prim));
    sys::RTCBuildPrimitive {
        lower_x,
        lower_y,
        lower_z,
        geomID: GEOMETRY,
        upper_x,
        upper_y,
        upper_z,
        primID: prim,
    }
}

fn embree_bounds(Aabb { min, max }: Aabb) -> sys::RTCBounds {
    let [lower_x, lower_y, lower_z] = min.to_array();
    let [upper_x, upper_y, upper_z] = max.to_array();
    sys::RTCBounds { lower_x, lower_y, lower_z, align0: 0.0, upper_x, upper_y, upper_z, align1: 0.0 }
}

/// Room for a record of so many bytes, as aligned as its type; null without memory.
///
/// # Safety
/// `allocator` is the one that Embree gives to the callback under way.
unsafe fn room<T>(allocator: sys::RTCThreadLocalAllocator, bytes: usize) -> *mut T {
    // SAFETY: the caller's promise; alignments up to 64 are allowed, and no record has more than 16.
    unsafe { sys::rtcThreadLocalAlloc(allocator, bytes, align_of::<T>()) }.cast()
}

/// Makes an inner node without children.
///
/// # Safety
/// As Embree calls it.
pub(super) unsafe extern "C" fn create_node<const N: usize>(
    allocator: sys::RTCThreadLocalAllocator,
    _: c_uint,
    _: *mut c_void,
) -> *mut c_void {
    let head = Head { count: 0, is_leaf: false };
    let node = Node { head, children: [ptr::null(); N], bounds: [Aabb::EMPTY; N] };
    // SAFETY: Embree's allocator for this call.
    let place: *mut Node<N> = unsafe { room(allocator, size_of::<Node<N>>()) };
    if !place.is_null() {
        // SAFETY: room for a node, aligned to it, that nobody else has.
        unsafe { place.write(node) };
    }
    place.cast()
}

/// Notes the children of `node`.
///
/// # Safety
/// As Embree calls it, for a node of the same width.
pub(super) unsafe extern "C" fn set_children<const N: usize>(
    node: *mut c_void,
    children: *mut *mut c_void,
    count: c_uint,
    _: *mut c_void,
) {
    // SAFETY: null, or a node that `create_node` wrote and that no other thread has now.
    let Some(node) = (unsafe { node.cast::<Node<N>>().as_mut() }) else { return };
    // SAFETY: Embree passes so many pointers.
    let children = unsafe { slice::from_raw_parts(children, count as usize) };
    node.head.count = count;
    for (place, child) in node.children.iter_mut().zip(children) {
        *place = child.cast();
    }
}

/// Notes the boxes of the children of `node`.
///
/// # Safety
/// As Embree calls it, for a node of the same width.
pub(super) unsafe extern "C" fn set_bounds<const N: usize>(
    node: *mut c_void,
    bounds: *mut *const sys::RTCBounds,
    count: c_uint,
    _: *mut c_void,
) {
    // SAFETY: null, or a node that `create_node` wrote and that no other thread has now.
    let Some(node) = (unsafe { node.cast::<Node<N>>().as_mut() }) else { return };
    // SAFETY: Embree passes so many pointers.
    let bounds = unsafe { slice::from_raw_parts(bounds, count as usize) };
    for (place, &bounds) in node.bounds.iter_mut().zip(bounds) {
        // SAFETY: each points to a box.
        let b = unsafe { bounds.read_unaligned() };
        *place = Aabb::new(
            Vec3A::new(b.lower_x, b.lower_y, b.lower_z),
            Vec3A::new(b.upper_x, b.upper_y, b.upper_z),
        );
    }
}

/// Makes a leaf: a head and the numbers of the triangles.
///
/// # Safety
/// As Embree calls it.
pub(super) unsafe extern "C" fn create_leaf(
    allocator: sys::RTCThreadLocalAllocator,
    prims: *const sys::RTCBuildPrimitive,
    count: usize,
    _: *mut c_void,
) -> *mut c_void {
    // SAFETY: Embree's allocator for this call.
    let place: *mut Head = unsafe { room(allocator, size_of::<Head>() + count * size_of::<u32>()) };
    if !place.is_null() {
        // SAFETY: room for a head and so many numbers, aligned to both, that nobody else has; Embree passes so many
        // elements.
        unsafe {
            place.write(Head { count: count as u32, is_leaf: true });
            let ids = place.add(1).cast::<u32>();
            (0..count).for_each(|i| ids.add(i).write(prims.add(i).read_unaligned().primID));
        }
    }
    place.cast()
}

/// Splits a triangle's part at a plane.
///
/// # Safety
/// As Embree calls it, with the mesh that was given to it.
pub(super) unsafe extern "C" fn split(
    prim: *const sys::RTCBuildPrimitive,
    axis: c_uint,
    plane: f32,
    left: *mut sys::RTCBounds,
    right: *mut sys::RTCBounds,
    mesh: *mut c_void,
) {
    // SAFETY: the mesh is borrowed for the whole build; Embree passes one element, which it may have made of a box of
    // less alignment.
    let (mesh, part) = unsafe { (&*mesh.cast::<Mesh>(), prim.read_unaligned()) };
    let bounds = Aabb::new(
        Vec3A::new(part.lower_x, part.lower_y, part.lower_z),
        Vec3A::new(part.upper_x, part.upper_y, part.upper_z),
    );
    // Embree knows no other triangles and axes, but nothing may panic here.
    let halves = match mesh.triangles().get(part.primID as usize) {
        Some(triangle) if axis < 3 => halves(mesh.corners_of(triangle), axis as usize, plane),
        _ => [bounds; 2],
    };
    for (place, half) in [left, right].into_iter().zip(halves) {
        // SAFETY: Embree passes places for both halves, of as little alignment.
        unsafe { place.write_unaligned(embree_bounds(half.intersection(bounds))) };
    }
}

/// The boxes of the parts of a triangle below and above `plane`, rounded as by a scene's builder, so that the tree
/// is the same.
fn halves(corners: [Vec3A; 3], axis: usize, plane: f32) -> [Aabb; 2] {
    let (mut left, mut right) = (Aabb::EMPTY, Aabb::EMPTY);
    for (from, to) in [(corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])] {
        let (a, b) = (from[axis], to[axis]);
        if a <= plane {
            left = left.grow(from);
        }
        if a >= plane {
            right = right.grow(from);
        }
        if (a < plane && plane < b) || (b < plane && plane < a) {
            let crossing = (plane - a) * (1.0 / (b - a)) * (to - from) + from;
            left = left.grow(crossing);
            right = right.grow(crossing);
        }
    }
    [left, right]
}
