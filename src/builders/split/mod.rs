//! Splitting a cut (paper 4.2, 4.4).

pub(crate) mod cost;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
pub(crate) mod lane_cost;
pub(crate) mod object;
pub(crate) mod spatial;
pub(crate) mod sweep_sah;
pub(crate) mod three_axes;
