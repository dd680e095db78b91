//! A box that carries two numbers where its corners have unused lanes.

use crate::geometry::Aabb;
use glam::{Vec3A, Vec4, Vec4Swizzles};

/// A box and two tags, kept as two vectors: reading the whole right after writing its parts would stall.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct TaggedBox {
    /// Lower corner and first tag.
    lower: Vec4,
    /// Upper corner and second tag.
    upper: Vec4,
}

impl TaggedBox {
    /// All zeros.
    pub const ZERO: Self = Self { lower: Vec4::ZERO, upper: Vec4::ZERO };

    /// The box `bounds` with its tags.
    #[inline(always)]
    pub fn new(bounds: Aabb, tags: [u32; 2]) -> Self {
        let with = |corner: Vec3A, tag| corner.extend(f32::from_bits(tag));
        Self { lower: with(bounds.min, tags[0]), upper: with(bounds.max, tags[1]) }
    }

    /// The empty box with tags.
    pub const fn empty(tags: [u32; 2]) -> Self {
        const INF: f32 = f32::INFINITY;
        Self {
            lower: Vec4::new(INF, INF, INF, f32::from_bits(tags[0])),
            upper: Vec4::new(-INF, -INF, -INF, f32::from_bits(tags[1])),
        }
    }

    /// The box.
    #[inline(always)]
    pub fn bounds(&self) -> Aabb {
        // Tags in the fourth lanes would be denormal floats, with which arithmetic is slow.
        let corner = |corner: Vec4| Vec3A::from_vec4(corner.xyzz());
        Aabb::new(corner(self.lower), corner(self.upper))
    }

    /// The box with the tags in the fourth lanes of its corners: to be copied, or where tags are no denormal floats.
    #[inline(always)]
    pub fn bounds_with_tags(&self) -> Aabb {
        Aabb::new(Vec3A::from_vec4(self.lower), Vec3A::from_vec4(self.upper))
    }

    /// The lower corner and the upper one, each followed by its tag, as they lie in memory.
    #[inline(always)]
    pub fn corners(&self) -> [&[f32; 4]; 2] {
        [self.lower.as_ref(), self.upper.as_ref()]
    }

    /// The first tag.
    #[inline(always)]
    pub fn first(&self) -> u32 {
        self.lower.w.to_bits()
    }

    /// The second tag.
    #[inline(always)]
    pub fn second(&self) -> u32 {
        self.upper.w.to_bits()
    }

    /// The same box with another first tag.
    #[inline(always)]
    pub fn with_first(mut self, tag: u32) -> Self {
        self.lower.w = f32::from_bits(tag);
        self
    }
}
