//! Callbacks of `rtcBuildBVH`, called from all of its threads: nodes and leaves as plain values in Embree's own
//! memory, and triangles cut at planes.

#![allow(unsafe_code)]

use crate::geometry::{Aabb, Mesh};
use embree_sys as sys;
use glam::Vec3A;
use std::ffi::{c_uint, c_void};

/// Most children of a node.
const MAX_CHILDREN: usize = 8;
/// Most triangles of a leaf.
pub(super) const MAX_LEAF: usize = 28;

/// A node that the callbacks make: an inner node or a leaf, of plain values.
#[repr(C, align(16))]
pub(super) struct Raw {
    pub leaf: bool,
    /// Children or triangles in use.
    pub count: usize,
    pub children: [*const Raw; MAX_CHILDREN],
    pub bounds: [sys::RTCBounds; MAX_CHILDREN],
    pub prims: [u32; MAX_LEAF],
}

/// Memory for a node, all zero; null if there is none.
///
/// # Safety
/// `allocator` is the one of the callback that asks.
unsafe fn allocate(allocator: sys::RTCThreadLocalAllocator) -> *mut Raw {
    // SAFETY: the caller's promise; size and alignment are the type's, and all-zero bytes are a `Raw`.
    unsafe {
        let raw: *mut Raw = sys::rtcThreadLocalAlloc(allocator, size_of::<Raw>(), align_of::<Raw>()).cast();
        if !raw.is_null() {
            raw.write_bytes(0, 1);
        }
        raw
    }
}

/// # Safety
/// Called by Embree with the arguments that its manual specifies; likewise the callbacks below.
pub(super) unsafe extern "C" fn create_node(
    allocator: sys::RTCThreadLocalAllocator,
    _children: c_uint,
    _user: *mut c_void,
) -> *mut c_void {
    // SAFETY: the allocator of this callback.
    unsafe { allocate(allocator) }.cast()
}

/// # Safety
/// As for [`create_node`].
pub(super) unsafe extern "C" fn set_children(
    node: *mut c_void,
    children: *mut *mut c_void,
    count: c_uint,
    _user: *mut c_void,
) {
    let count = (count as usize).min(MAX_CHILDREN);
    // SAFETY: `node` is null or comes from `create_node`, and no other thread has it now; `children` holds
    // `count` results of `create_node` and `create_leaf`.
    unsafe {
        let Some(node) = node.cast::<Raw>().as_mut() else { return };
        node.count = count;
        for (slot, child) in std::slice::from_raw_parts(children, count).iter().enumerate() {
            node.children[slot] = child.cast();
        }
    }
}

/// # Safety
/// As for [`create_node`].
pub(super) unsafe extern "C" fn set_bounds(
    node: *mut c_void,
    bounds: *mut *const sys::RTCBounds,
    count: c_uint,
    _user: *mut c_void,
) {
    let count = (count as usize).min(MAX_CHILDREN);
    // SAFETY: as in `set_children`, with `count` pointers to boxes.
    unsafe {
        let Some(node) = node.cast::<Raw>().as_mut() else { return };
        for (slot, bounds) in std::slice::from_raw_parts(bounds, count).iter().enumerate() {
            node.bounds[slot] = **bounds;
        }
    }
}

/// # Safety
/// As for [`create_node`].
pub(super) unsafe extern "C" fn create_leaf(
    allocator: sys::RTCThreadLocalAllocator,
    primitives: *const sys::RTCBuildPrimitive,
    count: usize,
    _user: *mut c_void,
) -> *mut c_void {
    // SAFETY: the allocator of this callback, and `count` primitives.
    unsafe {
        let raw = allocate(allocator);
        if let Some(leaf) = raw.as_mut() {
            leaf.leaf = true;
            leaf.count = count.min(MAX_LEAF);
            for (slot, primitive) in std::slice::from_raw_parts(primitives, leaf.count).iter().enumerate() {
                leaf.prims[slot] = primitive.primID;
            }
        }
        raw.cast()
    }
}

/// Cuts a triangle at a plane: the boxes of both parts, within the primitive's own box.
///
/// # Safety
/// As for [`create_node`]; `user` is the mesh.
pub(super) unsafe extern "C" fn split_primitive(
    primitive: *const sys::RTCBuildPrimitive,
    dimension: c_uint,
    position: f32,
    left: *mut sys::RTCBounds,
    right: *mut sys::RTCBounds,
    user: *mut c_void,
) {
    // SAFETY: the pointers are valid for this call, `user` is the mesh that `build` borrows.
    let (primitive, mesh) = unsafe { (&*primitive, &*user.cast_const().cast::<Mesh>()) };
    let bounds = Aabb::new(
        Vec3A::new(primitive.lower_x, primitive.lower_y, primitive.lower_z),
        Vec3A::new(primitive.upper_x, primitive.upper_y, primitive.upper_z),
    );
    let parts = split(mesh.corners(primitive.primID), dimension as usize, position);
    let [at_left, at_right] = parts.map(|part| part.intersection(bounds));
    // SAFETY: two boxes to write.
    unsafe {
        left.write(embree_bounds(at_left));
        right.write(embree_bounds(at_right));
    }
}

/// Boxes of the parts of a triangle below and above `position`, rounded as Embree's splitter rounds.
fn split(corners: [Vec3A; 3], axis: usize, position: f32) -> [Aabb; 2] {
    let (mut left, mut right) = (Aabb::EMPTY, Aabb::EMPTY);
    for i in 0..3 {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        let (a, b) = (from[axis], to[axis]);
        if a <= position {
            left = left.grow(from);
        }
        if a >= position {
            right = right.grow(from);
        }
        if (a < position && position < b) || (b < position && position < a) {
            let crossing = (position - a) * (1.0 / (b - a)) * (to - from) + from;
            left = left.grow(crossing);
            right = right.grow(crossing);
        }
    }
    [left, right]
}

fn embree_bounds(bounds: Aabb) -> sys::RTCBounds {
    let Aabb { min, max } = bounds;
    sys::RTCBounds {
        lower_x: min.x,
        lower_y: min.y,
        lower_z: min.z,
        align0: 0.0,
        upper_x: max.x,
        upper_y: max.y,
        upper_z: max.z,
        align1: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_triangle_fills_both_sides() {
        let corners = [Vec3A::ZERO, Vec3A::new(4.0, 0.0, 0.0), Vec3A::new(0.0, 2.0, 0.0)];
        let [left, right] = split(corners, 0, 1.0);
        assert_eq!((left.min.x, left.max.x, left.max.y), (0.0, 1.0, 2.0));
        assert_eq!((right.min.x, right.max.x, right.max.y), (1.0, 4.0, 1.5));
        assert!(split(corners, 0, 5.0)[1].is_empty());
    }
}
