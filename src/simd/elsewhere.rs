//! Vectors on other processors than x86-64: none. No token is made there, so that what takes one is compiled and never
//! runs.

use super::vector::{Avx512Half, Lanes};
use super::{Avx2, Avx512};

/// Methods that nobody can call for want of a token.
macro_rules! methods {
    ($($name:ident($($type:ty),*) -> $result:ty;)*) => {
        $(
            fn $name(self, $(_: $type),*) -> $result {
                unreachable!("tokens of x86-64 are made there alone")
            }
        )*
    };
}

macro_rules! without_vectors {
    ($($token:ty),*) => {
        $(
            impl Lanes for $token {
                type F = f32;
                type M = bool;
                const N: usize = 8;

                fn run<R>(self, f: impl FnOnce() -> R) -> R {
                    f()
                }

                methods! {
                    splat(f32) -> f32;
                    load(&[f32; 16]) -> f32;
                    store(f32, &mut [f32; 16]) -> ();
                    add(f32, f32) -> f32;
                    sub(f32, f32) -> f32;
                    mul(f32, f32) -> f32;
                    max(f32, f32) -> f32;
                    least(f32) -> f32;
                    bits(bool) -> u32;
                    floor(f32) -> f32;
                    lt(f32, f32) -> bool;
                    le(f32, f32) -> bool;
                    and(bool, bool) -> bool;
                    or(bool, bool) -> bool;
                    not(bool) -> bool;
                    select(bool, f32, f32) -> f32;
                    min_where(bool, f32, f32) -> f32;
                    max_where(bool, f32, f32) -> f32;
                }
            }
        )*
    };
}

without_vectors!(Avx2, Avx512, Avx512Half);
