//! The top of an LBVH: sorted keys are partitioned down to treelets that fit a cache, each of which one task builds.

use super::key::MortonKey;
use super::partition::partition;
use crate::builders::binary::tree::TREELET;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::parallel::slots::Slots;
use crate::parallel::task_tree::{Division, TaskTree};

/// The keys of a treelet.
pub(crate) struct Treelet<'a> {
    /// The position of the first.
    pub first: usize,
    /// How often they were partitioned by the middle.
    pub depth: u32,
    /// The keys.
    pub keys: &'a mut [MortonKey],
}

/// The treelets of one or more `keys`, which count as partitioned by the middle `depth` times before, and the tree over
/// them; keys of one code are reordered.
pub(crate) fn top_tree<'a, G: Geometry>(
    refs: &PrimRefs<'_, G>,
    keys: &'a mut [MortonKey],
    depth: u32,
) -> (TaskTree<usize>, Slots<Treelet<'a>>) {
    let divide = |Treelet { first, mut depth, keys }: Treelet<'a>| {
        if keys.len() <= TREELET {
            return Division::Task(Treelet { first, depth, keys });
        }
        let split = partition(keys, refs, &mut depth);
        let (left, right) = keys.split_at_mut(split);
        let part = |first, keys| Treelet { first, depth, keys };
        Division::Parts(vec![part(first, left), part(first + split, right)])
    };
    TaskTree::grow(Treelet { first: 0, depth, keys }, &divide).number()
}
