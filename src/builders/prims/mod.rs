//! What a tree is built over: references to triangles. Needles may be presplit into several (paper 5.3).

pub(crate) mod needle;
pub(crate) mod presplit;
pub(crate) mod refs;
