//! Paper 4.7: the auxiliary BVH, an LBVH (Lauterbach et al. 2009): Morton codes, a parallel sort, and a tree that
//! partitions each run of codes where their highest bit changes.
//!
//! Three changes: the sort is a radix sort of all 32 bits, not by the highest 12 ([`AuxiliaryConfig::bucket_sort`]
//! is the paper's); boxes are merged on the way up instead of by atomic counters; and references that share a code
//! are partitioned by the middle of their own centroids' bounds, so that 32 bits suffice for any scene.

use super::area_scale::AreaScale;
use super::config::AuxiliaryConfig;
use super::key::MortonKey;
use super::sort::MortonOrder;
use super::top_tree::{Treelet, top_tree};
use super::treelet::{LbvhTreelet, LeafRule};
use crate::builders::api::builder::Stopwatch;
use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::memory::huge_pages;
use crate::memory::pool::Pool;
use crate::parallel::ordered_append::{self, Offset};
use std::ops::Range;

/// The auxiliary BVH with all it is made from; its memory is reused from build to build.
#[derive(Default)]
pub(crate) struct Auxiliary {
    /// The references in order.
    pub order: MortonOrder,
    /// The tree.
    pub tree: BinaryTree,
    /// Whether compact leaves are finished ([`super::direct::clusters`]).
    pub has_finished_leaves: bool,
    /// What thresholds of area are relative to.
    pub scale: AreaScale,
    treelets: Pool<LbvhTreelet>,
}

impl Auxiliary {
    /// Builds the LBVH of `geometry`; the stopwatch goes on.
    pub fn build<G: Geometry>(&mut self, geometry: &G, config: &AuxiliaryConfig) -> Stopwatch {
        let mut watch = Stopwatch::start(geometry.len());
        self.sort(geometry, geometry.prims(), config, &mut watch);
        self.grow_lbvh(geometry, config, &mut watch);
        watch
    }

    /// Presplits needles among some primitives of `geometry`, and sorts the references to all of them, in the memory
    /// of the nodes that are going to be made of them.
    pub fn sort<G: Geometry>(
        &mut self,
        geometry: &G,
        prims: Range<u32>,
        config: &AuxiliaryConfig,
        watch: &mut Stopwatch,
    ) {
        self.order.take_up(geometry, prims.clone(), config.presplit.as_ref(), watch);
        let references = prims.len() + self.order.extra_references();
        reserve_pairs(&mut self.tree.pairs, references, config.leaf());
        self.order.sort(geometry, prims, config.sort().0, &mut self.tree.pairs, watch);
    }

    /// Makes the LBVH over them.
    pub fn grow_lbvh<G: Geometry>(&mut self, geometry: &G, config: &AuxiliaryConfig, watch: &mut Stopwatch) {
        let treelets = std::mem::take(&mut self.treelets);
        let (_, depth) = config.sort();
        self.grow(geometry, config, watch, |refs, keys, rule, BinaryTree { pairs, .. }| {
            reserve_pairs(pairs, keys.len(), rule.always);
            let (top, tasks) = top_tree(refs, keys, depth);
            let make = |i: usize, treelet: &mut LbvhTreelet| {
                let Treelet { first, depth, keys } = tasks.take(i);
                treelet.build(refs, keys, first, depth, rule)
            };
            let built = ordered_append::append(tasks.len(), &treelets, pairs, &mut Vec::new(), make);
            let moved = |(root, [first, _]): (Node, Offset)| root.moved(first as u32);
            let roots: Vec<Node> = built.into_iter().map(moved).collect();
            top.fold(&roots, &mut |children| Node::join([children[0], children[1]], pairs))
        });
        self.treelets = treelets;
    }

    /// Has `grow` make the tree over one or more sorted references, of which it returns the root: leaves are small
    /// by the rule, and runs of the keys, which are put into the order of the tree.
    pub fn grow<G: Geometry>(
        &mut self,
        geometry: &G,
        config: &AuxiliaryConfig,
        watch: &mut Stopwatch,
        grow: impl FnOnce(&PrimRefs<'_, G>, &mut Vec<MortonKey>, LeafRule, &mut BinaryTree) -> Node,
    ) {
        // Equal codes are partitioned by reordering keys.
        let mut keys = std::mem::take(&mut self.order.keys);
        let refs = self.order.refs(geometry);
        self.scale = AreaScale::in_order(self.order.bounds(), &keys, &refs, config.calibration);
        self.tree.root = None;
        if !keys.is_empty() {
            let rule = config.rule(&self.scale);
            self.tree.root = Some(grow(&refs, &mut keys, rule, &mut self.tree));
        }
        self.order.keys = keys;
        watch.lap("auxiliary tree");
    }
}

/// Room for the nodes over so many references, if up to `leaf` of them always become a leaf.
fn reserve_pairs(pairs: &mut Vec<[Node; 2]>, references: usize, leaf: u32) {
    // Of leaves of several references about half are full.
    let most = references.div_ceil(leaf as usize) * if leaf == 1 { 1 } else { 2 };
    huge_pages::reserve(pairs, most + most / 1000 + 64, "the auxiliary tree");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::lbvh::config::Clusters;
    use crate::builders::lbvh::key::{code, reference};
    use crate::builders::lbvh::partition::partition;
    use crate::builders::testing::mesh;
    use crate::geometry::{Aabb, Mesh};
    use glam::Vec3;

    fn triangles(n: usize, place: impl Fn(usize) -> [f32; 3]) -> Mesh {
        mesh(n, 0, |i, _| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| Vec3::from(place(i)) + corner))
    }

    fn walk(
        auxiliary: &Auxiliary,
        references: &PrimRefs<'_>,
        node: &Node,
        seen: &mut Vec<u32>,
        leaf: u32,
    ) -> u32 {
        if node.is_leaf() {
            assert!((1..=leaf).contains(&node.count()));
            let ids: Vec<u32> = auxiliary.order.keys[node.run()].iter().map(|&key| reference(key)).collect();
            let bounds: Aabb = ids.iter().map(|&id| references.bounds(id)).collect();
            assert_eq!(bounds, node.bounds());
            seen.extend(ids);
            return 0;
        }
        let children = auxiliary.tree.children(node);
        assert_eq!(node.count(), children[0].count() + children[1].count());
        assert!(node.count() > leaf);
        assert_eq!(children[0].bounds().union(children[1].bounds()), node.bounds());
        1 + children.iter().map(|child| walk(auxiliary, references, child, seen, leaf)).max().unwrap()
    }

    #[test]
    fn every_triangle_is_in_a_leaf_and_depth_is_bounded() {
        type Placement = fn(usize) -> [f32; 3];
        let placements: [(&str, Placement); 4] = [
            ("spread", |i| [(i * 7919 % 1000) as f32, (i * 104_729 % 991) as f32, (i % 13) as f32]),
            ("identical", |_| [1.0, 2.0, 3.0]),
            ("geometric", |i| [2.0f32.powi(i as i32 % 120 - 60), 0.0, 0.0]),
            ("two clusters", |i| if i % 2 == 0 { [0.0, 0.0, i as f32 * 1e-6] } else { [1e15, 0.0, 0.0] }),
        ];
        for (name, place) in placements {
            for (n, leaf) in
                [(1, 1), (2, 1), (3, 1), (100, 1), (5000, 1), (20_000, 1), (20_000, 4), (9, 4), (3, 4)]
            {
                let mesh = triangles(n, place);
                let mut auxiliary = Auxiliary::default();
                let (bucket_sort, auxiliary_leaf) = (n % 2 == 1 || leaf == 4, Some(leaf));
                let config = AuxiliaryConfig { bucket_sort, auxiliary_leaf, ..AuxiliaryConfig::PAPER };
                auxiliary.build(&mesh, &config);
                let references = auxiliary.order.refs(&mesh);
                let mut seen = Vec::new();
                let depth = walk(&auxiliary, &references, &auxiliary.tree.root.unwrap(), &mut seen, leaf);
                seen.sort_unstable();
                assert_eq!(seen, (0..n as u32).collect::<Vec<_>>(), "{name}");
                assert!(depth <= 44 + 28, "{name}: {depth}");
                assert!(leaf > 1 || auxiliary.tree.pairs.len() == n - 1);
            }
        }
    }

    #[test]
    fn treelets_are_partitioned_as_by_definition() {
        // Few distinct codes per axis: many equal ones, and neighbours that differ in any bit.
        let mesh = triangles(3000, |i| [(i * i % 61) as f32, (i * 13 % 17) as f32, (i % 5) as f32 * 0.1]);
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(&mesh, &AuxiliaryConfig::PAPER);
        let references = auxiliary.order.refs(&mesh);
        let mut checked = 0;
        let mut stack = vec![(auxiliary.tree.root.unwrap(), 0)];
        while let Some((node, first)) = stack.pop() {
            if node.is_leaf() {
                assert_eq!(node.run().start, first);
                continue;
            }
            let keys = &mut auxiliary.order.keys.clone()[first..first + node.count() as usize];
            let [left, right] = *auxiliary.tree.children(&node);
            if code(keys[0]) != code(keys[keys.len() - 1]) {
                assert_eq!(left.count() as usize, partition(keys, &references, &mut 0));
                checked += 1;
            }
            stack.extend([(left, first), (right, first + left.count() as usize)]);
        }
        assert!(checked > 500);
    }

    #[test]
    fn buckets_keep_the_order_of_the_mesh_and_are_halved() {
        let mesh = triangles(20_000, |i| [(i % 40) as f32, (i * 7 % 30) as f32, (i % 3) as f32]);
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(&mesh, &AuxiliaryConfig { bucket_sort: true, ..AuxiliaryConfig::PAPER });
        let keys = &auxiliary.order.keys;
        assert!(keys.is_sorted() && keys.iter().all(|&key| code(key).trailing_zeros() >= 20));
        let (mut stack, mut halved) = (vec![(auxiliary.tree.root.unwrap(), 0)], 0);
        while let Some((node, first)) = stack.pop() {
            if node.is_leaf() {
                continue;
            }
            let [left, right] = *auxiliary.tree.children(&node);
            let (middle, end) = (first + left.count() as usize, first + node.count() as usize);
            if code(keys[first]) == code(keys[end - 1]) {
                assert_eq!(left.count(), node.count() / 2);
                halved += 1;
            } else {
                assert_ne!(code(keys[middle - 1]), code(keys[middle]));
            }
            stack.extend([(left, first), (right, middle)]);
        }
        assert!(halved > 10_000);
    }

    #[test]
    fn clusters_are_no_smaller_than_leaves() {
        let clusters = Some(Clusters { most: 1, area: 1.0 });
        let config = AuxiliaryConfig { auxiliary_leaf: Some(4), clusters, ..AuxiliaryConfig::PAPER };
        assert_eq!(config.max_leaf(), 4);
    }

    #[test]
    fn memory_is_reused_for_a_smaller_mesh() {
        let mut auxiliary = Auxiliary::default();
        for n in [1000, 10, 0] {
            let mesh = triangles(n, |i| [i as f32, 0.0, 0.0]);
            auxiliary.build(&mesh, &AuxiliaryConfig::PAPER);
            assert_eq!(auxiliary.tree.root.map_or(0, |root| root.count()), n as u32);
        }
    }
}
