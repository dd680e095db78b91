//! LBVH (Lauterbach et al. 2009) as the paper builds it in 4.7: Morton codes, a parallel sort, and a tree that
//! parts each run of codes where their highest bit changes. Three changes: the sort is a radix sort; boxes are
//! united on the way up instead of by atomic counters; and references that share a code are parted by the
//! middle of their own centroids' bounds, so that 32 bits suffice for any scene.

use crate::builders::binary::{BinaryTree, Node};
use crate::builders::builder::{Phase, Stopwatch};
use crate::builders::lbvh::area_scale::Areas;
use crate::builders::lbvh::sort::MortonOrder;
use crate::builders::lbvh::top_tree::{self, Upper};
use crate::builders::lbvh::treelet::{Leaves, Run};
use crate::builders::prims::presplit::PresplitConfig;
use crate::geometry::Mesh;
use crate::memory::huge_pages;
use crate::parallel::ordered_append::{self, Spare};
use std::sync::OnceLock;

/// Which subtrees of the auxiliary BVH are leaves beside those of few references: near the leaves nothing is lost
/// by opening them all at once, where they are small.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Clusters {
    /// Most references of a cluster.
    pub most: u32,
    /// Largest area of its box, relative to the scene's ([`super::PhrConfig::calibration`]).
    pub area: f32,
}

/// Parameters of the auxiliary BVH.
#[derive(Clone, Copy)]
pub(crate) struct AuxiliaryConfig {
    /// Which triangles are split before the sort.
    pub presplit: Option<PresplitConfig>,
    /// Subtrees of at most so many references are leaves,
    pub leaf: u32,
    /// and these.
    pub clusters: Option<Clusters>,
    /// Areas are relative to so many times that of a part of the scene ([`Areas::calibrated`]), not to the scene's.
    pub calibration: Option<f32>,
}

impl AuxiliaryConfig {
    /// That of the paper.
    pub const PAPER: Self = Self { presplit: None, leaf: 1, clusters: None, calibration: None };

    fn leaves(&self, areas: &Areas) -> Leaves {
        let clusters = self.clusters.unwrap_or(Clusters { most: self.leaf, area: 0.0 });
        Leaves { always: self.leaf, most: clusters.most, area: clusters.area * areas.reference }
    }
}

/// The auxiliary BVH with all it is made from; its memory is reused from build to build.
#[derive(Default)]
pub(crate) struct Auxiliary {
    /// The references in order.
    pub order: MortonOrder,
    /// The tree.
    pub tree: BinaryTree,
    /// What thresholds are relative to.
    pub areas: Areas,
    spare: Spare<Run>,
}

impl Auxiliary {
    /// Builds the LBVH of `mesh`.
    pub fn build(&mut self, mesh: &Mesh, config: &AuxiliaryConfig) -> Vec<Phase> {
        let mut watch = Stopwatch::start();
        self.order.sort(mesh, config.presplit.as_ref(), &mut self.tree.pairs, &mut watch);
        // Parting equal codes reorders keys.
        let mut all_keys = std::mem::take(&mut self.order.keys);
        let keys = &mut all_keys[..];
        let references = &self.order.references(mesh);
        self.areas = match config.calibration {
            Some(parts) => Areas::calibrated(self.order.bounds(), keys, references, parts),
            None => Areas::of(self.order.bounds()),
        };
        let leaves = config.leaves(&self.areas);
        self.tree.root = None;
        if !keys.is_empty() {
            // Of leaves of several references about half are full.
            let pairs = keys.len().div_ceil(leaves.always as usize) * if leaves.always == 1 { 1 } else { 2 };
            huge_pages::reserve(&mut self.tree.pairs, pairs + pairs / 1000 + 64);
            let upper = Upper::part(references, keys);
            let built: Vec<OnceLock<(Node, usize)>> = (0..upper.len()).map(|_| OnceLock::new()).collect();
            let all_pairs = &mut self.tree.pairs;
            ordered_append::append(
                upper.len(),
                &self.spare,
                all_pairs,
                &mut Vec::new(),
                |i, run: &mut Run| {
                    let (first, depth, mut keys) = upper.run(i);
                    let root = run.build(references, &mut keys, first, depth, leaves);
                    built[i].set((root, run.tree.pairs.len())).expect("each task runs once");
                },
            );
            let mut begin = 0;
            let runs: Vec<Node> = built
                .into_iter()
                .map(|built| {
                    let (root, pairs) = built.into_inner().expect("all tasks have run");
                    begin += pairs;
                    root.moved((begin - pairs) as u32)
                })
                .collect();
            let pairs = upper.fold(&runs, |children| {
                all_pairs.push(children);
                Node::inner(&children, all_pairs.len() - 1)
            });
            self.tree.root = Some(*top_tree::of(upper.top(), &runs, &pairs));
        }
        self.order.keys = all_keys;
        watch.lap("auxiliary tree");
        watch.phases
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let mut runs = 0;
        self.spare.for_each(|run| runs += run.bytes());
        self.order.bytes() + self.tree.bytes() + runs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::lbvh::sort::{code, part, reference};
    use crate::builders::prims::refs::References;
    use crate::geometry::Aabb;

    fn triangles(n: usize, place: impl Fn(usize) -> [f32; 3]) -> Mesh {
        let vertices = (0..n).flat_map(|i| {
            let [x, y, z] = place(i);
            [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z]]
        });
        Mesh::new(vertices.collect(), (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
            .unwrap()
            .0
    }

    fn walk(
        auxiliary: &Auxiliary,
        references: &References<'_>,
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
                auxiliary.build(&mesh, &AuxiliaryConfig { leaf, ..AuxiliaryConfig::PAPER });
                let references = auxiliary.order.references(&mesh);
                let root = auxiliary.tree.root.unwrap();
                let mut seen = Vec::new();
                let depth = walk(&auxiliary, &references, &root, &mut seen, leaf);
                seen.sort_unstable();
                assert_eq!(seen, (0..n as u32).collect::<Vec<_>>(), "{name}");
                assert!(depth <= 44 + 28, "{name}: {depth}");
                if leaf == 1 {
                    assert_eq!(auxiliary.tree.pairs.len(), n - 1);
                }
            }
        }
    }

    #[test]
    fn runs_part_where_bisection_parts_them() {
        // Few distinct codes per axis: many equal ones, and neighbours that differ in any bit.
        let mesh = triangles(3000, |i| [(i * i % 61) as f32, (i * 13 % 17) as f32, (i % 5) as f32 * 0.1]);
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(&mesh, &AuxiliaryConfig::PAPER);
        let references = auxiliary.order.references(&mesh);
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
                assert_eq!(left.count() as usize, part(keys, &references, &mut 0));
                checked += 1;
            }
            stack.extend([(left, first), (right, first + left.count() as usize)]);
        }
        assert!(checked > 500);
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
