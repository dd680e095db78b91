//! What the sides of many splits cost, one split per lane of a vector.
//!
//! As the methods of [`Lanes`], the functions are for others compiled for the instruction set.

use crate::builders::split::cost::Weight;
use crate::simd::vector::Lanes;

/// As [`crate::geometry::Aabb::half_area`].
#[inline(always)]
pub(crate) fn half_area<L: Lanes>(min: [L::F; 3], max: [L::F; 3]) -> L::F {
    let zero = L::splat(0.0);
    let x = L::max(L::sub(max[0], min[0]), zero);
    let y = L::max(L::sub(max[1], min[1]), zero);
    let z = L::max(L::sub(max[2], min[2]), zero);
    L::add(L::mul(x, L::add(y, z)), L::mul(y, z))
}

/// As [`Weight::of`].
#[inline(always)]
pub(crate) fn weigh<L: Lanes>(weight: Weight, count: L::F) -> L::F {
    match weight {
        Weight::Nodes => count,
        Weight::Quartets => L::floor(L::mul(L::add(count, L::splat(3.0)), L::splat(0.25))),
    }
}
