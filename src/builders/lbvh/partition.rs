//! How a run of sorted keys is partitioned in two (paper 4.7): the definition that treelets are held to.

use super::key::{MortonKey, code, reference};
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::bvh::limits::MIDDLE_DEPTH;
use crate::geometry::Aabb;
use glam::Vec3A;

/// Partitions a run of two or more sorted keys where the highest bit changes in which their codes differ; returns
/// the length of the left side. A run of one code is reordered and partitioned at the middle of its centroids'
/// bounds, which is what further bits would say; `depth` counts such partitions, which bounds the depth of any
/// tree.
pub(crate) fn partition<G: Geometry>(
    keys: &mut [MortonKey],
    refs: &PrimRefs<'_, G>,
    depth: &mut u32,
) -> usize {
    let (first, last) = (code(keys[0]), code(keys[keys.len() - 1]));
    if first != last {
        let bit = 1 << (31 - (first ^ last).leading_zeros());
        return keys.partition_point(|&key| code(key) & bit == 0);
    }
    *depth += 1;
    if keys.len() == 2 || *depth > MIDDLE_DEPTH {
        return keys.len() / 2;
    }
    partition_by_middle(keys, |&key| refs.bounds(reference(key)).center2())
}

/// Moves to the front the items whose centroid lies below the middle of the longest edge of the centroids' bounds.
/// Returns their number, or half of all where the centroids coincide.
pub(crate) fn partition_by_middle<T: Copy>(items: &mut [T], center2: impl Fn(&T) -> Vec3A) -> usize {
    let all = items.iter().fold(Aabb::EMPTY, |all, item| all.grow(center2(item)));
    let axis = all.extent().max_position();
    let middle = Vec3A::splat(all.center()[axis]);
    let mut split = 0;
    for i in 0..items.len() {
        let is_left = center2(&items[i]).cmplt(middle).bitmask() >> axis & 1 == 1;
        // No branch: it could not be predicted.
        items.swap(i, if is_left { split } else { i });
        split += usize::from(is_left);
    }
    if (1..items.len()).contains(&split) { split } else { items.len() / 2 }
}
