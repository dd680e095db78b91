//! Embree's builders through the public `rtcBuildBVH`, into our tree: for versions whose own trees cannot be
//! read. With these parameters SAH and Fast-Spatial give the very tree of a committed scene, but for rare
//! nodes where the SSE2 binning of this function differs; Morton lacks the scene builder's tree rotations, so
//! its 4-wide tree costs more. The function calls back for every node and cut: inspect its trees, do not time
//! them.

#![allow(unsafe_code)]

mod callbacks;

use super::{Device, EmbreeBuilder, EmbreeError};
use crate::bvh::{Link, TriangleBlock, WideBvh, WideNode};
use crate::geometry::{Aabb, Mesh};
use callbacks::{MAX_LEAF, Raw, create_leaf, create_node, set_bounds, set_children, split_primitive};
use embree_sys as sys;
use glam::Vec3A;
use std::ffi::c_uint;

/// Builds the `N`-wide tree, 4 or 8, of `mesh` with `builder`.
///
/// # Errors
/// [`EmbreeError::Call`] with Embree's text.
pub fn build<const N: usize>(
    device: &Device,
    mesh: &Mesh,
    builder: EmbreeBuilder,
) -> Result<WideBvh<N>, EmbreeError> {
    const { assert!(N == 4 || N == 8, "Embree's trees are 4 or 8 wide") };
    if mesh.is_empty() {
        return Ok(WideBvh::default());
    }
    let count = mesh.len();
    let spatial = builder == EmbreeBuilder::FastSpatial;
    let capacity = if spatial { count.max((1.2 * count as f32) as usize) } else { count };
    let mut primitives: Vec<_> = (0..count as u32).map(|prim| primitive(mesh, prim)).collect();
    primitives.resize_with(capacity, sys::RTCBuildPrimitive::default);
    let (quality, max_depth, max_leaf) = match builder {
        EmbreeBuilder::Morton => (sys::RTC_BUILD_QUALITY_LOW, 32, 4),
        EmbreeBuilder::Sah => (sys::RTC_BUILD_QUALITY_MEDIUM, 40, MAX_LEAF),
        EmbreeBuilder::FastSpatial => (sys::RTC_BUILD_QUALITY_HIGH, 40, MAX_LEAF),
    };
    // SAFETY: the arguments name `capacity` primitives, of which `count` are set, and callbacks that read
    // `userPtr` as the mesh it is; all outlive the call. The nodes live until the BVH is released, after they
    // were copied.
    unsafe {
        let bvh = Bvh(sys::rtcNewBVH(device.raw()));
        device.check("making a BVH")?;
        let mut arguments = sys::rtcDefaultBuildArguments();
        arguments.buildQuality = quality;
        arguments.maxBranchingFactor = N as c_uint;
        arguments.maxDepth = max_depth;
        arguments.sahBlockSize = 4;
        arguments.minLeafSize = 4;
        arguments.maxLeafSize = max_leaf as c_uint;
        arguments.traversalCost = 1.0;
        arguments.intersectionCost = 1.0;
        arguments.bvh = bvh.0;
        arguments.primitives = primitives.as_mut_ptr();
        arguments.primitiveCount = count;
        arguments.primitiveArrayCapacity = capacity;
        arguments.createNode = Some(create_node);
        arguments.setNodeChildren = Some(set_children);
        arguments.setNodeBounds = Some(set_bounds);
        arguments.createLeaf = Some(create_leaf);
        arguments.splitPrimitive = spatial.then_some(split_primitive as _);
        arguments.userPtr = std::ptr::from_ref(mesh).cast_mut().cast();
        let root = sys::rtcBuildBVH(&arguments);
        device.check("building the tree")?;
        collect(root.cast(), mesh).ok_or_else(|| EmbreeError::Call {
            doing: "building the tree",
            text: "a node is missing (out of memory)".to_owned(),
            config: device.config().to_owned(),
        })
    }
}

/// A BVH object of Embree, which holds the nodes.
struct Bvh(sys::RTCBVH);

impl Drop for Bvh {
    fn drop(&mut self) {
        // SAFETY: this owner's reference, released once.
        unsafe { sys::rtcReleaseBVH(self.0) };
    }
}

fn primitive(mesh: &Mesh, prim: u32) -> sys::RTCBuildPrimitive {
    let Aabb { min, max } = mesh.bounds_of(prim);
    sys::RTCBuildPrimitive {
        lower_x: min.x,
        lower_y: min.y,
        lower_z: min.z,
        geomID: 0,
        upper_x: max.x,
        upper_y: max.y,
        upper_z: max.z,
        primID: prim,
    }
}

/// Copies the callbacks' tree into ours, depth first; `None` if a node is missing.
///
/// # Safety
/// `root` is null or the root of a finished tree of [`Raw`].
unsafe fn collect<const N: usize>(root: *const Raw, mesh: &Mesh) -> Option<WideBvh<N>> {
    let mut tree = WideBvh { bounds: mesh.bounds(), ..WideBvh::default() };
    let mut stack = vec![(root, None)];
    while let Some((raw, parent)) = stack.pop() {
        // SAFETY: the caller's promise; children of a finished tree are nodes or null.
        let raw = unsafe { raw.as_ref() }?;
        let link = if raw.leaf {
            let first = tree.blocks.len();
            for prims in raw.prims[..raw.count].chunks(4) {
                let mut block = TriangleBlock::EMPTY;
                for (lane, &prim) in prims.iter().enumerate() {
                    block.set(lane, mesh.corners(prim), prim);
                }
                tree.blocks.push(block);
            }
            Link::leaf(first, tree.blocks.len() - first)
        } else {
            let mut node = WideNode::EMPTY;
            for (slot, b) in raw.bounds[..raw.count].iter().enumerate() {
                let lower = Vec3A::new(b.lower_x, b.lower_y, b.lower_z);
                let upper = Vec3A::new(b.upper_x, b.upper_y, b.upper_z);
                node.set(slot, Aabb::new(lower, upper), Link::EMPTY);
            }
            let index = tree.nodes.len();
            tree.nodes.push(node);
            stack.extend((0..raw.count).rev().map(|slot| (raw.children[slot], Some((index, slot)))));
            Link::inner(index)
        };
        match parent {
            Some((node, slot)) => tree.nodes[node].links[slot] = link,
            None => tree.root = link,
        }
    }
    Some(tree)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::sah_cost;
    use crate::embree::test_meshes::soup;
    use crate::embree::{Config, Width, inspect};

    fn compare<const N: usize>(mesh: &Mesh, width: Width) {
        for builder in EmbreeBuilder::ALL {
            let config = Config { builder, width, threads: 2 };
            let device = Device::new(&config).unwrap();
            let tree: WideBvh<N> = build(&device, mesh, builder).unwrap();
            tree.validate(mesh).unwrap();
            let printed = inspect(mesh, &config).unwrap();
            let ratio = sah_cost(&tree) / printed.sah;
            // Tree rotations, which `rtcBuildBVH` leaves out, lower the cost of 4-wide Morton trees.
            let rotated = builder == EmbreeBuilder::Morton && N == 4;
            assert!(
                (1.0 - 1e-5..if rotated { 1.5 } else { 1.0 + 1e-5 }).contains(&ratio),
                "{ratio}: {printed:?}"
            );
            assert_eq!(device.memory().live_bytes, 0);
        }
    }

    #[test]
    fn trees_cost_what_the_scene_builders_trees_cost() {
        for count in [1, 5, 300, 3000] {
            compare::<4>(&soup(count), Width::Four);
            compare::<8>(&soup(count), Width::Eight);
        }
    }

    #[test]
    #[cfg(feature = "graft")]
    fn trees_are_those_read_from_a_scene() {
        let mesh = soup(3000);
        for builder in [EmbreeBuilder::Sah, EmbreeBuilder::FastSpatial] {
            let device = Device::new(&Config { builder, width: Width::Four, threads: 2 }).unwrap();
            let scene = device.prepare(&mesh).unwrap().commit().unwrap();
            let Ok(read) = crate::embree::native::read4(&scene) else { return };
            assert_eq!(build::<4>(&device, &mesh, builder).unwrap(), read);
        }
    }

    #[test]
    fn an_empty_mesh_has_an_empty_tree() {
        let device =
            Device::new(&Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 1 }).unwrap();
        assert_eq!(build::<4>(&device, &soup(0), EmbreeBuilder::Sah).unwrap(), WideBvh::default());
    }
}
