//! The children whose boxes a ray meets.

use crate::bvh::WideNode;
use crate::geometry::ordered::{greater, smaller};
use crate::trace::kernel::traverse::Entries;

/// The children whose boxes meet a ray within `interval`, and where: `near` and `far` give the distances of the planes
/// that the ray meets first and last, by axis and coordinate.
#[inline(always)]
pub(super) fn boxes_met<const N: usize>(
    node: &WideNode<N>,
    rdir: [f32; 3],
    [tnear, tfar]: [f32; 2],
    near: impl Fn(usize, f32) -> f32,
    far: impl Fn(usize, f32) -> f32,
) -> (u32, Entries<N>) {
    let (mut enter, mut leave) = ([tnear; N], [tfar; N]);
    for (axis, &rdir) in rdir.iter().enumerate() {
        let (first, last) = if rdir >= 0.0 {
            (&node.lower[axis], &node.upper[axis])
        } else {
            (&node.upper[axis], &node.lower[axis])
        };
        for slot in 0..N {
            enter[slot] = greater(near(axis, first[slot]), enter[slot]);
            leave[slot] = smaller(far(axis, last[slot]), leave[slot]);
        }
    }
    let mut mask = 0;
    for slot in 0..N {
        mask |= u32::from(enter[slot] <= leave[slot]) << slot;
    }
    (mask, Entries(enter.map(f32::to_bits)))
}
