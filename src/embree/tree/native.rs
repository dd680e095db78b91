//! Reads Embree's own tree of a committed scene into ours, so that costs, node visits and our kernel apply to
//! Embree's builders too. Boxes, slots of children and blocks of leaves stay as they are.

#![allow(unsafe_code)]

pub use super::layout::known;
use super::layout::reference::{self, Target};
use super::layout::{Node, RootSlot, Triangle4, Unavailable};
use crate::bvh::{Bvh4, Bvh8, Link, MAX_DEPTH, TriangleBlock, WideBvh, WideNode};
use crate::embree::build_bvh::{on_huge_pages, push_children};
use crate::embree::scene::{EmbreeScene, GEOMETRY};
use crate::geometry::{Aabb, Mesh};
use crate::memory::{catch_out_of_memory, huge_pages};
use glam::Vec3A;

/// What memory is asked for.
const COPY: &str = "a copy of Embree's tree";

/// The tree of a scene built with [`crate::embree::Width::Four`].
///
/// # Errors
/// [`Unavailable`] where Embree is another version or anything in the tree is not as it must be.
pub fn read4(scene: &EmbreeScene<'_>) -> Result<Bvh4, Unavailable> {
    read(scene)
}

/// The tree of a scene built with [`crate::embree::Width::Eight`].
///
/// # Errors
/// As for [`read4`].
pub fn read8(scene: &EmbreeScene<'_>) -> Result<Bvh8, Unavailable> {
    read(scene)
}

fn read<const N: usize>(scene: &EmbreeScene<'_>) -> Result<WideBvh<N>, Unavailable> {
    // Without triangles Embree makes no tree at all.
    if scene.mesh().is_empty() {
        return Ok(WideBvh::default());
    }
    let slot = RootSlot::find::<N>(scene)?;
    // SAFETY: the scene is live. The guards of `find` hold, so the root belongs to its tree, or to the one that
    // replaces it, and nothing changes it while the scene is borrowed.
    let walked = catch_out_of_memory(|| unsafe { walk(slot.get(), scene.bounds(), scene.mesh()) });
    walked.unwrap_or_else(Unavailable::because)
}

/// Copies the tree below `root`, over the triangles of `mesh`. Unwinds to [`catch_out_of_memory`] where there is no
/// memory for that.
///
/// # Safety
/// `root` refers to a finished tree of width `N` in Embree's layout, which nobody changes.
unsafe fn walk<const N: usize>(root: u64, bounds: Aabb, mesh: &Mesh) -> Result<WideBvh<N>, Unavailable> {
    // Spatial splits add a fifth of the triangles at most; a walk that finds twice as many is lost.
    let limit = 2 * mesh.len() + 8;
    let mut tree = WideBvh { root: Link::EMPTY, bounds, nodes: Vec::new(), blocks: Vec::new() };
    let mut seen = huge_pages::filled(mesh.len(), false, COPY);
    let mut stack = vec![Visit { bits: root, depth: 0, parent: None }];
    while let Some(Visit { bits, depth, parent }) = stack.pop() {
        let link = match reference::get(bits) {
            None => return Unavailable::because("a child is no reference to a node"),
            Some(Target::Empty) => Link::EMPTY,
            Some(Target::Inner(address)) => {
                if depth == MAX_DEPTH || tree.nodes.len() == limit {
                    return Unavailable::because("the tree is deeper or larger than Embree builds");
                }
                let place: *const Node<N> = std::ptr::with_exposed_provenance(address);
                // SAFETY: by the caller's promise a node of this width lies here; alignment is not assumed.
                let node = unsafe { place.read_unaligned() };
                let index = tree.nodes.len();
                huge_pages::push(&mut tree.nodes, convert(&node), COPY);
                let visits = node.children.into_iter().enumerate().map(|(slot, bits)| Visit {
                    bits,
                    depth: depth + 1,
                    parent: Some((index, slot)),
                });
                let visits = visits.filter(|visit| visit.bits != reference::EMPTY);
                push_children::<_, N>(&mut stack, visits);
                Link::inner(index)
            }
            Some(Target::Leaf(address, count)) => {
                let first = tree.blocks.len();
                if first + count > limit {
                    return Unavailable::because("there are more leaves than Embree builds");
                }
                for block in 0..count {
                    let place: *const Triangle4 =
                        std::ptr::with_exposed_provenance(address + block * size_of::<Triangle4>());
                    // SAFETY: by the caller's promise `count` blocks lie here; references keep them aligned.
                    let block = unsafe { place.read() };
                    let block = check_block(&block, mesh, &mut seen)?;
                    huge_pages::push(&mut tree.blocks, block, COPY);
                }
                Link::leaf(first, count)
            }
        };
        match parent {
            Some((node, slot)) => tree.nodes[node].links[slot] = link,
            None => tree.root = link,
        }
    }
    match seen.iter().position(|seen| !seen) {
        Some(prim) => Unavailable::because(format_args!("triangle {prim} is in no leaf")),
        None => Ok(WideBvh { nodes: on_huge_pages(tree.nodes), blocks: on_huge_pages(tree.blocks), ..tree }),
    }
}

/// A reference still to follow, and the slot that waits for it (none for the root).
struct Visit {
    bits: u64,
    depth: usize,
    parent: Option<(usize, usize)>,
}

/// The boxes of a node; its links follow as its children are read.
fn convert<const N: usize>(node: &Node<N>) -> WideNode<N> {
    let mut wide = WideNode::EMPTY;
    for slot in (0..N).filter(|&slot| node.children[slot] != reference::EMPTY) {
        let corner = |side: usize| Vec3A::from_array(node.planes.map(|axis| axis[side][slot]));
        wide.set(slot, Aabb::new(corner(0), corner(1)), Link::EMPTY);
    }
    wide
}

/// Our block of the same triangles, if Embree's holds the same data.
fn check_block(block: &Triangle4, mesh: &Mesh, seen: &mut [bool]) -> Result<TriangleBlock, Unavailable> {
    let mut ours = TriangleBlock::EMPTY;
    for lane in 0..4 {
        let (geometry, prim) = (block.geometries[lane], block.prims[lane]);
        if (geometry, prim) == (u32::MAX, u32::MAX) {
            continue;
        }
        if geometry != GEOMETRY || prim as usize >= mesh.len() {
            return Unavailable::because(format_args!("a leaf names triangle {prim} of geometry {geometry}"));
        }
        ours.set(lane, mesh.corners(prim), prim);
        seen[prim as usize] = true;
    }
    if ours.v0 == block.v0 && ours.e1 == block.e1 && ours.e2 == block.e2 {
        return Ok(ours);
    }
    Unavailable::because("a leaf's triangles are not those of the mesh")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Statistics;
    use crate::embree::test_meshes::soup;
    use crate::embree::{Config, Device, EmbreeBuilder, Width, inspect};
    use crate::simd::Isa;

    /// Reads the tree of every builder and compares its cost with the one that Embree prints.
    fn read_and_compare<const N: usize>(mesh: &Mesh, width: Width) {
        for builder in EmbreeBuilder::ALL {
            let config = Config { builder, width, threads: 2 };
            let printed = inspect(mesh, &config).unwrap();
            let device = Device::new(&config).unwrap();
            let scene = device.prepare(mesh).unwrap().commit().unwrap();
            let tree: WideBvh<N> = read(&scene).unwrap();
            tree.validate(mesh).unwrap();
            let statistics = Statistics::of(&tree, mesh);
            assert!((statistics.sah / printed.sah - 1.0).abs() < 1e-5, "{} != {printed:?}", statistics.sah);
            assert_eq!(statistics.nodes as u64, printed.nodes);
            assert_eq!(statistics.leaves as u64, printed.leaves);
            assert_eq!(statistics.depth as u64, printed.depth);
            assert!((statistics.leaf_fill - printed.leaf_fill).abs() < 1e-4);
            assert!((statistics.node_fill - printed.node_fill).abs() < 1e-4);
            for node in &tree.nodes {
                let inner = node.links.iter().filter(|link| link.is_inner()).map(|link| link.bits());
                let lowest_first = N == 8 && matches!(Isa::of_processor(), Isa::Avx512(_));
                assert!(if lowest_first { inner.is_sorted() } else { inner.rev().is_sorted() });
            }
            let split = builder == EmbreeBuilder::FastSpatial;
            assert!(split || statistics.references == mesh.len());
        }
    }

    #[test]
    fn trees_as_read_cost_what_embree_prints() {
        for count in [1, 4, 5, 100, 6000] {
            read_and_compare::<4>(&soup(count), Width::Four);
            read_and_compare::<8>(&soup(count), Width::Eight);
        }
    }

    #[test]
    fn the_other_width_and_other_meshes_are_refused() {
        let mesh = soup(1000);
        let device =
            Device::new(&Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 1 }).unwrap();
        let scene = device.prepare(&mesh).unwrap().commit().unwrap();
        assert!(read8(&scene).unwrap_err().why.contains("type 3"));
        // SAFETY: the scene lives.
        let root = unsafe { RootSlot::find::<4>(&scene).unwrap().get() };
        // SAFETY: the root of a 4-wide tree, checked as in `read`.
        let with = |mesh: &Mesh| unsafe { walk::<4>(root, scene.bounds(), mesh) };
        assert!(with(&mesh).is_ok());
        assert!(with(&soup(999)).unwrap_err().why.contains("a leaf names triangle 999"));
        assert!(with(&soup(1001)).unwrap_err().why.contains("triangle 1000 is in no leaf"));
        let mirrored = mesh.vertices().iter().map(|[x, y, z]| [*x, *z, *y]).collect();
        let mirrored = Mesh::new(mirrored, mesh.triangles().to_vec()).unwrap().0;
        assert!(with(&mirrored).unwrap_err().why.contains("not those of the mesh"));
    }

    #[test]
    fn an_empty_scene_has_an_empty_tree() {
        let mesh = soup(0);
        let device =
            Device::new(&Config { builder: EmbreeBuilder::Sah, width: Width::Eight, threads: 1 }).unwrap();
        let scene = device.prepare(&mesh).unwrap().commit().unwrap();
        assert_eq!(read8(&scene).unwrap(), Bvh8::default());
    }
}
