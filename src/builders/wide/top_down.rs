//! The recursion every top-down builder shares: wide nodes formed by splitting the largest child first
//! (paper 4.5), with subtrees built in parallel (4.6).
//!
//! Where the paper shares a queue of unbuilt subtrees among threads, here the upper part is split by rayon's
//! tasks down to pieces that fit a cache, and the pieces are then built and written in order
//! ([`crate::parallel::ordered_append`]), so that the tree is the same at any number of threads.

use crate::builders::prims::refs::References;
use crate::builders::wide::treelet::{self, Piece, Subtree};
use crate::bvh::{Bvh4, Link, TriangleBlock, WideNode};
use crate::geometry::{Aabb, Mesh};
use crate::memory::huge_pages;
use crate::parallel::ordered_append::Spare;
use arrayvec::ArrayVec;
use rayon::prelude::*;
use std::sync::Mutex;

/// Children of a wide node.
pub(crate) const WIDTH: usize = 4;
/// Triangles of a leaf block: up to so many are always a leaf.
pub(crate) const QUARTET: u32 = 4;

/// What becomes of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Kind {
    /// A node: it is split.
    Inner,
    /// A leaf of several quartets, because a node would cost more; where a parent has room for more children
    /// it is split nevertheless, as that costs no node.
    SoftLeaf,
    /// A leaf.
    Leaf,
}

/// What a concrete builder supplies.
pub(crate) trait TopDown: Sync {
    /// An unbuilt subtree on its way between threads.
    type Seed: Send;
    /// An unbuilt subtree within a thread's memory.
    type Part: Clone;
    /// Memory and counts of a thread.
    type Scratch: Default + Send;
    /// How much of that memory is in use.
    type Mark;

    /// Brings a subtree into a thread's memory.
    fn plant(&self, seed: Self::Seed, scratch: &mut Self::Scratch) -> Self::Part;

    /// Takes a subtree out of a thread's memory.
    fn lift(&self, part: &Self::Part, scratch: &Self::Scratch) -> Self::Seed;

    /// Brings near what the leaves of a part need; called once before one thread builds it.
    fn approach(&self, part: &Self::Part, scratch: &Self::Scratch);

    /// References below the part, an upper bound where it is clipped.
    fn count(&self, part: &Self::Part) -> u32;

    /// Half the surface area of the part's box.
    fn half_area(&self, part: &Self::Part) -> f32;

    /// Whether the part is to become a leaf; it is then of at most 4 * [`crate::bvh::MAX_LEAF_BLOCKS`] references.
    fn kind(&self, part: &Self::Part) -> Kind;

    /// Divides a part that is no [`Kind::Leaf`] in two, either of which may turn out to be empty. If it is
    /// [`Kind::Inner`], it may be found that it should be a leaf; it is then given back as one.
    fn split(&self, part: &Self::Part, scratch: &mut Self::Scratch) -> [Option<Self::Part>; 2];

    /// Splits a part into up to four: the largest that is no leaf first (paper 4.5).
    fn children(&self, part: &Self::Part, scratch: &mut Self::Scratch) -> ArrayVec<Self::Part, WIDTH> {
        let mut children = ArrayVec::new();
        children.push(part.clone());
        while (1..WIDTH).contains(&children.len()) {
            let largest = |kind: Kind| {
                let of_kind = (0..children.len()).filter(|&i| self.kind(&children[i]) == kind);
                let area = |i: usize| self.half_area(&children[i]);
                of_kind.reduce(|a, b| if area(b) > area(a) { b } else { a })
            };
            let next = match largest(Kind::Inner) {
                None if children.len() > 1 => largest(Kind::SoftLeaf),
                inner => inner,
            };
            let Some(next) = next else { break };
            match self.split(&children[next], scratch) {
                [Some(left), Some(right)] => {
                    children[next] = left;
                    children.insert(next + 1, right);
                }
                [Some(only), None] | [None, Some(only)] => children[next] = only,
                [None, None] => {
                    children.remove(next);
                }
            }
        }
        children
    }

    /// Appends the triangles of a leaf; returns their box, clipped like the part.
    fn leaf(&self, part: &Self::Part, prims: &mut Vec<u32>, scratch: &mut Self::Scratch) -> Aabb;

    /// Appends the wide nodes and blocks of a part whose splits are known already, or that is made wide by rules of its
    /// own; `None` for others.
    fn finish(&self, _: &Self::Part, _: &mut Piece, _: &mut Self::Scratch) -> Option<Subtree> {
        None
    }

    /// As [`TopDown::leaf`], with the box of what is to be seen of the triangles within the part; those of which
    /// nothing is are left out.
    fn visible_leaf(&self, part: &Self::Part, prims: &mut Vec<u32>, scratch: &mut Self::Scratch) -> Aabb {
        self.leaf(part, prims, scratch)
    }

    /// How much of the scratch memory is in use.
    fn mark(&self, scratch: &Self::Scratch) -> Self::Mark;

    /// Frees scratch memory taken since `mark`.
    fn release(&self, scratch: &mut Self::Scratch, mark: Self::Mark);
}

/// Memory of tasks and of trees no longer used, kept from build to build.
pub(crate) struct Memory<S> {
    /// Of threads.
    pub workers: Spare<Box<Worker<S>>>,
    /// Of pieces.
    pub pieces: Spare<Piece>,
    tree: Option<Bvh4>,
}

impl<S> Default for Memory<S> {
    fn default() -> Self {
        Self { workers: Spare::default(), pieces: Spare::default(), tree: None }
    }
}

impl<S: Default> Memory<S> {
    /// Calls `f` on each thread's scratch memory: to gather counts.
    pub fn for_each_scratch(&self, mut f: impl FnMut(&mut S)) {
        self.workers.for_each(|worker| f(&mut worker.scratch));
    }

    /// Takes a tree whose memory the next one may use.
    pub fn recycle(&mut self, tree: Bvh4) {
        self.tree = Some(tree);
    }

    /// The arrays of a tree over `n` triangles, empty, with room for what most trees need.
    pub fn arrays(&mut self, n: usize) -> (Vec<WideNode<WIDTH>>, Vec<TriangleBlock>) {
        self.blocks(n);
        let Bvh4 { mut nodes, mut blocks, .. } = self.tree.take().unwrap_or_default();
        nodes.clear();
        blocks.clear();
        huge_pages::reserve(&mut nodes, n / 4 + 64);
        (nodes, blocks)
    }

    /// The leaf blocks that [`Memory::arrays`] is going to give, for others to use their memory before.
    pub fn blocks(&mut self, n: usize) -> &mut Vec<TriangleBlock> {
        let blocks = &mut self.tree.get_or_insert_default().blocks;
        blocks.clear();
        huge_pages::reserve(blocks, n / 2 + 64);
        blocks
    }

    /// Bytes held by pieces.
    pub fn bytes(&self) -> usize {
        let mut bytes = 0;
        self.pieces.for_each(|piece| bytes += piece.bytes());
        bytes
    }
}

/// The memory of a thread.
#[derive(Default)]
pub(crate) struct Worker<S> {
    /// Of the builder.
    pub scratch: S,
    /// Of the leaf being made.
    pub prims: Vec<u32>,
}

/// An upper part of the tree over pieces yet to be built.
enum Upper<S> {
    Piece(S),
    Node(Vec<Self>),
}

/// Builds the tree below `root` over what the references refer to.
pub(crate) fn build<T: TopDown>(
    builder: &T,
    root: Option<T::Seed>,
    references: &References<'_>,
    memory: &mut Memory<T::Scratch>,
) -> Bvh4 {
    let Some(root) = root else { return Bvh4::default() };
    let n = references.mesh.len();
    let (mut nodes, mut blocks) = memory.arrays(n);
    // Pieces are small enough for caches and many enough for threads, and their number depends on the scene
    // alone.
    let grain = (n / 256).clamp(1 << 9, 1 << 12) as u32;
    let emitter = Emitter { builder, mesh: references.mesh };
    let mut seeds = Vec::new();
    let upper = emitter.upper(root, grain, &memory.workers).number(&mut seeds);
    let seeds: Vec<Mutex<Option<T::Seed>>> = seeds.into_iter().map(|seed| Mutex::new(Some(seed))).collect();
    let subtrees = treelet::append(seeds.len(), &memory.pieces, &mut nodes, &mut blocks, |i, piece| {
        let seed = seeds[i].lock().expect("no task panics").take().expect("each task runs once");
        let mut worker = memory.workers.take();
        let subtree = emitter.piece(seed, piece, &mut worker);
        memory.workers.put(worker);
        subtree
    });
    match upper.finish(&subtrees, &mut nodes) {
        None => Bvh4::default(),
        Some((bounds, root)) => Bvh4 { root, bounds, nodes, blocks },
    }
}

impl<S> Upper<S> {
    /// Moves the seeds to an array, depth first, and leaves their numbers.
    fn number(self, seeds: &mut Vec<S>) -> Upper<usize> {
        match self {
            Self::Piece(seed) => {
                seeds.push(seed);
                Upper::Piece(seeds.len() - 1)
            }
            Self::Node(children) => {
                Upper::Node(children.into_iter().map(|child| child.number(seeds)).collect())
            }
        }
    }
}

impl Upper<usize> {
    /// Appends the upper nodes, children before parents.
    fn finish(&self, subtrees: &[Subtree], nodes: &mut Vec<WideNode<WIDTH>>) -> Subtree {
        let children = match self {
            Self::Piece(i) => return subtrees[*i],
            Self::Node(children) => children,
        };
        let children: ArrayVec<(Aabb, Link), WIDTH> =
            children.iter().filter_map(|child| child.finish(subtrees, nodes)).collect();
        treelet::append_node(&children, nodes)
    }
}

/// Turns parts into nodes and leaves.
pub(crate) struct Emitter<'a, T> {
    /// What splits the parts.
    pub builder: &'a T,
    /// The triangles.
    pub mesh: &'a Mesh,
}

impl<T: TopDown> Emitter<'_, T> {
    /// Splits a part into pieces of less than `grain` references, its children in parallel.
    fn upper(&self, seed: T::Seed, grain: u32, workers: &Spare<Box<Worker<T::Scratch>>>) -> Upper<T::Seed> {
        let mut worker = workers.take();
        let scratch = &mut worker.scratch;
        let mark = self.builder.mark(scratch);
        let part = self.builder.plant(seed, scratch);
        let is_piece = self.builder.count(&part) < grain;
        let parts =
            if is_piece { ArrayVec::from_iter([part]) } else { self.builder.children(&part, scratch) };
        let mut seeds: Vec<T::Seed> = parts.iter().map(|part| self.builder.lift(part, scratch)).collect();
        self.builder.release(scratch, mark);
        workers.put(worker);
        match seeds.pop() {
            Some(seed) if is_piece => Upper::Piece(seed),
            last => {
                seeds.extend(last);
                Upper::Node(seeds.into_par_iter().map(|seed| self.upper(seed, grain, workers)).collect())
            }
        }
    }

    /// Builds the subtree of a seed into `piece`.
    pub fn piece(&self, seed: T::Seed, piece: &mut Piece, worker: &mut Worker<T::Scratch>) -> Subtree {
        let mark = self.builder.mark(&worker.scratch);
        let part = self.builder.plant(seed, &mut worker.scratch);
        self.builder.approach(&part, &worker.scratch);
        let subtree = self.serial(&part, piece, worker);
        self.builder.release(&mut worker.scratch, mark);
        subtree
    }

    /// Builds a part depth first into `piece`.
    fn serial(&self, part: &T::Part, piece: &mut Piece, worker: &mut Worker<T::Scratch>) -> Subtree {
        if let Some(subtree) = self.builder.finish(part, piece, &mut worker.scratch) {
            return subtree;
        }
        if self.builder.kind(part) != Kind::Inner {
            return self.leaf(part, piece, worker);
        }
        let mark = self.builder.mark(&worker.scratch);
        let children = self.builder.children(part, &mut worker.scratch);
        let built: ArrayVec<(Aabb, Link), WIDTH> =
            children.iter().filter_map(|child| self.serial(child, piece, worker)).collect();
        // Clipping may leave a single child, or the part be found to be a leaf: it takes its parent's place.
        let subtree = piece.node(&built);
        self.builder.release(&mut worker.scratch, mark);
        subtree
    }

    fn leaf(&self, part: &T::Part, piece: &mut Piece, worker: &mut Worker<T::Scratch>) -> Subtree {
        worker.prims.clear();
        let bounds = self.builder.leaf(part, &mut worker.prims, &mut worker.scratch);
        piece.leaf(self.mesh, &worker.prims).map(|link| (bounds, link))
    }
}
