//! The passes against their definitions.

use super::collapsed::CollapsedTree;
use super::reinsertion::Reinsertion;
use super::tree::{ROOT, Tree};
use crate::builders::lbvh::auxiliary::Auxiliary;
use crate::builders::phr::config::PhrConfig;
use crate::builders::phr::pipeline::recursion_and_cut;
use crate::builders::testing::soup;
use crate::builders::wide::build;
use crate::builders::wide::memory::Memory;
use crate::builders::wide::optimal::{Choices, CollapseCosts};
use crate::bvh::limits::BLOCK;
use crate::bvh::{Child, Link, WideBvh};
use crate::geometry::Mesh;
use crate::simd::Isa;

/// The tree of PHR-Fast's splits.
fn recorded(mesh: &Mesh) -> Tree {
    let config = PhrConfig { max_leaf: BLOCK, ..PhrConfig::FAST };
    let mut auxiliary = Auxiliary::default();
    auxiliary.build(mesh, &config.extensions.auxiliary);
    let (recursion, cut) = recursion_and_cut(&auxiliary, mesh, &config, Isa::best());
    let mut tree = Tree::default();
    assert!(tree.record(&recursion, cut.unwrap(), mesh, &Memory::<_, 4>::default(), &Default::default()));
    tree
}

const COSTS: CollapseCosts = CollapseCosts { node: 1.0, leaf: 0.3, block: 0.7, max_leaf: 8 };

/// The least cost of node `index` as at most `slots` children of a node of up to `N`, by trying everything.
fn least<const N: usize>(tree: &Tree, index: u32, slots: usize) -> (f32, u32) {
    let node = tree.node(index);
    let Some(pair) = node.pair() else { return (node.half_area() * leaf_cost(1), node.count()) };
    let [l, r] = [2 * pair as u32, 2 * pair as u32 + 1];
    let count = least::<N>(tree, l, 1).1 + least::<N>(tree, r, 1).1;
    let opened = |slots: usize| {
        (1..slots)
            .map(|left| least::<N>(tree, l, left).0 + least::<N>(tree, r, slots - left).0)
            .fold(f32::MAX, f32::min)
    };
    let leaf = if count <= COSTS.max_leaf { leaf_cost(count.div_ceil(4)) } else { f32::INFINITY };
    let closed = (node.half_area() * leaf).min(node.half_area() * COSTS.node + opened(N));
    ((2..=slots).map(opened).fold(closed, f32::min), count)
}

fn cost_of<const N: usize>(tree: &WideBvh<N>, link: Link, area: f32) -> f32 {
    match link.get() {
        Child::Empty => 0.0,
        Child::Leaf { count, .. } => area * leaf_cost(count as u32),
        Child::Inner(index) => {
            let below = tree.nodes[index].children().map(|(b, link)| cost_of(tree, link, b.half_area()));
            area * COSTS.node + below.sum::<f32>()
        }
    }
}

#[test]
fn no_other_choice_is_cheaper_and_the_tree_costs_what_was_promised() {
    for triangles in [5, 9, 13, 21, 30, 60] {
        let mesh = soup(triangles, 0.09, 7);
        check_cheapest::<4>(&mesh);
        check_cheapest::<8>(&mesh);
    }
}

fn check_cheapest<const N: usize>(mesh: &Mesh) {
    let (tree, mut choices) = (recorded(mesh), Choices::default());
    let promised = choices.solve::<_, N>(&tree, ROOT, tree.pairs.len(), &COSTS, true);
    let expected = least::<N>(&tree, ROOT, 1).0;
    assert!((promised - expected).abs() <= 1e-5 * expected, "{promised} for {expected}");
    let collapsed = CollapsedTree::new(&tree, &choices);
    let wide: WideBvh<N> = build::build_known(&collapsed, ROOT, mesh, &mut Memory::default());
    assert_eq!(wide.validate(mesh), Ok(()));
    let cost = cost_of(&wide, wide.root, wide.bounds.half_area());
    assert!((cost - expected).abs() <= 1e-5 * expected, "{cost} for {expected}");
}

fn leaf_cost(blocks: u32) -> f32 {
    COSTS.leaf + COSTS.block * blocks as f32
}

/// The sum of the areas of inner nodes.
fn cost(tree: &Tree, index: u32) -> f64 {
    let node = tree.node(index);
    let below = |pair: usize| [0, 1].map(|half| cost(tree, 2 * pair as u32 + half)).iter().sum::<f64>();
    node.pair().map_or(0.0, |pair| f64::from(node.half_area()) + below(pair))
}

#[test]
fn no_round_raises_the_cost_and_together_they_lower_it() {
    let mesh = soup(4000, 0.09, 7);
    let mut tree = recorded(&mesh);
    let mut reinsertion = Reinsertion::default();
    reinsertion.run(&mut tree, 0, 0);
    let mut costs = vec![cost(&tree, ROOT)];
    for _ in 0..5 {
        let wanted = tree.pairs.len() / 4;
        reinsertion.round(&mut tree, wanted);
        costs.push(cost(&tree, ROOT));
    }
    assert!(costs.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{costs:?}");
    assert!(costs[5] < 0.9995 * costs[0], "{costs:?}");
}

#[test]
fn boxes_heights_and_parents_stay_right() {
    let mesh = soup(1000, 0.09, 7);
    let mut tree = recorded(&mesh);
    let recorded = tree.prims.len();
    let all = 2 * tree.pairs.len();
    Reinsertion::default().run(&mut tree, 2, all);
    let mut open = vec![ROOT];
    let mut triangles = 0;
    while let Some(index) = open.pop() {
        let (node, fitted) = (tree.node(index), tree.fitted(index));
        assert_eq!((node.bounds(), node.height()), (fitted.bounds(), fitted.height()));
        match node.pair() {
            Some(pair) => {
                assert_eq!(tree.parent(2 * pair as u32), index);
                open.extend([2 * pair as u32, 2 * pair as u32 + 1]);
            }
            None => triangles += node.count() as usize,
        }
    }
    assert_eq!(triangles, recorded);
}
