//! Vectors on other processors than x86-64: none. No token is made there, so that what takes one is compiled and never
//! runs.

use super::vector::Lanes;

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
                    fmadd(f32, f32, f32) -> f32;
                    fmsub(f32, f32, f32) -> f32;
                    fnmadd(f32, f32, f32) -> f32;
                    reciprocal(f32) -> f32;
                    flip(f32, f32) -> f32;
                    min(f32, f32) -> f32;
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
                    count_where(bool, f32) -> f32;
                    min_where(bool, f32, f32) -> f32;
                    max_where(bool, f32, f32) -> f32;
                }
            }
        )*
    };
}

#[cfg(not(target_arch = "x86_64"))]
without_vectors!(super::Avx2, super::Avx512, super::vector::Avx512Half);

// So that a method that is missing above is found on x86-64 too, where the tests are compiled.
#[cfg(target_arch = "x86_64")]
without_vectors!(std::convert::Infallible);
