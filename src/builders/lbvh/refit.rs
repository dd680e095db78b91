//! Refitting the auxiliary BVH to a mesh that has moved: the order of the references and the tree over them stay,
//! boxes and scales of area are made anew.

use super::area_scale::AreaScale;
use super::auxiliary::Auxiliary;
use super::config::AuxiliaryConfig;
use super::key::reference;
use super::prefetch;
use crate::builders::api::builder::Stopwatch;
use crate::builders::wide::refit::RefitError;
use crate::geometry::{Aabb, Mesh};

impl Auxiliary {
    /// Fits the tree to `mesh`, the one it was built over with vertices moved; the stopwatch goes on.
    ///
    /// # Errors
    /// A mesh of another number of triangles, and presplit needles.
    pub fn refit(&mut self, mesh: &Mesh, config: &AuxiliaryConfig) -> Result<Stopwatch, RefitError> {
        let mut watch = Stopwatch::start(mesh.len());
        let Self { order, tree, scale, .. } = self;
        let refs = order.refs(mesh);
        if !refs.fragments.is_empty() {
            return Err(RefitError::Presplit);
        }
        if order.keys.len() != mesh.len() {
            return Err(RefitError::Triangles { tree: order.keys.len(), mesh: mesh.len() });
        }
        tree.refit(|run| {
            prefetch::ahead(mesh, &order.keys, run.start);
            order.keys[run].iter().map(|&key| mesh.bounds_of(reference(key))).collect()
        });
        let bounds = tree.root.map_or(Aabb::EMPTY, |root| root.bounds());
        *scale = AreaScale::in_order(bounds, &order.keys, &refs, config.calibration);
        watch.lap("auxiliary refit");
        Ok(watch)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::binary::tree::MOST_DIVIDED_LEVELS;
    use crate::builders::lbvh::config::Clusters;
    use crate::builders::phr::extensions::auxiliary_tree::AuxiliaryTree;
    use crate::builders::phr::extensions::binned::config::BinnedSahConfig;
    use crate::builders::prims::presplit::PresplitConfig;
    use crate::builders::testing;
    use crate::scene::scalable;
    use crate::simd::Isa;
    use glam::Vec3;

    /// The same mesh, each vertex moved by a wave.
    fn moved(mesh: &Mesh) -> Mesh {
        let mut moved = mesh.clone();
        let wave = |&[x, y, z]: &[f32; 3]| [x + 3.0 * (0.4 * y).sin(), y + 2.0 * (0.3 * x).cos(), z * 1.5];
        moved.move_vertices(&mesh.vertices().iter().map(wave).collect::<Vec<_>>()).unwrap();
        moved
    }

    /// Each node has the box of what is below; returns the levels.
    fn assert_boxes(auxiliary: &Auxiliary, mesh: &Mesh) -> u32 {
        let mut pending: Vec<_> = auxiliary.tree.root.into_iter().map(|root| (root, 1)).collect();
        let mut levels = 0;
        while let Some((node, level)) = pending.pop() {
            levels = levels.max(level);
            let run = auxiliary.tree.run(&node);
            let below = auxiliary.order.keys[run].iter();
            let bounds: Aabb = below.map(|&key| mesh.bounds_of(reference(key))).collect();
            assert_eq!(bounds, node.bounds());
            if !node.is_leaf() {
                pending.extend(auxiliary.tree.children(&node).map(|child| (child, level + 1)));
            }
        }
        levels
    }

    /// Each level splits off one of the far triangles, so that the near ones are a large subtree far below the root.
    #[test]
    fn a_large_subtree_far_below_the_root_is_refitted() {
        let mesh = testing::mesh(20_070, 1, |i, _| {
            let x = if i < 70 { 3f32.powi(35 - i as i32) } else { (i - 70) as f32 * 1e-25 };
            [Vec3::new(x, 0.0, 0.0), Vec3::new(x, 1.0, 0.0), Vec3::new(x, 0.0, 1.0)]
        });
        let (mut auxiliary, config) = (Auxiliary::default(), AuxiliaryConfig::PAPER);
        let tree = AuxiliaryTree::BinnedSah(BinnedSahConfig { bins: 2 });
        tree.build(&mut auxiliary, (&mesh, 0..mesh.len() as u32), &config, Isa::best());
        auxiliary.refit(&mesh, &config).unwrap();
        assert!(assert_boxes(&auxiliary, &mesh) > MOST_DIVIDED_LEVELS);
    }

    #[test]
    fn boxes_are_those_of_the_references_below() {
        let clusters = Some(Clusters { most: 32, area: 1e-3 });
        let configs = [
            AuxiliaryConfig::PAPER,
            AuxiliaryConfig {
                auxiliary_leaf: Some(4),
                clusters,
                calibration: Some(1e3),
                ..AuxiliaryConfig::PAPER
            },
        ];
        for n in [0, 1, 2, 3000, 30_000] {
            let mesh = scalable(n, 1).mesh;
            let moved = moved(&mesh);
            for (config, tree) in configs.iter().flat_map(|config| {
                [AuxiliaryTree::Lbvh, AuxiliaryTree::BinnedSah(BinnedSahConfig::DEFAULT)].map(|t| (config, t))
            }) {
                let mut auxiliary = Auxiliary::default();
                tree.build(&mut auxiliary, (&mesh, 0..n as u32), config, Isa::best());
                let scale = auxiliary.scale;
                auxiliary.refit(&moved, config).unwrap();
                assert_boxes(&auxiliary, &moved);
                assert!(n == 0 || auxiliary.scale != scale);
                auxiliary.refit(&mesh, config).unwrap();
                assert_eq!(auxiliary.scale, scale, "moved back");
            }
        }
    }

    #[test]
    fn another_mesh_and_pieces_of_triangles_are_refused() {
        let mesh = scalable(3000, 1).mesh;
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(&mesh, &AuxiliaryConfig::PAPER);
        let other = scalable(2999, 1).mesh;
        let refused = auxiliary.refit(&other, &AuxiliaryConfig::PAPER).unwrap_err();
        assert_eq!(refused, RefitError::Triangles { tree: 3000, mesh: 2999 });
        let config = AuxiliaryConfig { presplit: Some(PresplitConfig::NEEDLES), ..AuxiliaryConfig::PAPER };
        let needles = testing::mesh(2000, 1, |i, random| {
            let at = random.point(0.0, 1000.0);
            match i {
                7 => [Vec3::ZERO, Vec3::splat(1000.0), Vec3::new(1e-3, 0.0, 0.0)],
                _ => [at, at + Vec3::X, at + Vec3::Y],
            }
        });
        auxiliary.build(&needles, &config);
        assert_eq!(auxiliary.refit(&needles, &config).unwrap_err(), RefitError::Presplit);
    }
}
