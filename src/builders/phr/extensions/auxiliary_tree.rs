//! Other auxiliary trees than an LBVH (paper 5.5 tried AAC and binned SAH). They are over the same sorted
//! references, and are brought into the form of an LBVH, with leaves by its rules, so that cuts need not know which
//! tree they are of.

use crate::builders::api::builder::Stopwatch;
use crate::builders::api::config_error::ConfigError;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::clusters::aac::clustering::cluster;
use crate::builders::clusters::aac::config::AacConfig;
use crate::builders::clusters::in_order::in_order;
use crate::builders::clusters::ploc::clustering::Clustering;
use crate::builders::clusters::ploc::config::PlocConfig;
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::lbvh::config::AuxiliaryConfig;
use crate::builders::phr::extensions::binned::config::BinnedSahConfig;
use crate::builders::phr::extensions::binned::tree::binned_sah;
use crate::builders::prims::geometry::Geometry;
use crate::simd::Isa;
use std::ops::Range;

/// Which builder makes the auxiliary tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum AuxiliaryTree {
    /// LBVH, as in the paper.
    #[default]
    Lbvh,
    /// PLOC (Meister and Bittner 2018).
    Ploc(PlocConfig),
    /// AAC (Gu et al. 2013).
    Aac(AacConfig),
    /// Binned SAH (Wald 2007).
    BinnedSah(BinnedSahConfig),
}

impl AuxiliaryTree {
    /// Whether it is the paper's.
    pub(crate) fn is_lbvh(&self) -> bool {
        *self == Self::Lbvh
    }

    /// Refuses parameters out of range.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        match self {
            Self::Lbvh => Ok(()),
            Self::Ploc(config) => config.check().map_err(|error| error.within("ploc")),
            Self::Aac(config) => config.check().map_err(|error| error.within("aac")),
            Self::BinnedSah(config) => config.check().map_err(|error| error.within("binned-sah")),
        }
    }

    /// Sorts some primitives of a geometry and grows the auxiliary tree over them; the stopwatch goes on.
    pub(crate) fn build<G: Geometry>(
        &self,
        auxiliary: &mut Auxiliary,
        (geometry, prims): (&G, Range<u32>),
        config: &AuxiliaryConfig,
        isa: Isa,
    ) -> Stopwatch {
        let mut watch = Stopwatch::start(prims.len());
        auxiliary.sort(geometry, prims, config, &mut watch);
        self.grow(auxiliary, geometry, config, isa, &mut watch);
        watch
    }

    /// Grows the auxiliary tree over sorted references.
    pub(crate) fn grow<G: Geometry>(
        &self,
        auxiliary: &mut Auxiliary,
        geometry: &G,
        config: &AuxiliaryConfig,
        isa: Isa,
        watch: &mut Stopwatch,
    ) {
        if self.is_lbvh() {
            return auxiliary.grow_lbvh(geometry, config, watch);
        }
        // Memory of trees that are no LBVH is not kept.
        auxiliary.grow(geometry, config, watch, |refs, keys, rule, tree| {
            let mut made = BinaryTree::default();
            let pairs = &mut made.pairs;
            made.root = match self {
                Self::Lbvh => None,
                Self::Ploc(config) => Clustering::default().cluster((config.radius, isa), refs, keys, pairs),
                Self::Aac(config) => cluster(config, refs, keys, pairs),
                Self::BinnedSah(config) => binned_sah(config, refs, keys, pairs),
            };
            *keys = in_order(&made, keys, rule, tree);
            tree.root.expect("there are references")
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::binary::node::Node;
    use crate::builders::lbvh::config::Clusters;
    use crate::builders::lbvh::key::reference;
    use crate::builders::prims::presplit::PresplitConfig;
    use crate::builders::prims::refs::PrimRefs;
    use crate::geometry::Aabb;
    use crate::scene::scalable;

    const TREES: [AuxiliaryTree; 4] = [
        AuxiliaryTree::Lbvh,
        AuxiliaryTree::Ploc(PlocConfig::DEFAULT),
        AuxiliaryTree::Aac(AacConfig::FAST),
        AuxiliaryTree::BinnedSah(BinnedSahConfig::DEFAULT),
    ];

    /// Checks the subtree whose references begin at `first`; returns the half areas of its inner nodes together.
    fn area(auxiliary: &Auxiliary, refs: &PrimRefs<'_>, node: &Node, first: usize) -> f64 {
        if node.is_leaf() {
            assert_eq!(node.run().start, first);
            let keys = &auxiliary.order.keys[node.run()];
            let bounds: Aabb = keys.iter().map(|&key| refs.bounds(reference(key))).collect();
            assert_eq!(bounds, node.bounds());
            return 0.0;
        }
        let [left, right] = auxiliary.tree.children(node);
        assert_eq!(left.count() + right.count(), node.count());
        assert_eq!(left.bounds().union(right.bounds()), node.bounds());
        f64::from(node.bounds().half_area())
            + area(auxiliary, refs, left, first)
            + area(auxiliary, refs, right, first + left.count() as usize)
    }

    #[test]
    fn trees_are_runs_of_all_references_and_better_than_an_lbvh() {
        let presplit = AuxiliaryConfig { presplit: Some(PresplitConfig::NEEDLES), ..AuxiliaryConfig::PAPER };
        let clusters = Some(Clusters { most: 20, area: 1e-3 });
        let coarse = AuxiliaryConfig { auxiliary_leaf: Some(4), clusters, ..presplit };
        for (n, config) in [(1, presplit), (2, presplit), (9, coarse), (30_000, presplit), (30_000, coarse)] {
            let mesh = scalable(n, 1).mesh;
            let areas = TREES.map(|auxiliary_tree| {
                let mut auxiliary = Auxiliary::default();
                let all = 0..mesh.len() as u32;
                auxiliary_tree.build(&mut auxiliary, (&mesh, all), &config, Isa::best());
                let refs = auxiliary.order.refs(&mesh);
                let root = auxiliary.tree.root.unwrap();
                let mut all: Vec<u32> = auxiliary.order.keys.iter().map(|&key| reference(key)).collect();
                assert_eq!(root.count() as usize, all.len());
                all.sort_unstable();
                all.dedup();
                assert_eq!(all.len(), auxiliary.order.keys.len(), "{auxiliary_tree:?}");
                area(&auxiliary, &refs, &root, 0)
            });
            assert!(n < 100 || areas[1..].iter().all(|&area| area < areas[0]), "{areas:?}");
        }
    }

    #[test]
    fn trees_are_the_same_at_any_number_of_threads_and_with_any_instructions() {
        let mesh = scalable(30_000, 2).mesh;
        for auxiliary_tree in TREES {
            let build = |isa, threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut auxiliary = Auxiliary::default();
                let part = (&mesh, 0..mesh.len() as u32);
                pool.install(|| {
                    drop(auxiliary_tree.build(&mut auxiliary, part, &AuxiliaryConfig::PAPER, isa))
                });
                let pairs = auxiliary.tree.pairs.as_flattened().iter();
                let bits = |node: &Node| node.corners().map(|corner| corner.map(f32::to_bits));
                (auxiliary.order.keys.clone(), pairs.map(bits).collect::<Vec<_>>())
            };
            let expected = build(Isa::Scalar, 1);
            for isa in Isa::available() {
                assert!([1, 2, 8].iter().all(|&n| build(isa, n) == expected), "{auxiliary_tree:?}, {isa}");
            }
        }
    }
}
