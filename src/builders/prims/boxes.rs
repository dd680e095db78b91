//! Boxes of anything: spheres, curves, instances, objects of a game. Builders see their boxes alone, and split them in
//! space where the caller tells how.

use super::geometry::{Checked, Geometry};
use super::primitives::Primitives;
use crate::bvh::IdBlock;
use crate::geometry::{Aabb, Mesh, Ray};
use crate::memory::prefetch::line;
use crate::memory::{OutOfMemory, huge_pages};
use rayon::prelude::*;
use std::fmt;
use std::ops::Range;

/// Why boxes cannot be built over.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoxesError {
    /// A box that no ray can be tested against.
    #[error(
        "primitive {id} has the box {min:?} to {max:?}; boxes are finite, below 1.8e18 and not empty: leave the primitive out"
    )]
    Invalid {
        /// The primitive.
        id: u32,
        /// Lower corner.
        min: [f32; 3],
        /// Upper corner.
        max: [f32; 3],
    },
    /// More than every builder is sure to hold.
    #[error("{0} primitives are more than the 2^26 that any tree is sure to hold; divide them")]
    TooMany(usize),
    /// No memory for them.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

/// The boxes of primitives, checked: what builders build over.
#[derive(Clone)]
pub struct Boxes<'a> {
    bounds: Vec<Aabb>,
    /// Splits them.
    splitter: Option<&'a dyn Primitives>,
}

impl fmt::Debug for Boxes<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let splits = self.splitter.is_some();
        f.debug_struct("Boxes").field("bounds", &self.bounds).field("splits", &splits).finish()
    }
}

impl Boxes<'static> {
    /// Boxes that are not split.
    ///
    /// # Errors
    /// [`BoxesError`]: a box that is empty, infinite or NaN, or reaches beyond 1.844e18; too many.
    pub fn new(bounds: Vec<Aabb>) -> Result<Self, BoxesError> {
        if bounds.len() > Mesh::MAX_TRIANGLES {
            return Err(BoxesError::TooMany(bounds.len()));
        }
        let is_valid = |b: &Aabb| {
            let largest = b.min.abs().max(b.max.abs());
            !b.is_empty() && largest.max_element() < Ray::LARGEST
        };
        match bounds.par_iter().position_first(|bounds| !is_valid(bounds)) {
            None => Ok(Self { bounds, splitter: None }),
            Some(id) => {
                let Aabb { min, max } = bounds[id];
                Err(BoxesError::Invalid { id: id as u32, min: min.to_array(), max: max.to_array() })
            }
        }
    }
}

impl<'a> Boxes<'a> {
    /// Those of `primitives`, on the current rayon pool.
    ///
    /// # Errors
    /// As [`Boxes::new`], and [`BoxesError::OutOfMemory`].
    pub fn of<P: Primitives>(primitives: &'a P) -> Result<Self, BoxesError> {
        let count = primitives.len();
        if count > Mesh::MAX_TRIANGLES {
            return Err(BoxesError::TooMany(count));
        }
        let mut bounds: Vec<Aabb> = Vec::new();
        huge_pages::try_reserve(&mut bounds, count, "boxes")?;
        let ids = (0..count as u32).into_par_iter().with_min_len(1 << 10);
        bounds.par_extend(ids.map(|id| primitives.bounds(id)));
        let splitter: Option<&dyn Primitives> = if primitives.splits() { Some(primitives) } else { None };
        Ok(Self { splitter, ..Boxes::new(bounds)? })
    }

    /// The boxes.
    pub fn as_slice(&self) -> &[Aabb] {
        &self.bounds
    }
}

impl Checked for Boxes<'_> {}

impl Geometry for Boxes<'_> {
    type Block = IdBlock;
    type Item = u32;

    #[inline(always)]
    fn len(&self) -> usize {
        self.bounds.len()
    }

    #[inline(always)]
    fn bounds_of(&self, prim: u32) -> Aabb {
        self.bounds[prim as usize]
    }

    #[inline(always)]
    fn for_each(&self, prims: Range<usize>, f: impl FnMut(Aabb)) {
        self.bounds[prims].iter().copied().for_each(f);
    }

    #[inline(always)]
    fn block(&self, count: usize, prims: [u32; 4]) -> IdBlock {
        IdBlock::of_first(count, prims)
    }

    #[inline(always)]
    fn item(&self, prim: u32) -> u32 {
        prim
    }

    #[inline(always)]
    fn bounds_of_item(&self, &prim: &u32) -> Aabb {
        self.bounds_of(prim)
    }

    #[inline(always)]
    fn block_of_items(&self, count: usize, items: [&u32; 4]) -> (Aabb, IdBlock) {
        let [p, q, r, s] = items.map(|&prim| self.bounds_of(prim));
        (p.union(q).union(r.union(s)), self.block(count, items.map(|&prim| prim)))
    }

    #[inline(always)]
    fn splits(&self) -> bool {
        self.splitter.is_some()
    }

    fn split(&self, prim: u32, bounds: Aabb, axis: usize, plane: f32) -> [Aabb; 2] {
        let halves = [bounds.below(axis, plane), bounds.above(axis, plane)];
        let Some(splitter) = self.splitter else { return halves };
        let parts = splitter.split(prim, bounds, axis, plane);
        let inside = [0, 1].map(|side| parts[side].intersection(halves[side]));
        // A splitter that finds nothing on either side does not make the primitive vanish.
        if inside.iter().all(|part| part.is_empty()) { halves } else { inside }
    }

    #[inline(always)]
    fn visible(&self, _: u32, bounds: Aabb) -> Option<Aabb> {
        Some(bounds)
    }

    #[inline(always)]
    fn triangles(&self) -> Option<&Mesh> {
        None
    }

    #[inline(always)]
    fn prefetch(&self, prim: u32) {
        line(&self.bounds, prim as usize);
    }

    #[inline(always)]
    fn prefetch_first_corner(&self, _: u32) {}

    #[inline(always)]
    fn prefetch_corners(&self, _: u32) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    #[test]
    fn boxes_that_no_ray_can_be_tested_against_are_refused() {
        let unit = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
        let point = Aabb::new(Vec3A::ONE, Vec3A::ONE);
        assert_eq!(Boxes::new(vec![unit, point]).map(|boxes| boxes.as_slice().len()), Ok(2));
        assert_eq!(Boxes::new(vec![]).map(|boxes| boxes.as_slice().len()), Ok(0));
        for bad in [
            Aabb::EMPTY,
            Aabb { max: Vec3A::new(1.0, f32::NAN, 1.0), ..unit },
            Aabb { min: Vec3A::new(0.0, 0.0, f32::NAN), ..unit },
            Aabb { max: Vec3A::new(f32::INFINITY, 1.0, 1.0), ..unit },
            Aabb { min: Vec3A::new(-2e18, 0.0, 0.0), ..unit },
        ] {
            let error = Boxes::new(vec![unit, point, bad]).unwrap_err();
            assert!(matches!(error, BoxesError::Invalid { id: 2, .. }), "{error}");
            assert!(error.to_string().starts_with("primitive 2 has the box ["), "{error}");
        }
    }

    #[test]
    fn parts_stay_within_the_halves_and_none_vanishes() {
        struct Splitter([Aabb; 2]);
        impl Primitives for Splitter {
            fn len(&self) -> usize {
                1
            }
            fn bounds(&self, _: u32) -> Aabb {
                Aabb::new(Vec3A::ZERO, Vec3A::ONE)
            }
            fn splits(&self) -> bool {
                true
            }
            fn split(&self, _: u32, _: Aabb, _: usize, _: f32) -> [Aabb; 2] {
                self.0
            }
        }
        let all = Aabb::new(Vec3A::splat(-9.0), Vec3A::splat(9.0));
        let halves =
            Boxes::of(&Splitter([all, all])).unwrap().split(0, Splitter([all; 2]).bounds(0), 1, 0.25);
        assert_eq!(halves.map(|half| half.extent().y), [0.25, 0.75]);
        for nothing in [Aabb::EMPTY, Aabb::new(Vec3A::NAN, Vec3A::NAN)] {
            let split =
                Boxes::of(&Splitter([nothing; 2])).unwrap().split(0, Splitter([all; 2]).bounds(0), 1, 0.25);
            assert_eq!(split, halves);
        }
    }
}
