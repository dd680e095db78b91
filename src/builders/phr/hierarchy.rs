//! An auxiliary BVH and a build over its cuts: what PHR and the method of Hunt et al. have in common.

use crate::builders::builder::{Build, Counts, Phase, Stopwatch};
use crate::builders::lbvh::area_scale::Areas;
use crate::builders::lbvh::auxiliary::{Auxiliary, AuxiliaryConfig};
use crate::builders::phr::cut::Order;
use crate::builders::phr::policy::{Refine, Rules};
use crate::builders::phr::recursion::{CutRecursion, Scratch};
use crate::builders::split::object::lanes::Isa;
use crate::builders::wide::top_down::{self, Memory};
use crate::bvh::Bvh4;
use crate::geometry::Mesh;

/// The memory of builds from a hierarchy.
#[derive(Default)]
pub(crate) struct Hierarchy {
    auxiliary: Auxiliary,
    memory: Memory<Scratch>,
    /// Instructions to use.
    pub isa: Isa,
}

/// What is to be told of a recursion over cuts.
pub(crate) struct Cuts {
    /// Its phases.
    pub phases: Vec<Phase>,
    /// What was counted.
    pub counts: Counts,
    /// Bytes held beside what was made.
    pub bytes: usize,
}

impl Hierarchy {
    /// Builds over `mesh` by the rules made for the scene's areas.
    pub fn build<R: Refine>(
        &mut self,
        mesh: &Mesh,
        auxiliary: &AuxiliaryConfig,
        rules: impl FnOnce(&Areas) -> Rules<R>,
    ) -> Build {
        let (tree, cuts) = self.recurse(mesh, auxiliary, rules, |recursion, memory| {
            top_down::build(recursion, recursion.root(), &recursion.order.references, memory)
        });
        Build::finish(tree, cuts.phases, cuts.counts, cuts.bytes)
    }

    /// As [`Hierarchy::build`], but `make` recurses over the cuts and makes what it likes.
    pub fn recurse<R: Refine, T>(
        &mut self,
        mesh: &Mesh,
        auxiliary: &AuxiliaryConfig,
        rules: impl FnOnce(&Areas) -> Rules<R>,
        make: impl FnOnce(&CutRecursion<'_, R>, &mut Memory<Scratch>) -> T,
    ) -> (T, Cuts) {
        let mut phases = self.auxiliary.build(mesh, auxiliary);
        let references = self.auxiliary.order.references(mesh);
        let mut watch = Stopwatch::start();
        let recursion = CutRecursion {
            tree: &self.auxiliary.tree,
            order: Order { keys: &self.auxiliary.order.keys, references },
            rules: rules(&self.auxiliary.areas),
            isa: self.isa,
        };
        let made = make(&recursion, &mut self.memory);
        watch.lap("cuts and nodes");
        phases.extend(watch.phases);
        let bytes = self.auxiliary.bytes() + self.memory.bytes();
        (made, Cuts { phases, counts: self.counts(), bytes })
    }

    /// Takes a tree whose memory the next one may use.
    pub fn recycle(&mut self, tree: Bvh4) {
        self.memory.recycle(tree);
    }

    /// Adds up what the threads counted.
    fn counts(&self) -> Counts {
        let auxiliary_nodes = 2 * self.auxiliary.tree.pairs.len() as u64 + 1;
        let mut counts = Counts { auxiliary_nodes, ..Counts::default() };
        self.memory.for_each_scratch(|scratch| {
            let of_task = std::mem::take(&mut scratch.counts);
            counts.splits += of_task.splits;
            counts.spatial_splits += of_task.spatial_splits;
            counts.swept += of_task.swept;
        });
        counts
    }
}
