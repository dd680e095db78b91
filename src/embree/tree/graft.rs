//! Any tree of ours under Embree's own kernels: laid out as Embree's nodes and leaves and set as the root of a
//! committed scene.
//!
//! A measuring instrument, which writes to a private field of Embree. Placement of nodes in memory costs
//! traversal several per cent, so every tree, Embree's own included (see [`super::native`]), goes through one
//! routine: inner nodes and leaves in two arrays, both depth first.

#![allow(unsafe_code)]

use super::layout::{RootSlot, Unavailable};
use super::node_image::NodeImage;
use crate::bvh::WideBvh;
use crate::embree::EmbreeScene;
use crate::geometry::{Hit, Ray, Tracer};

/// A committed scene whose root is another tree's, traced by Embree's kernels.
pub struct Graft<'a> {
    scene: EmbreeScene<'a>,
    /// Place of the root and its original value; none in a scene without triangles, where Embree has no tree.
    host: Option<(RootSlot, u64)>,
    bytes: usize,
    /// The nodes that the root refers to; dropped after the scene.
    _image: Box<dyn Send + Sync>,
}

impl<'a> Graft<'a> {
    /// Sets `tree`, over the mesh of `scene`, as the root of `scene`. The scene's own tree must be as wide;
    /// which builder made it does not matter.
    ///
    /// # Errors
    /// [`Unavailable`] where Embree is another version, a guard does not hold, or Embree's kernels could not
    /// walk the tree.
    pub fn new<const N: usize>(scene: EmbreeScene<'a>, tree: &WideBvh<N>) -> Result<Self, Unavailable> {
        let image = NodeImage::of(tree, scene.mesh().len())?;
        let bytes = image.bytes();
        let mut host = None;
        if !scene.mesh().is_empty() {
            let mut slot = RootSlot::find::<N>(&scene)?;
            // SAFETY: the scene is owned here.
            let original = unsafe { slot.get() };
            // SAFETY: `NodeImage::of` made a whole tree in Embree's layout, which lives in this graft and is never
            // changed; the scene is owned here, so no other thread traces it; `drop` restores the root, and no method
            // of a committed scene commits again.
            unsafe { slot.set(image.root()) };
            host = Some((slot, original));
        }
        Ok(Self { scene, host, bytes, _image: Box::new(image) })
    }

    /// Bytes of the nodes and leaves in Embree's layout.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// The scene, which traces the tree set here.
    pub fn scene(&self) -> &EmbreeScene<'a> {
        &self.scene
    }
}

impl Drop for Graft<'_> {
    fn drop(&mut self) {
        if let Some((slot, original)) = &mut self.host {
            // SAFETY: the scene's own root, whose nodes live as long as the scene; nobody else has the scene.
            unsafe { slot.set(*original) };
        }
    }
}

impl Tracer for Graft<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.scene.closest(rays, hits);
    }

    fn any(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.scene.any(rays, occluded);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Bvh4, Bvh8, Link, MAX_DEPTH, TriangleBlock, WideNode};
    use crate::embree::test_meshes::{rays, soup};
    use crate::embree::tree::layout::Node;
    use crate::embree::{Config, Device, EmbreeBuilder, Width, native};
    use crate::geometry::Mesh;

    fn trace(tracer: &dyn Tracer, rays: &[Ray]) -> (Vec<Hit>, Vec<bool>) {
        let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        tracer.closest(rays, &mut hits);
        tracer.any(rays, &mut occluded);
        (hits, occluded)
    }

    /// The tree with its nodes and blocks in depth-first order, as a graft has it.
    fn read_back<const N: usize>(
        scene: EmbreeScene<'_>,
        rays: &[Ray],
        read: impl Fn(&EmbreeScene<'_>) -> Result<WideBvh<N>, Unavailable>,
    ) {
        let expected = trace(&scene, rays);
        let tree = read(&scene).unwrap();
        let graft = Graft::new(scene, &tree).unwrap();
        assert!(trace(&graft, rays) == expected, "hits differ");
        assert_eq!(read(graft.scene()).unwrap(), tree);
        assert_eq!(graft.bytes(), tree.nodes.len() * size_of::<Node<N>>() + tree.blocks.len() * 176);
    }

    #[test]
    fn trees_read_and_set_back_give_the_very_same_hits() {
        for (count, rays) in [(0, rays(100)), (1, rays(100)), (6, rays(100)), (3000, rays(100_000))] {
            let mesh = soup(count);
            for width in Width::ALL {
                for builder in EmbreeBuilder::ALL {
                    let device = Device::new(&Config { builder, width, threads: 2 }).unwrap();
                    let scene = device.prepare(&mesh).unwrap().commit().unwrap();
                    match width {
                        Width::Four => read_back(scene, &rays, native::read4),
                        Width::Eight => read_back(scene, &rays, native::read8),
                    }
                    assert_eq!(device.memory().live_bytes, 0);
                }
            }
        }
    }

    fn device(width: Width) -> Device {
        Device::new(&Config { builder: EmbreeBuilder::Morton, width, threads: 1 }).unwrap()
    }

    /// A tree of one node with one leaf block of each of two triangles.
    fn two_leaves<const N: usize>(mesh: &Mesh) -> WideBvh<N> {
        let mut node = WideNode::EMPTY;
        let mut blocks = Vec::new();
        for prim in 0..2 {
            let mut block = TriangleBlock::EMPTY;
            block.set(0, mesh.corners(prim), prim);
            blocks.push(block);
            node.set(prim as usize, mesh.bounds_of(prim), Link::leaf(prim as usize, 1));
        }
        WideBvh { root: Link::inner(0), bounds: mesh.bounds(), nodes: vec![node], blocks }
    }

    fn hand_made_tree<const N: usize>(width: Width) {
        let (mesh, device, rays) = (soup(2), device(width), rays(20_000));
        let expected = trace(&device.prepare(&mesh).unwrap().commit().unwrap(), &rays);
        assert!(expected.1.contains(&true));
        let host = || device.prepare(&mesh).unwrap().commit().unwrap();
        assert_eq!(trace(&Graft::new(host(), &two_leaves::<N>(&mesh)).unwrap(), &rays), expected);
        // Without its second leaf, and without any, the tree is missed where those were hit.
        let mut half = two_leaves::<N>(&mesh);
        half.nodes[0].links[1] = Link::EMPTY;
        let hits = trace(&Graft::new(host(), &half).unwrap(), &rays).0;
        for (hit, whole) in hits.iter().zip(&expected.0).filter(|(_, whole)| whole.prim != 1) {
            assert_eq!(hit, whole);
        }
        assert!(hits.iter().all(|hit| hit.prim != 1));
        let none = WideBvh::<N> { root: Link::EMPTY, ..half };
        assert!(!trace(&Graft::new(host(), &none).unwrap(), &rays).1.contains(&true));
    }

    #[test]
    fn a_hand_made_tree_is_traced() {
        hand_made_tree::<4>(Width::Four);
        hand_made_tree::<8>(Width::Eight);
    }

    #[test]
    fn the_root_is_restored() {
        let (mesh, device) = (soup(500), device(Width::Four));
        let scene = device.prepare(&mesh).unwrap().commit().unwrap();
        let slot = RootSlot::find::<4>(&scene).unwrap();
        // SAFETY: the scene lives until it is grafted, and then in the graft.
        let root = || unsafe { slot.get() };
        let (before, tree) = (root(), native::read4(&scene).unwrap());
        let mut graft = Graft::new(scene, &tree).unwrap();
        assert_ne!(root(), before);
        let (kept, original) = graft.host.as_mut().unwrap();
        assert_eq!(*original, before);
        // SAFETY: as in `drop`, which does this once more.
        unsafe { kept.set(*original) };
        assert_eq!(native::read4(graft.scene()).unwrap(), tree);
    }

    #[test]
    fn trees_that_cannot_be_walked_are_refused() {
        let (mesh, device) = (soup(2), device(Width::Four));
        let refuse = |tree: &Bvh4, why: &str| {
            let host = device.prepare(&mesh).unwrap().commit().unwrap();
            let error = Graft::new(host, tree).map(drop).unwrap_err();
            assert!(error.why.contains(why), "{error}");
        };
        let good: Bvh4 = two_leaves(&mesh);
        let mut bad = good.clone();
        bad.nodes[0].links[1] = Link::inner(7);
        refuse(&bad, "no node 7");
        bad.nodes[0].links[1] = Link::inner(0);
        refuse(&bad, "two parents");
        bad.nodes[0].links[1] = Link::leaf(1, 2);
        refuse(&bad, "no block 2");
        bad.nodes[0].links[2] = Link::leaf(0, 2);
        refuse(&Bvh4 { nodes: bad.nodes.clone(), ..good.clone() }, "no block 2");
        bad.nodes[0].links[1] = Link::leaf(0, 2);
        refuse(&bad, "two leaves");
        bad.nodes[0].links[0] = Link::EMPTY;
        refuse(&bad, "gap");
        let mut bad = good.clone();
        bad.blocks[1].prims[0] = 2;
        refuse(&bad, "no triangle 2");
        let mut deep = good.clone();
        deep.nodes = (0..=MAX_DEPTH)
            .map(|level| {
                let mut node = WideNode::EMPTY;
                let link = if level == MAX_DEPTH { Link::leaf(0, 2) } else { Link::inner(level + 1) };
                node.set(0, mesh.bounds(), link);
                node
            })
            .collect();
        refuse(&deep, "more than 80 levels");
        deep.nodes[MAX_DEPTH - 1].links[0] = Link::leaf(0, 2);
        let host = device.prepare(&mesh).unwrap().commit().unwrap();
        let rays = rays(5000);
        let expected = trace(&host, &rays);
        assert_eq!(trace(&Graft::new(host, &deep).unwrap(), &rays), expected);
        let host = device.prepare(&mesh).unwrap().commit().unwrap();
        let eight: Bvh8 = two_leaves(&mesh);
        assert!(Graft::new(host, &eight).map(drop).unwrap_err().why.contains("type 3"));
        let config = Config { threads: 1, width: Width::Four, builder: EmbreeBuilder::Sah };
        let robust = Device::robust(&config).unwrap().prepare(&mesh).unwrap().robust().commit().unwrap();
        assert!(Graft::new(robust, &good).map(drop).unwrap_err().why.contains("whole triangles"));
    }
}
