//! Instruction sets: detected once, and proven by tokens. Builders take [`Isa::best`] when they are made. By it cuts
//! are split (`builders/split/object/strategy.rs`, `spatial/strategy.rs`, `three_axes.rs`, `subtree_sweep.rs`), LBVHs
//! get leaves and wide nodes (`builders/lbvh/direct`), and PLOC searches (`builders/clusters/ploc/nearest.rs`). Morton
//! codes ask for it themselves (`builders/lbvh/morton.rs`).
//!
//! A value of [`Isa`] other than [`Isa::Scalar`] carries a token, [`Avx2`] or [`Avx512`], and only detection
//! makes tokens. A function that takes one therefore runs only where the processor has the instructions, and
//! `Avx2::run` runs a closure compiled for them without `unsafe` at the call.

#![allow(unsafe_code)]

#[cfg(any(test, not(target_arch = "x86_64")))]
mod elsewhere;
pub(crate) mod vector;

use std::fmt;
use std::sync::OnceLock;

/// The environment variable that lowers [`Isa::best`]: "scalar", "avx2" or "avx512". It never raises it.
const VARIABLE: &str = "PHR_ISA";

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Isa {
    /// Portable code, vectorised by the compiler at best.
    Scalar,
    /// x86-64 with AVX2, FMA and BMI (Haswell, Zen and later).
    Avx2(Avx2),
    /// The same with AVX-512 F, VL, BW and DQ (Skylake-X, Zen 4 and later).
    Avx512(Avx512),
}

/// Proves that the processor has AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Avx2(());

/// Proves that the processor has AVX-512 F, VL, BW and DQ, and all that [`Avx2`] proves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Avx512(());

impl Isa {
    /// The names of all instruction sets, from least to most able.
    pub const NAMES: [&str; 3] = ["scalar", "avx2", "avx512"];

    /// The most able instruction set of this processor, or the one that the environment variable `PHR_ISA`
    /// names if that is lower. Detected once per process. An unknown name is ignored here; programs refuse it
    /// by [`Isa::check_environment`].
    pub fn best() -> Self {
        static BEST: OnceLock<Isa> = OnceLock::new();
        *BEST.get_or_init(|| Self::of_processor().lowered_to(std::env::var(VARIABLE).ok().as_deref()))
    }

    /// Those up to [`Isa::best`], from least to most able.
    pub fn available() -> impl Iterator<Item = Self> {
        let best = Self::best();
        let avx512 = if let Self::Avx512(token) = best { Some(token) } else { None };
        let all = [Some(Self::Scalar), best.avx2().map(Self::Avx2), avx512.map(Self::Avx512)];
        all.into_iter().flatten()
    }

    /// The name in records and in `PHR_ISA`: "scalar", "avx2" or "avx512".
    pub fn name(self) -> &'static str {
        Self::NAMES[self.rank()]
    }

    /// Refuses a value of `PHR_ISA` that names no instruction set.
    ///
    /// # Errors
    /// One line that names the variable, its value and the names it may have.
    pub fn check_environment() -> Result<(), String> {
        check(std::env::var_os(VARIABLE).map(|name| name.to_string_lossy().into_owned()).as_deref())
    }

    /// The token of AVX2, which processors with AVX-512 have too.
    #[inline]
    pub(crate) fn avx2(self) -> Option<Avx2> {
        match self {
            Self::Scalar => None,
            Self::Avx2(token) => Some(token),
            Self::Avx512(token) => Some(token.avx2()),
        }
    }

    /// Calls `f`, compiled for AVX2 where the processor has it: as [`Avx2::run`].
    #[inline(always)]
    pub(crate) fn run<R>(self, f: impl FnOnce() -> R) -> R {
        match self.avx2() {
            Some(token) => token.run(f),
            None => f(),
        }
    }

    /// The most able instruction set of this processor, whatever `PHR_ISA` names: that of Embree's kernels.
    #[cfg(target_arch = "x86_64")]
    pub(crate) fn of_processor() -> Self {
        use std::arch::is_x86_feature_detected as has;
        let avx2 =
            has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt");
        let avx512 = has!("avx512f") && has!("avx512vl") && has!("avx512bw") && has!("avx512dq");
        match (avx2, avx512) {
            (true, true) => Self::Avx512(Avx512(())),
            (true, false) => Self::Avx2(Avx2(())),
            (false, _) => Self::Scalar,
        }
    }

    /// The only one there is.
    #[cfg(not(target_arch = "x86_64"))]
    pub(crate) fn of_processor() -> Self {
        Self::Scalar
    }

    /// The lower of `self` and the instruction set called `name`, `self` if there is none of that name.
    fn lowered_to(self, name: Option<&str>) -> Self {
        let wanted = name.and_then(|name| Self::NAMES.iter().position(|&known| known == name));
        match (wanted, self.avx2()) {
            (Some(rank), _) if rank >= self.rank() => self,
            (Some(1), Some(token)) => Self::Avx2(token),
            (Some(_), _) => Self::Scalar,
            (None, _) => self,
        }
    }

    /// Place among [`Isa::NAMES`].
    fn rank(self) -> usize {
        match self {
            Self::Scalar => 0,
            Self::Avx2(_) => 1,
            Self::Avx512(_) => 2,
        }
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Whether traversal should branch where it could look up: a branch that is foreseen ends a chain of waits, one that
/// is not costs more than the wait. Assumed to pay on AMD's processors (measured: Zen 4), and on no others (measured:
/// Emerald Rapids, a gain for 4-wide camera rays alone). Detected once per process.
#[inline]
pub(crate) fn foresees_branches() -> bool {
    static FORESEES: OnceLock<bool> = OnceLock::new();
    *FORESEES.get_or_init(is_of_amd)
}

/// Whether AMD, or Hygon after it, made the processor.
#[cfg(target_arch = "x86_64")]
fn is_of_amd() -> bool {
    // Miri does not know the instruction.
    if cfg!(miri) {
        return false;
    }
    // SAFETY: every processor of x86-64 has the instruction, and leaf 0.
    #[allow(unused_unsafe, reason = "later compilers call it safe")]
    let leaf = unsafe { std::arch::x86_64::__cpuid(0) };
    let vendor = [leaf.ebx, leaf.edx, leaf.ecx].map(u32::to_le_bytes);
    let is = |name: &[u8; 12]| vendor.as_flattened() == name;
    is(b"AuthenticAMD") || is(b"HygonGenuine")
}

#[cfg(not(target_arch = "x86_64"))]
fn is_of_amd() -> bool {
    false
}

fn check(name: Option<&str>) -> Result<(), String> {
    match name {
        Some(name) if !Isa::NAMES.contains(&name) => {
            let known = Isa::NAMES.join(", ");
            Err(format!("{VARIABLE}={name} names no instruction set; unset it or use one of {known}"))
        }
        _ => Ok(()),
    }
}

impl Avx2 {
    /// Calls `f` from a function compiled for AVX2. Pass `#[inline(always)] || ...`, so that the closure's body
    /// and all functions inlined into it are compiled for AVX2, too.
    #[inline(always)]
    pub(crate) fn run<R>(self, f: impl FnOnce() -> R) -> R {
        #[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt"))]
        #[inline]
        fn enabled<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        // SAFETY: the token is made only where all these features were detected.
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_unsafe))]
        unsafe {
            enabled(f)
        }
    }
}

impl Avx512 {
    /// AVX-512 includes AVX2.
    #[inline(always)]
    pub(crate) fn avx2(self) -> Avx2 {
        Avx2(())
    }

    /// As [`Avx2::run`], compiled for AVX-512.
    #[inline(always)]
    pub(crate) fn run<R>(self, f: impl FnOnce() -> R) -> R {
        #[cfg_attr(
            target_arch = "x86_64",
            target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,fma,bmi1,bmi2,lzcnt,popcnt")
        )]
        #[inline]
        fn enabled<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        // SAFETY: the token is made only where all these features were detected.
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_unsafe))]
        unsafe {
            enabled(f)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn available_ones_rise_from_scalar_to_the_best() {
        let available: Vec<Isa> = Isa::available().collect();
        assert_eq!(available[0], Isa::Scalar);
        assert_eq!(available.last(), Some(&Isa::best()));
        assert!(available.is_sorted());
        assert_eq!(available.iter().map(|isa| isa.name()).collect::<Vec<_>>(), Isa::NAMES[..available.len()]);
        assert!(Isa::best() <= Isa::of_processor());
    }

    #[test]
    fn a_name_lowers_but_never_raises() {
        for detected in [Isa::Scalar, Isa::Avx2(Avx2(())), Isa::Avx512(Avx512(()))] {
            for (rank, name) in Isa::NAMES.into_iter().enumerate() {
                assert_eq!(detected.lowered_to(Some(name)).rank(), rank.min(detected.rank()), "{name}");
            }
            assert_eq!(detected.lowered_to(Some("sse")), detected);
            assert_eq!(detected.lowered_to(None), detected);
        }
    }

    #[test]
    fn unknown_names_are_refused_in_one_line() {
        assert_eq!(check(None), Ok(()));
        assert!(Isa::NAMES.into_iter().all(|name| check(Some(name)).is_ok()));
        let error = check(Some("AVX3")).unwrap_err();
        assert_eq!(
            error,
            "PHR_ISA=AVX3 names no instruction set; unset it or use one of scalar, avx2, avx512"
        );
    }

    #[test]
    fn closures_run_compiled_for_each() {
        let numbers: Vec<u32> = (0..1000).collect();
        for isa in Isa::available() {
            let sum = match isa {
                Isa::Scalar => numbers.iter().sum::<u32>(),
                Isa::Avx2(token) => token.run(
                    #[inline(always)]
                    || numbers.iter().sum(),
                ),
                Isa::Avx512(token) => token.run(
                    #[inline(always)]
                    || numbers.iter().sum(),
                ),
            };
            assert_eq!(sum, 499_500, "{isa}");
        }
    }
}
