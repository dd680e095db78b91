//! What a builder supplies to be built top-down, and the recursion from its parts to wide nodes and leaf blocks.

use super::memory::{Memory, Scratch, Worker};
use super::open_largest::{Priority, open_largest};
use super::parallel::ParallelBuild;
use super::treelet::{self, Subtree, WideTreelet};
use crate::builders::binary::kind::Kind;
use crate::bvh::limits::WIDTH;
use crate::bvh::{Bvh4, Link};
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;

/// A builder from the root down. A part is an unbuilt subtree in the memory of a thread; a task is one on its way between
/// threads.
pub(crate) trait TopDown: Sync {
    /// An unbuilt subtree with memory of its own.
    type Task: Send;
    /// An unbuilt subtree in a thread's scratch memory.
    type Part;
    /// A thread's scratch memory.
    type Scratch: Scratch;

    /// Copies a task into scratch memory.
    fn import(&self, task: Self::Task, scratch: &mut Self::Scratch) -> Self::Part;

    /// Copies a part out of scratch memory.
    fn export(&self, part: &Self::Part, scratch: &Self::Scratch) -> Self::Task;

    /// Prefetches what the subtree of a part is made from; called once before one thread builds it.
    fn prefetch(&self, _: &Self::Part, _: &Self::Scratch) {}

    /// References below the part, an upper bound where it is clipped.
    fn count(&self, part: &Self::Part) -> u32;

    /// Whether the part becomes a leaf; it then has at most [`crate::bvh::limits::MAX_LEAF`] references.
    fn is_leaf(&self, part: &Self::Part) -> bool;

    /// The children of the wide node over a part, none to [`WIDTH`].
    fn children(&self, part: &Self::Part, scratch: &mut Self::Scratch) -> ArrayVec<Self::Part, WIDTH>;

    /// Appends the triangles of a leaf; returns their box, clipped like the part.
    fn leaf(&self, part: &Self::Part, prims: &mut Vec<u32>, scratch: &mut Self::Scratch) -> Aabb;

    /// Appends the whole subtree of a part, where there is a faster or another way than one wide node after another;
    /// `None` elsewhere.
    fn try_emit(&self, _: &Self::Part, _: &mut WideTreelet, _: &mut Self::Scratch) -> Option<Subtree> {
        None
    }
}

/// A top-down builder that splits parts in two.
pub(crate) trait BinarySplits: TopDown<Part: Clone> {
    /// What becomes of the part.
    fn kind(&self, part: &Self::Part) -> Kind;

    /// Half the surface area of the part's box.
    fn half_area(&self, part: &Self::Part) -> f32;

    /// Splits a part that is no [`Kind::Leaf`] in two, either of which may turn out to be empty. A part of
    /// [`Kind::Inner`] may be found to be a leaf; it is then given back as one.
    fn split(&self, part: &Self::Part, scratch: &mut Self::Scratch) -> [Option<Self::Part>; 2];

    /// The children of the wide node over a part that is to be split: the largest is split first (paper 4.5).
    fn split_largest(&self, part: &Self::Part, scratch: &mut Self::Scratch) -> ArrayVec<Self::Part, WIDTH> {
        let priority = |part: &Self::Part| Priority::new(self.kind(part), self.half_area(part));
        let mut children = ArrayVec::new();
        children.push(part.clone());
        open_largest(&mut children, priority, |part| Some(self.split(part, scratch)));
        children
    }
}

/// Builds the tree below `root` over `mesh`.
pub(crate) fn build<T: TopDown>(
    builder: &T,
    root: Option<T::Task>,
    mesh: &Mesh,
    memory: &mut Memory<T::Scratch>,
) -> Bvh4 {
    let Some(root) = root else { return Bvh4::default() };
    let (mut nodes, mut blocks) = memory.arrays(mesh.len());
    let (tree, built) = ParallelBuild::new(builder, &memory.workers, mesh.len()).run(
        root,
        &memory.treelets,
        (&mut nodes, &mut blocks),
        |part, scratch| builder.children(part, scratch).into_iter().collect(),
        |part, treelet: &mut WideTreelet, worker| emit(builder, mesh, part, treelet, worker),
    );
    let subtrees = treelet::moved(built);
    let root = tree.fold(&subtrees, &mut |parts| {
        let children: ArrayVec<(Aabb, Link), WIDTH> = parts.iter().copied().flatten().collect();
        treelet::append_node(&children, &mut nodes)
    });
    match root {
        None => Bvh4::default(),
        Some((bounds, root)) => Bvh4 { root, bounds, nodes, blocks },
    }
}

/// Appends the subtree of a part to `treelet`, depth first.
fn emit<T: TopDown>(
    builder: &T,
    mesh: &Mesh,
    part: &T::Part,
    treelet: &mut WideTreelet,
    worker: &mut Worker<T::Scratch>,
) -> Subtree {
    if let Some(subtree) = builder.try_emit(part, treelet, &mut worker.scratch) {
        return subtree;
    }
    if builder.is_leaf(part) {
        worker.prims.clear();
        let bounds = builder.leaf(part, &mut worker.prims, &mut worker.scratch);
        return treelet.leaf(mesh, &worker.prims).map(|link| (bounds, link));
    }
    let checkpoint = worker.scratch.checkpoint();
    let children = builder.children(part, &mut worker.scratch);
    let built: ArrayVec<(Aabb, Link), WIDTH> =
        children.iter().filter_map(|child| emit(builder, mesh, child, treelet, worker)).collect();
    // Clipping may leave a single child, or the part be found to be a leaf: it takes its parent's place.
    let subtree = treelet.node(&built);
    worker.scratch.rollback(checkpoint);
    subtree
}
