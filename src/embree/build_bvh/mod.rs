//! Trees by Embree's public `rtcBuildBVH`, for versions whose scenes cannot be read: of the same builders, with the
//! settings of a scene's, over the same triangles. SAH and Fast-Spatial give the very tree of a scene but for rare
//! nodes, as this function rounds another way; Morton lacks the rotations of a scene's 4-wide tree, so its own costs
//! more. The function calls back for every node and cut: its trees are for looking at, its time is not.

#![allow(unsafe_code)]

mod callbacks;

use super::{Device, EmbreeBuilder, EmbreeError};
use crate::bvh::limits::{BLOCK, MAX_LEAF, check_width};
use crate::bvh::{Link, MAX_DEPTH, TriangleBlock, WideBvh, WideNode};
use crate::geometry::Mesh;
use crate::memory::{catch_out_of_memory, huge_pages};
use crate::simd::Isa;
use arrayvec::ArrayVec;
use callbacks::{Head, Node, create_leaf, create_node, element, set_bounds, set_children, split};
use embree_sys as sys;
use std::ffi::c_uint;
use std::sync::LazyLock;
use std::{ptr, slice};

const DOING: &str = "building a tree by rtcBuildBVH";
/// What memory is asked for.
const TREE: &str = "a tree by rtcBuildBVH";

/// Embree's memory with all records, given back when dropped.
struct Arena(sys::RTCBVH);

impl Drop for Arena {
    fn drop(&mut self) {
        // SAFETY: this owner's reference, released once.
        unsafe { sys::rtcReleaseBVH(self.0) };
    }
}

impl Device {
    /// The tree of `N` children a node, 4 or 8, that `rtcBuildBVH` builds over `mesh` as `builder` would a scene's.
    ///
    /// # Errors
    /// [`EmbreeError::Call`] with Embree's text, or what memory was missing.
    pub fn build_bvh<const N: usize>(
        &self,
        builder: EmbreeBuilder,
        mesh: &Mesh,
    ) -> Result<WideBvh<N>, EmbreeError> {
        // Embree's builder by Morton codes overruns arrays of its own where nodes have more children than 8.
        const { check_width::<N>() };
        if mesh.is_empty() {
            return Ok(WideBvh::default());
        }
        // The settings of the scene's builders. Triangles are split into the room that the array has behind them.
        let spare = ((1.2 * mesh.len() as f32) as usize).saturating_sub(mesh.len());
        let (quality, depth, leaf, spare) = match builder {
            EmbreeBuilder::Morton => (sys::RTC_BUILD_QUALITY_LOW, 32, BLOCK, 0),
            EmbreeBuilder::Sah => (sys::RTC_BUILD_QUALITY_MEDIUM, 40, MAX_LEAF, 0),
            EmbreeBuilder::FastSpatial => (sys::RTC_BUILD_QUALITY_HIGH, 40, MAX_LEAF, spare),
        };
        // SAFETY: the device is live.
        let arena = Arena(unsafe { sys::rtcNewBVH(self.raw()) });
        self.check(DOING)?;
        let failed = |text| EmbreeError::Call { doing: DOING, text, config: self.config().to_owned() };
        let built = catch_out_of_memory(|| {
            let mut prims = primitives(mesh, spare);
            let arguments = sys::RTCBuildArguments {
                buildQuality: quality,
                maxBranchingFactor: N as c_uint,
                maxDepth: depth,
                sahBlockSize: BLOCK,
                minLeafSize: BLOCK,
                maxLeafSize: leaf,
                traversalCost: 1.0,
                intersectionCost: 1.0,
                bvh: arena.0,
                primitives: prims.as_mut_ptr(),
                primitiveCount: mesh.len(),
                primitiveArrayCapacity: prims.len(),
                createNode: Some(create_node::<N>),
                setNodeChildren: Some(set_children::<N>),
                setNodeBounds: Some(set_bounds::<N>),
                createLeaf: Some(create_leaf),
                splitPrimitive: Some(split),
                userPtr: ptr::from_ref(mesh).cast_mut().cast(),
                // SAFETY: returns a structure of plain values.
                ..unsafe { sys::rtcDefaultBuildArguments() }
            };
            // SAFETY: the arena is live and used by this build alone; the array holds as many whole elements as it
            // says, aligned by their type and not shared; the callbacks keep Embree's rules for theirs, and the mesh
            // that they get outlives the call and may be read from any thread.
            let root = unsafe { sys::rtcBuildBVH(&arguments) };
            self.check(DOING)?;
            drop(prims);
            // SAFETY: the callbacks made the record, and all those below it, in the arena, which is live; the build is
            // over, so nobody writes to them.
            unsafe { collect(root.cast(), mesh) }.map_err(|why| failed(why.to_owned()))
        });
        built.unwrap_or_else(|error| Err(failed(error.to_string())))
    }
}

/// The triangles' boxes, and room behind them for `spare` pieces. Unwinds to [`catch_out_of_memory`] where there is
/// no memory.
fn primitives(mesh: &Mesh, spare: usize) -> Vec<sys::RTCBuildPrimitive> {
    let mut prims = Vec::new();
    huge_pages::reserve(&mut prims, mesh.len() + spare, TREE);
    prims.extend((0..mesh.len() as u32).map(|prim| element(mesh, prim)));
    prims.resize(mesh.len() + spare, sys::RTCBuildPrimitive::default());
    prims
}

/// The tree of the records below `root`, depth first. Unwinds to [`catch_out_of_memory`] where there is no memory for
/// it.
///
/// # Safety
/// `root` is null or a record of the callbacks for nodes of this width, live and no longer written to, as are those
/// below it.
unsafe fn collect<const N: usize>(root: *const Head, mesh: &Mesh) -> Result<WideBvh<N>, &'static str> {
    let mut tree =
        WideBvh { root: Link::EMPTY, bounds: mesh.bounds(), nodes: Vec::new(), blocks: Vec::new() };
    let mut seen = huge_pages::filled(mesh.len(), false, TREE);
    let mut stack = vec![(root, 0, None)];
    while let Some((place, depth, parent)) = stack.pop() {
        // SAFETY: by the caller's promise null or a record.
        let Some(&head) = (unsafe { place.as_ref() }) else { return Err("no memory for a node") };
        let count = head.count as usize;
        let link = if head.is_leaf {
            // SAFETY: so many numbers lie behind the head of a leaf.
            let ids = unsafe { slice::from_raw_parts(place.add(1).cast::<u32>(), count) };
            push_leaf(&mut tree.blocks, ids, mesh, &mut seen)?
        } else {
            // SAFETY: the head of an inner node is the first field of its record.
            let node = unsafe { &*place.cast::<Node<N>>() };
            if count > N || depth == MAX_DEPTH {
                return Err("a node has too many children or lies too deep");
            }
            let index = tree.nodes.len();
            let mut wide = WideNode::EMPTY;
            (0..count).for_each(|slot| wide.set(slot, node.bounds[slot], Link::EMPTY));
            huge_pages::push(&mut tree.nodes, wide, TREE);
            let children = (0..count).map(|slot| (node.children[slot], depth + 1, Some((index, slot))));
            push_children::<_, N>(&mut stack, children);
            Link::inner(index)
        };
        match parent {
            Some((node, slot)) => tree.nodes[node].links[slot] = link,
            None => tree.root = link,
        }
    }
    if seen.contains(&false) {
        return Err("a triangle is in no leaf");
    }
    Ok(WideBvh { nodes: on_huge_pages(tree.nodes), blocks: on_huge_pages(tree.blocks), ..tree })
}

/// Puts `children`, by their slots, on the stack of what is still to be copied. Of several that a ray enters at the
/// same distance, as where it starts within them, our kernel visits that copied first; Embree's that of the highest
/// slot, but its 8-wide one for AVX-512 that of the lowest. Copied in Embree's order, inner nodes are visited in it
/// too; leaves at that distance wait for them, where Embree's have their place among the slots.
pub(super) fn push_children<T, const N: usize>(
    stack: &mut Vec<T>,
    children: impl DoubleEndedIterator<Item = T>,
) {
    static AVX512: LazyLock<bool> = LazyLock::new(|| matches!(Isa::of_processor(), Isa::Avx512(_)));
    if N == 8 && *AVX512 {
        stack.extend(children.rev());
    } else {
        stack.extend(children);
    }
}

/// Appends the blocks of a leaf of the triangles `ids`.
fn push_leaf(
    blocks: &mut Vec<TriangleBlock>,
    ids: &[u32],
    mesh: &Mesh,
    seen: &mut [bool],
) -> Result<Link, &'static str> {
    if ids.is_empty() || ids.len() > MAX_LEAF as usize {
        return Err("a leaf has no triangles or too many");
    }
    let mut once = ArrayVec::<u32, { MAX_LEAF as usize }>::new();
    for &prim in ids {
        *seen.get_mut(prim as usize).ok_or("a leaf names a triangle that is not there")? = true;
        // Two pieces of a triangle may meet again.
        if !once.contains(&prim) {
            once.push(prim);
        }
    }
    let first = blocks.len();
    for ids in once.chunks(BLOCK as usize) {
        let mut block = TriangleBlock::EMPTY;
        ids.iter().enumerate().for_each(|(lane, &prim)| block.set(lane, mesh.corners(prim), prim));
        huge_pages::push(blocks, block, TREE);
    }
    Ok(Link::leaf(first, blocks.len() - first))
}

/// The same elements where Embree and our builders keep theirs: a copy on small pages would be slower to trace.
pub(super) fn on_huge_pages<T>(mut elements: Vec<T>) -> Vec<T> {
    let mut moved = Vec::new();
    huge_pages::reserve(&mut moved, elements.len(), "a copy of Embree's tree");
    moved.append(&mut elements);
    moved
}
