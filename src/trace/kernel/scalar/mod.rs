//! The portable tests, on plain arrays that the compiler vectorises, without fused operations.
//!
//! [`fast`] and [`watertight`] are the two kernels, [`boxes`] and [`crossing`] what they share.

mod boxes;
mod crossing;
mod fast;
mod watertight;

pub(super) use fast::FastScalar;
#[cfg(target_arch = "x86_64")]
pub(super) use fast::SMALLEST_DIRECTION;
pub(super) use watertight::WatertightScalar;
