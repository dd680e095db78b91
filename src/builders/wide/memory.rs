//! Memory of builds, kept from build to build.

use super::treelet::WideTreelet;
use crate::bvh::limits::check_width;
use crate::bvh::{TriangleBlock, WideBvh, WideNode};
use crate::memory::huge_pages;
use crate::memory::pool::Pool;

/// Temporary memory of a thread that grows and shrinks like a stack.
pub(crate) trait Scratch: Default + Send {
    /// How much of it is in use.
    type Checkpoint;

    /// How much is in use.
    fn checkpoint(&self) -> Self::Checkpoint;

    /// Frees what was taken since `checkpoint`.
    fn rollback(&mut self, checkpoint: Self::Checkpoint);
}

impl Scratch for () {
    type Checkpoint = ();

    fn checkpoint(&self) {}

    fn rollback(&mut self, (): ()) {}
}

impl Scratch for Vec<u32> {
    type Checkpoint = usize;

    fn checkpoint(&self) -> usize {
        self.len()
    }

    fn rollback(&mut self, len: usize) {
        self.truncate(len);
    }
}

/// The memory of a thread.
#[derive(Default)]
pub(crate) struct Worker<S> {
    /// Of the builder.
    pub scratch: S,
    /// Triangles of the leaf being made.
    pub prims: Vec<u32>,
}

/// Nodes and blocks of a tree in the making.
pub(crate) type Arrays<const N: usize, B> = (Vec<WideNode<N>>, Vec<B>);

/// Memory of tasks, and a tree no longer used.
pub(crate) struct Memory<S, const N: usize, B = TriangleBlock> {
    /// Of threads.
    pub workers: Pool<Box<Worker<S>>>,
    /// Of treelets.
    pub treelets: Pool<WideTreelet<N, B>>,
    tree: Option<WideBvh<N, B>>,
}

impl<S, const N: usize, B> Default for Memory<S, N, B> {
    fn default() -> Self {
        const { check_width::<N>() };
        Self { workers: Pool::default(), treelets: Pool::default(), tree: None }
    }
}

impl<S: Default, const N: usize, B> Memory<S, N, B> {
    /// Takes a tree whose memory the next one may use.
    pub fn recycle(&mut self, tree: WideBvh<N, B>) {
        self.tree = Some(tree);
    }

    /// The arrays of a tree over `n` primitives, empty, with the capacity that most trees need.
    pub fn arrays(&mut self, n: usize) -> Arrays<N, B> {
        self.blocks(n);
        let WideBvh { mut nodes, mut blocks, .. } = self.tree.take().unwrap_or_default();
        nodes.clear();
        blocks.clear();
        huge_pages::reserve(&mut nodes, n / N + 64, "nodes");
        (nodes, blocks)
    }

    /// The leaf blocks that [`Memory::arrays`] is going to give; until then others may use their memory.
    pub fn blocks(&mut self, n: usize) -> &mut Vec<B> {
        let blocks = &mut self.tree.get_or_insert_default().blocks;
        blocks.clear();
        huge_pages::reserve(blocks, n / 2 + 64, "leaf blocks");
        blocks
    }
}
