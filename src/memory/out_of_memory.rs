//! Allocations that fail, as errors: what asks for a large array may not be able to return one from deep inside a
//! build, so it unwinds to whoever began the build. Small allocations still end the process, as Rust has it.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Memory that the system did not give.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no memory for {what}, {mebibytes} MiB; free some, raise its limit (ulimit -v) or take a smaller scene", mebibytes = bytes >> 20)]
pub struct OutOfMemory {
    /// What it was for, e.g. "leaf blocks".
    pub what: &'static str,
    /// Bytes that were asked for.
    pub bytes: usize,
}

impl OutOfMemory {
    /// Unwinds to [`catch_out_of_memory`], without a word on the way; a panic as any other while nobody asks to be
    /// told, or where nothing unwinds. Who asks is not known here, as builds run on many threads.
    pub(super) fn unwind(self) -> ! {
        if cfg!(panic = "abort") || LISTENERS.load(Relaxed) == 0 {
            panic!("{self}");
        }
        resume_unwind(Box::new(self))
    }
}

/// Calls of [`catch_out_of_memory`] under way, whichever thread they are on: builds run on many.
static LISTENERS: AtomicUsize = AtomicUsize::new(0);

/// Runs `work`, which may ask for arrays that the system has no memory for. What it was changing is of no use after an
/// error but to be dropped.
///
/// # Errors
/// The array.
pub(crate) fn catch_out_of_memory<T>(work: impl FnOnce() -> T) -> Result<T, OutOfMemory> {
    LISTENERS.fetch_add(1, Relaxed);
    let done = catch_unwind(AssertUnwindSafe(work));
    LISTENERS.fetch_sub(1, Relaxed);
    done.map_err(|payload| match payload.downcast::<OutOfMemory>() {
        Ok(error) => *error,
        Err(panic) => resume_unwind(panic),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::huge_pages;

    #[test]
    fn what_the_system_does_not_give_is_told_across_threads() {
        let much = || huge_pages::reserve(&mut Vec::<u64>::new(), 1 << 59, "much");
        let error = OutOfMemory { what: "much", bytes: 1 << 62 };
        assert_eq!(catch_out_of_memory(much), Err(error));
        assert_eq!(catch_out_of_memory(|| rayon::join(much, || 3).1), Err(error));
        assert_eq!(error.to_string().lines().count(), 1);
        assert_eq!(catch_out_of_memory(|| 7), Ok(7));
        let panic = std::panic::catch_unwind(|| catch_out_of_memory(|| resume_unwind(Box::new("other"))));
        assert_eq!(panic.unwrap_err().downcast_ref(), Some(&"other"));
    }
}
