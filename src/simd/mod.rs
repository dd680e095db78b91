//! Vectors.

#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
pub(crate) mod vector;
