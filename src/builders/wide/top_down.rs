//! What a builder supplies to be built top-down ([`super::build`]).

use super::memory::Scratch;
use super::open_largest::{Priority, open_largest, replace};
use super::treelet::{WideRoot, WideTreelet};
use crate::builders::binary::kind::Kind;
use crate::geometry::Aabb;
use arrayvec::ArrayVec;

/// The largest [`grain`]: parts of this many references or more are divided, however large the scene.
pub(crate) const MAX_GRAIN: usize = 1 << 12;

/// What [`TopDown::grain`] is unless a builder says otherwise. It depends on the scene alone, as the order of nodes
/// does.
pub(crate) fn grain(n: usize) -> usize {
    (n / 64).clamp(1 << 9, MAX_GRAIN)
}

/// A builder from the root down. A part is an unbuilt subtree in the memory of a thread; a task is one on its way
/// between threads.
pub(crate) trait TopDown: Sync {
    /// An unbuilt subtree with memory of its own.
    type Task: Send;
    /// An unbuilt subtree in a thread's scratch memory.
    type Part;
    /// A thread's scratch memory.
    type Scratch: Scratch;
    /// What leaves are made of.
    type Block;

    /// Copies a task into scratch memory.
    fn import(&self, task: Self::Task, scratch: &mut Self::Scratch) -> Self::Part;

    /// Copies a part out of scratch memory.
    fn export(&self, part: &Self::Part, scratch: &Self::Scratch) -> Self::Task;

    /// Prefetches what the subtree of a part is made from; called once before one thread builds it.
    fn prefetch(&self, _: &Self::Part, _: &Self::Scratch) {}

    /// Parts of fewer references than this are tasks, in a scene of `n`: small enough for caches, many enough for
    /// threads.
    fn grain(&self, n: usize) -> usize {
        grain(n)
    }

    /// References below the part, an upper bound where it is clipped.
    fn count(&self, part: &Self::Part) -> u32;

    /// Whether the part becomes a leaf; it then has at most [`crate::bvh::limits::MAX_LEAF`] references.
    fn is_leaf(&self, part: &Self::Part) -> bool;

    /// Appends to `children`, which is empty, those of the wide node over a part, none to `N`.
    // As a result they would be copied.
    fn children<const N: usize>(
        &self,
        part: &Self::Part,
        scratch: &mut Self::Scratch,
        children: &mut ArrayVec<Self::Part, N>,
    );

    /// Appends the primitives of a leaf; returns their box, clipped like the part.
    fn leaf(&self, part: &Self::Part, prims: &mut Vec<u32>, scratch: &mut Self::Scratch) -> Aabb;

    /// Appends the whole subtree of a part, where there is a faster or another way than one wide node after another;
    /// `None` elsewhere.
    fn try_emit<const N: usize>(
        &self,
        _: &Self::Part,
        _: &mut WideTreelet<N, Self::Block>,
        _: &mut Self::Scratch,
    ) -> Option<WideRoot> {
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

    /// [`TopDown::children`] of a part that is to be split: the largest is split first (paper 4.5).
    fn split_largest<const N: usize>(
        &self,
        part: &Self::Part,
        scratch: &mut Self::Scratch,
        children: &mut ArrayVec<Self::Part, N>,
    ) {
        let priority = |part: &Self::Part| Priority::new(self.kind(part), self.half_area(part));
        children.push(part.clone());
        open_largest(children, priority, |children, next| {
            match self.split(&children[next], scratch) {
                [Some(left), Some(right)] => replace(children, next, [left, right]),
                [Some(only), None] | [None, Some(only)] => children[next] = only,
                [None, None] => drop(children.remove(next)),
            }
            Some(())
        });
    }
}
