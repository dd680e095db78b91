//! The recursion over wide nodes, from the parts of a top-down builder to nodes and leaf blocks.

use super::memory::{Arrays, Memory, Scratch, Worker};
use super::parallel::ParallelBuild;
use super::top_down::{BinarySplits, TopDown};
use super::treelet::{self, WideRoot, WideTreelet};
use crate::builders::prims::geometry::Geometry;
use crate::bvh::{Link, WideBvh};
use crate::geometry::Aabb;
use crate::memory::pool::Pool;
use crate::parallel::task_tree::TaskTree;
use arrayvec::ArrayVec;

/// Builds the tree of nodes of up to `N` children below `root` over `geometry`.
pub(crate) fn build<T: BinarySplits<Block = G::Block>, G: Geometry, const N: usize>(
    builder: &T,
    root: Option<T::Task>,
    geometry: &G,
    memory: &mut Memory<T::Scratch, N, G::Block>,
) -> WideBvh<N, G::Block> {
    let arrays = memory.arrays(geometry.len());
    build_over(builder, root, geometry, memory, arrays)
}

/// The same behind nodes and blocks that are finished, to which parts may link.
pub(crate) fn build_over<T: BinarySplits<Block = G::Block>, G: Geometry, const N: usize>(
    builder: &T,
    root: Option<T::Task>,
    geometry: &G,
    memory: &mut Memory<T::Scratch, N, G::Block>,
    arrays: Arrays<N, G::Block>,
) -> WideBvh<N, G::Block> {
    let Some(root) = root else { return WideBvh::default() };
    let parallel = ParallelBuild::new(builder, &memory.workers, geometry.len());
    make(&parallel, parallel.split_tasks::<N>(root), geometry, &memory.treelets, arrays)
}

/// Builds the tree below `root` of a builder that knows the children of each node.
pub(crate) fn build_known<T: TopDown<Block = G::Block>, G: Geometry, const N: usize>(
    builder: &T,
    root: T::Task,
    geometry: &G,
    memory: &mut Memory<T::Scratch, N, G::Block>,
) -> WideBvh<N, G::Block> {
    let arrays = memory.arrays(geometry.len());
    let parallel = ParallelBuild::new(builder, &memory.workers, geometry.len());
    make(&parallel, parallel.tasks::<N>(root), geometry, &memory.treelets, arrays)
}

/// Makes the nodes and blocks of tasks and the nodes above them, behind those that are finished.
fn make<T: TopDown<Block = G::Block>, G: Geometry, const N: usize>(
    parallel: &ParallelBuild<'_, T>,
    tasks: TaskTree<T::Task>,
    geometry: &G,
    treelets: &Pool<WideTreelet<N, G::Block>>,
    (mut nodes, mut blocks): Arrays<N, G::Block>,
) -> WideBvh<N, G::Block> {
    let builder = parallel.builder;
    let (tree, built) = parallel.run(tasks, treelets, (&mut nodes, &mut blocks), |part, treelet, worker| {
        emit(builder, geometry, part, treelet, worker)
    });
    let subtrees = treelet::moved(built);
    let root = tree.fold(&subtrees, &mut |parts| {
        let children: ArrayVec<(Aabb, Link), N> = parts.iter().copied().flatten().collect();
        treelet::append_node(&children, &mut nodes)
    });
    root.map_or_else(WideBvh::default, |(bounds, root)| WideBvh { root, bounds, nodes, blocks })
}

/// Appends the subtree of a part to `treelet`, depth first.
fn emit<T: TopDown<Block = G::Block>, G: Geometry, const N: usize>(
    builder: &T,
    geometry: &G,
    part: &T::Part,
    treelet: &mut WideTreelet<N, G::Block>,
    worker: &mut Worker<T::Scratch>,
) -> WideRoot {
    if let Some(subtree) = builder.try_emit(part, treelet, &mut worker.scratch) {
        return subtree;
    }
    if builder.is_leaf(part) {
        worker.prims.clear();
        let bounds = builder.leaf(part, &mut worker.prims, &mut worker.scratch);
        return treelet.leaf(geometry, &worker.prims).map(|link| (bounds, link));
    }
    let checkpoint = worker.scratch.checkpoint();
    let mut children = ArrayVec::<_, N>::new();
    builder.children(part, &mut worker.scratch, &mut children);
    let mut built = ArrayVec::<_, N>::new();
    for child in &children {
        built.extend(emit(builder, geometry, child, treelet, worker));
    }
    // Clipping may leave a single child, or the part be found to be a leaf: it takes its parent's place.
    let subtree = treelet.node(&built);
    worker.scratch.rollback(checkpoint);
    subtree
}
