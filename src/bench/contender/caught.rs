//! Panics of builders as errors, so that one broken builder does not end a run.

use crate::memory::catch_out_of_memory;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs `work`; its panic becomes an error of one line that begins with `who`. What `work` was changing must
/// not be used after an error.
///
/// # Errors
/// The panic's message, or what there was no memory for.
pub fn caught<T>(who: &str, work: impl FnOnce() -> T) -> Result<T, String> {
    let done = catch_unwind(AssertUnwindSafe(|| catch_out_of_memory(work))).map_err(|payload| {
        let message = payload.downcast_ref::<String>().map(String::as_str);
        let message = message.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no message");
        let message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        format!("{who} panicked: {message}")
    })?;
    done.map_err(|error| format!("{who}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_are_errors_of_one_line() {
        assert_eq!(caught("it", || 7), Ok(7));
        assert_eq!(caught("it", || panic!("plain")), Err::<(), _>("it panicked: plain".into()));
        let formatted = || panic!("at {}\n  below", 3);
        assert_eq!(caught("it", formatted), Err::<(), _>("it panicked: at 3 below".into()));
        let much = || crate::memory::huge_pages::reserve(&mut Vec::<u8>::new(), 1 << 62, "leaf blocks");
        let told = caught("the builder", much).unwrap_err();
        assert!(told.starts_with("the builder: no memory for leaf blocks, 4398046511104 MiB; "), "{told}");
        let other = || std::panic::panic_any(5);
        assert_eq!(caught("it", other), Err::<(), _>("it panicked: no message".into()));
    }
}
