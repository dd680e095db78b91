//! A tree made better before it is one: the binary splits of a recursion are drawn up, subtrees reinserted where they
//! enlarge the tree least, and the result is collapsed to the cheapest wide tree.

pub(crate) mod best;
mod candidates;
pub(crate) mod choices;
mod emit;
mod record;
mod reinsertion;
mod tree;

pub use choices::Costs;

use crate::builders::builder::Stopwatch;
use crate::builders::wide::top_down::{Memory, TopDown};
use crate::bvh::Bvh4;
use crate::geometry::Mesh;
use crate::parallel::ordered_append::Spare;
use choices::Choices;
use emit::Collapse;
use record::Draft;
use reinsertion::Reinsertion;
use tree::Tree;

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
    /// Costs of Embree's kernel, and as many rounds as move much.
    pub const DEFAULT: Self = Self { rounds: 4, share: 0.1, costs: Costs::EMBREE };
}

/// The binary tree and the memory of the pass, kept from build to build.
#[derive(Default)]
pub(crate) struct Optimiser {
    tree: Tree,
    drafts: Spare<Draft>,
    reinsertion: Reinsertion,
    choices: Choices,
    memory: Memory<()>,
}

impl Optimiser {
    /// Takes a tree whose memory the next one may use.
    pub fn recycle(&mut self, tree: Bvh4) {
        self.memory.recycle(tree);
    }

    /// Draws up the binary tree of the splits of `builder` over `mesh` below `root`; returns whether there are any
    /// triangles.
    pub fn draw<T: TopDown>(
        &mut self,
        builder: &T,
        root: Option<T::Seed>,
        mesh: &Mesh,
        memory: &Memory<T::Scratch>,
    ) -> bool {
        root.is_some_and(|root| self.tree.draw(builder, root, mesh.len(), memory, &self.drafts))
    }

    /// The best wide tree that comes of what was drawn over `mesh`.
    pub fn improve(&mut self, mesh: &Mesh, config: &OptimiseConfig, watch: &mut Stopwatch) -> Bvh4 {
        let wanted = (self.tree.pairs.len() as f32 * config.share) as usize;
        self.reinsertion.run(&mut self.tree, config.rounds, wanted);
        watch.lap("reinsertion");
        self.choices.make(&self.tree, config.costs);
        let wide = Collapse { tree: &self.tree, choices: &self.choices }.emit(mesh, &mut self.memory);
        watch.lap("collapse");
        wide
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let mut bytes =
            self.tree.bytes() + self.reinsertion.bytes() + self.choices.bytes() + self.memory.bytes();
        self.drafts.for_each(|draft| bytes += draft.bytes());
        bytes
    }
}

#[cfg(test)]
mod samples {
    use super::Tree;
    use crate::builders::PhrConfig;
    use crate::builders::lbvh::area_scale::Areas;
    use crate::builders::lbvh::auxiliary::AuxiliaryConfig;
    use crate::builders::phr::hierarchy::Hierarchy;
    use crate::builders::phr::policy::Rules;
    use crate::builders::wide::top_down::QUARTET;
    use crate::geometry::Mesh;

    /// The tree of PHR-Fast's splits.
    pub fn drawn(mesh: &Mesh) -> Tree {
        let mut tree = Tree::default();
        let rules = |areas: &Areas| Rules { max_leaf: QUARTET, ..PhrConfig::FAST.rules(mesh.len(), areas) };
        Hierarchy::default().recurse(mesh, &AuxiliaryConfig::PAPER, rules, |recursion, memory| {
            let root = recursion.root().expect("there are triangles");
            assert!(tree.draw(recursion, root, mesh.len(), memory, &Default::default()));
        });
        tree
    }

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
