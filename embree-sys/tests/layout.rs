//! bindgen lays out all structures as the C compiler does.

#![allow(unsafe_code)]

use embree_sys::*;
use std::collections::BTreeMap;
use std::ffi::CStr;
use std::mem::{align_of, offset_of, size_of};

macro_rules! layouts {
    ($($name:ident { $($field:ident),* })*) => {
        BTreeMap::from([$(
            (stringify!($name).to_string(), size_of::<$name>()),
            (concat!(stringify!($name), " align").to_string(), align_of::<$name>()),
            $((concat!(stringify!($name), ".", stringify!($field)).to_string(), offset_of!($name, $field)),)*
        )*])
    };
}

fn layouts_in_rust() -> BTreeMap<String, usize> {
    let mut layouts = layouts_of_both();
    layouts.extend(layouts_of_one());
    layouts
}

/// What Embree 3 alone has.
#[cfg(not(embree4))]
fn layouts_of_one() -> BTreeMap<String, usize> {
    layouts! {
    RTCIntersectContext { flags, filter, instID }
    RTCRayNp { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
    RTCHitNp { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }
    RTCRayHitNp { ray, hit }
    }
}

/// What Embree 4 alone has.
#[cfg(embree4)]
fn layouts_of_one() -> BTreeMap<String, usize> {
    layouts! {
    RTCRayQueryContext { instID }
    RTCIntersectArguments { flags, feature_mask, context, filter, intersect }
    RTCOccludedArguments { flags, feature_mask, context, filter, occluded }
    }
}

fn layouts_of_both() -> BTreeMap<String, usize> {
    layouts! {
    RTCBounds { lower_x, lower_y, lower_z, align0, upper_x, upper_y, upper_z, align1 }
    RTCLinearBounds { bounds0, bounds1 }
    RTCFilterFunctionNArguments { valid, geometryUserPtr, context, ray, hit, N }
    RTCPointQuery { x, y, z, time, radius }
    RTCPointQuery4 { x, y, z, time, radius }
    RTCPointQuery8 { x, y, z, time, radius }
    RTCPointQuery16 { x, y, z, time, radius }
    RTCPointQueryContext { world2inst, inst2world, instID, instStackSize }
    RTCPointQueryFunctionArguments { query, userPtr, primID, geomID, context, similarityScale }
    RTCRay { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
    RTCHit { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }
    RTCRayHit { ray, hit }
    RTCRay4 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
    RTCHit4 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }
    RTCRayHit4 { ray, hit }
    RTCRay8 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
    RTCHit8 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }
    RTCRayHit8 { ray, hit }
    RTCRay16 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags }
    RTCHit16 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }
    RTCRayHit16 { ray, hit }
    RTCCollision { geomID0, primID0, geomID1, primID1 }
    RTCQuaternionDecomposition { scale_x, scale_y, scale_z, skew_xy, skew_xz, skew_yz, shift_x, shift_y, shift_z, quaternion_r, quaternion_i, quaternion_j, quaternion_k, translation_x, translation_y, translation_z }
    RTCBoundsFunctionArguments { geometryUserPtr, primID, timeStep, bounds_o }
    RTCIntersectFunctionNArguments { valid, geometryUserPtr, primID, context, rayhit, N, geomID }
    RTCOccludedFunctionNArguments { valid, geometryUserPtr, primID, context, ray, N, geomID }
    RTCDisplacementFunctionNArguments { geometryUserPtr, geometry, primID, timeStep, u, v, Ng_x, Ng_y, Ng_z, P_x, P_y, P_z, N }
    RTCInterpolateArguments { geometry, primID, u, v, bufferType, bufferSlot, P, dPdu, dPdv, ddPdudu, ddPdvdv, ddPdudv, valueCount }
    RTCInterpolateNArguments { geometry, valid, primIDs, u, v, N, bufferType, bufferSlot, P, dPdu, dPdv, ddPdudu, ddPdvdv, ddPdudv, valueCount }
    RTCGrid { startVertexID, stride, width, height }
    RTCBuildPrimitive { lower_x, lower_y, lower_z, geomID, upper_x, upper_y, upper_z, primID }
    RTCBuildArguments { byteSize, buildQuality, buildFlags, maxBranchingFactor, maxDepth, sahBlockSize, minLeafSize, maxLeafSize, traversalCost, intersectionCost, bvh, primitives, primitiveCount, primitiveArrayCapacity, createNode, setNodeChildren, setNodeBounds, createLeaf, splitPrimitive, buildProgress, userPtr }
    }
}

fn layouts_in_c() -> BTreeMap<String, usize> {
    let mut count = 0;
    // SAFETY: the shim returns a static table of `count` entries with static, NUL-terminated names.
    unsafe {
        let table = embree_sys_layouts(&mut count);
        std::slice::from_raw_parts(table, count)
            .iter()
            .map(|entry| (CStr::from_ptr(entry.name).to_str().unwrap().to_string(), entry.value))
            .collect()
    }
}

#[test]
fn layouts_agree() {
    let rust = layouts_in_rust();
    assert!(rust.len() > 200, "only {} entries", rust.len());
    assert_eq!(rust, layouts_in_c());
}

#[test]
fn inline_functions_work() {
    // SAFETY: plain functions over structures that outlive the calls; all-zero bytes are valid for each.
    unsafe {
        #[cfg(not(embree4))]
        {
            let mut context: RTCIntersectContext = std::mem::zeroed();
            rtcInitIntersectContext(&mut context);
            assert_eq!(context.instID, [RTC_INVALID_GEOMETRY_ID]);
        }
        #[cfg(embree4)]
        {
            let mut context: RTCRayQueryContext = std::mem::zeroed();
            rtcInitRayQueryContext(&mut context);
            assert_eq!(context.instID, [RTC_INVALID_GEOMETRY_ID]);
            let mut closest: RTCIntersectArguments = std::mem::zeroed();
            rtcInitIntersectArguments(&mut closest);
            let mut any: RTCOccludedArguments = std::mem::zeroed();
            rtcInitOccludedArguments(&mut any);
            assert_eq!([closest.feature_mask, any.feature_mask], [RTC_FEATURE_FLAG_ALL; 2]);
        }
        let arguments = rtcDefaultBuildArguments();
        assert_eq!(arguments.byteSize, size_of::<RTCBuildArguments>());
        assert_eq!(arguments.maxLeafSize, RTC_BUILD_MAX_PRIMITIVES_PER_LEAF);
        let mut quaternion: RTCQuaternionDecomposition = std::mem::zeroed();
        rtcInitQuaternionDecomposition(&mut quaternion);
        rtcQuaternionDecompositionSetShift(&mut quaternion, 1.0, 2.0, 3.0);
        assert_eq!((quaternion.scale_x, quaternion.shift_z), (1.0, 3.0));
    }
}

#[test]
fn packets_are_read_and_written() {
    // SAFETY: a packet of 8 is what the functions are told to read and write.
    unsafe {
        let mut packet: RTCRayHit8 = std::mem::zeroed();
        packet.ray.dir_y[3] = 5.0;
        packet.ray.flags[3] = 7;
        let pointer: *mut RTCRayHit8 = &mut packet;
        let ray = rtcGetRayFromRayN(pointer.cast(), 8, 3);
        assert_eq!((ray.dir_y, ray.flags, ray.dir_x), (5.0, 7, 0.0));
        let mut hit: RTCHit = std::mem::zeroed();
        hit.v = 0.5;
        hit.geomID = 9;
        rtcCopyHitToHitN((&raw mut (*pointer).hit).cast(), &hit, 8, 3);
        assert_eq!(((*pointer).hit.v[3], (*pointer).hit.geomID), (0.5, [0, 0, 0, 9, 0, 0, 0, 0]));
        let both = rtcGetRayHitFromRayHitN(pointer.cast(), 8, 3);
        assert_eq!((both.ray.dir_y, both.hit.v, both.hit.geomID), (5.0, 0.5, 9));
        assert_eq!(rtcGetHitFromHitN((&raw mut (*pointer).hit).cast(), 8, 3).geomID, 9);
    }
}

#[test]
fn the_library_is_that_of_the_headers() {
    // SAFETY: a device is made, asked and released; the configuration is NUL-terminated.
    unsafe {
        let device = rtcNewDevice(c"threads=1".as_ptr());
        assert!(!device.is_null());
        assert_eq!(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION), RTC_VERSION as isize);
        rtcReleaseDevice(device);
    }
}
