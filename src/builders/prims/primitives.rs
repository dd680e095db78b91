//! What has boxes: spheres, curves, instances, objects of a game.

use crate::geometry::Aabb;
use std::sync::Arc;

/// Primitives of the caller, numbered from 0. They are asked from many threads.
///
/// ```
/// use phr::geometry::Aabb;
/// use phr::Primitives;
///
/// struct Spheres(Vec<([f32; 3], f32)>); // centre, radius
///
/// impl Primitives for Spheres {
///     fn len(&self) -> usize {
///         self.0.len()
///     }
///
///     fn bounds(&self, id: u32) -> Aabb {
///         let (centre, radius) = self.0[id as usize];
///         Aabb::new(centre.map(|x| x - radius).into(), centre.map(|x| x + radius).into())
///     }
/// }
/// ```
pub trait Primitives: Sync {
    /// Number of primitives.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The box of primitive `id`: not empty, though it may be flat, and within 1.844e18 of the origin. A ray within the
    /// plane of flat boxes misses them where a node holds nothing else: give a flat scene some depth.
    fn bounds(&self, id: u32) -> Aabb;

    /// Whether primitives may be split where a builder splits space: at the plane, and by [`Primitives::split`] where
    /// `phr-quality` or `phr-best` cuts a node that holds a single one. One that is split is in several leaves, and may
    /// be tested more than once by a ray.
    fn splits(&self) -> bool {
        false
    }

    /// Splits what of primitive `id` lies in `part`, a part of its box, by the plane at `position` along `axis` (0
    /// for x): the boxes of what is below and above. Tighter ones than the halves of `part`, which are the default,
    /// make better trees; a box that misses some of the primitive makes rays miss it. Empty where nothing is.
    /// It must not wait for other tasks of the rayon pool: the builder's tasks, which may run meanwhile, wait for each
    /// other.
    fn split(&self, id: u32, part: Aabb, axis: usize, position: f32) -> [Aabb; 2] {
        let _ = id;
        [part.below(axis, position), part.above(axis, position)]
    }
}

/// Boxes that are not split.
impl Primitives for [Aabb] {
    fn len(&self) -> usize {
        self.len()
    }

    fn bounds(&self, id: u32) -> Aabb {
        self[id as usize]
    }
}

impl Primitives for Vec<Aabb> {
    fn len(&self) -> usize {
        self.len()
    }

    fn bounds(&self, id: u32) -> Aabb {
        self[id as usize]
    }
}

/// What refers to primitives, for these.
macro_rules! referring {
    ($($reference:ty, $($bound:ident)|+;)*) => {$(
        impl<P: ?Sized $(+ $bound)+> Primitives for $reference {
            fn len(&self) -> usize {
                (**self).len()
            }

            fn is_empty(&self) -> bool {
                (**self).is_empty()
            }

            fn bounds(&self, id: u32) -> Aabb {
                (**self).bounds(id)
            }

            fn splits(&self) -> bool {
                (**self).splits()
            }

            fn split(&self, id: u32, part: Aabb, axis: usize, position: f32) -> [Aabb; 2] {
                (**self).split(id, part, axis, position)
            }
        }
    )*};
}

referring! {
    &P, Primitives;
    Box<P>, Primitives;
    Arc<P>, Primitives | Send;
}
