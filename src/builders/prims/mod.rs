//! What a tree is built over: references to triangles, or to boxes of anything ([`geometry`], [`boxes`],
//! [`primitives`]). Needles may be presplit into several (paper 5.3).

pub(crate) mod boxes;
pub(crate) mod geometry;
pub(crate) mod needle;
pub(crate) mod presplit;
pub(crate) mod primitives;
pub(crate) mod refs;
pub(crate) mod thin;
