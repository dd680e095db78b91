//! A finished wide tree made better, whoever built it: unfolded to a binary tree over clipped references, its
//! subtrees reinserted where they enlarge it least, and collapsed to the cheapest wide tree.

mod candidates;
mod choices;
mod collapse;
mod reinsert;
mod tree;
mod unfold;

pub use choices::Costs;

use super::top_down::Memory;
use super::{Build, Stopwatch};
use crate::bvh::{Bvh4, Link, MAX_DEPTH};
use crate::geometry::Mesh;
use choices::Choices;
use collapse::Collapse;
use tree::{ROOT, Tree};

/// How much is done, and for which costs.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct OptimiseConfig {
    /// Rounds of reinsertion.
    pub rounds: u32,
    /// Subtrees that look for a better place in each round, per pair of siblings.
    pub share: f32,
    /// What the wide tree is to be cheapest in.
    pub costs: Costs,
}

impl OptimiseConfig {
    /// Rounds beyond the second gain little. A block is counted as half a node: that leads to the shortest traces
    /// under Embree's kernel, where a block costs less than a visit.
    pub const DEFAULT: Self =
        Self { rounds: 2, share: 0.1, costs: Costs { node: 1.0, block: 0.5, max_leaf: 12 } };
}

/// Memory of the pass, kept from build to build.
#[derive(Default)]
pub(super) struct Optimiser {
    tree: Tree,
    choices: Choices,
    memory: Memory<()>,
}

impl Optimiser {
    /// Takes a tree whose memory the next one may use.
    pub fn recycle(&mut self, tree: Bvh4) {
        self.memory.recycle(tree);
    }

    /// Makes the tree of `build`, over `mesh`, better; the one it was comes along for its memory.
    pub fn improve(&mut self, build: Build, mesh: &Mesh, config: &OptimiseConfig) -> (Build, Bvh4) {
        if !build.tree.root.is_inner() {
            return (build, Bvh4::default());
        }
        let Build { tree: wide, mut phases, counts } = build;
        let mut watch = Stopwatch::start();
        self.tree.unfold(&wide, mesh);
        watch.lap("binary tree");
        for _ in 0..config.rounds {
            self.tree.reinsert((self.tree.pairs.len() as f32 * config.share) as usize);
        }
        watch.lap("reinsertion");
        self.choices.make(&self.tree, config.costs);
        let better = Collapse { tree: &self.tree, choices: &self.choices }.emit(mesh, &mut self.memory);
        watch.lap("collapse");
        phases.extend(watch.phases);
        let held = counts.peak_bytes as usize + self.bytes();
        // A binary tree deeper than wide ones may be is rare enough to give up on.
        let is_safe =
            self.tree.node(ROOT).height() as usize <= MAX_DEPTH || depth(&better, better.root) <= MAX_DEPTH;
        let (tree, other) = if is_safe { (better, wide) } else { (wide, better) };
        (Build::finish(tree, phases, counts, held), other)
    }

    fn bytes(&self) -> usize {
        self.tree.bytes() + self.choices.bytes() + self.memory.bytes()
    }
}

/// Levels of inner nodes.
fn depth(tree: &Bvh4, link: Link) -> usize {
    match link.get() {
        crate::bvh::Child::Inner(index) => {
            1 + tree.nodes[index].links.iter().map(|&link| depth(tree, link)).max().unwrap_or(0)
        }
        _ => 0,
    }
}

#[cfg(test)]
mod samples {
    use crate::geometry::Mesh;

    /// Small triangles all over a cube.
    pub fn soup(count: u32) -> Mesh {
        let mut state = 7u64;
        let mut next = move |scale: f32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32 * scale
        };
        let vertices: Vec<_> = (0..count)
            .flat_map(|_| {
                let (at, d) = ([(); 3].map(|()| next(100.0)), [(); 6].map(|()| next(9.0)));
                let [x, y, z] = at;
                [at, [x + d[0], y + d[1], z + d[2]], [x + d[3], y + d[4], z + d[5]]]
            })
            .collect();
        Mesh::new(vertices, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap().0
    }
}
