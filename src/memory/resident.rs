//! Resident memory of this process, as Linux counts it.

#![allow(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

/// Bytes resident now.
///
/// # Errors
/// One line, where the system does not tell.
pub(crate) fn now() -> Result<u64, String> {
    bytes_of("VmRSS:")
}

/// Most bytes resident at a time since [`reset_peak`].
///
/// # Errors
/// One line, where the system does not tell.
pub(crate) fn peak() -> Result<u64, String> {
    bytes_of("VmHWM:")
}

/// Lets the peak begin again from what is resident now.
///
/// # Errors
/// One line, where the system does not allow it.
pub(crate) fn reset_peak() -> Result<(), String> {
    let file = "/proc/self/clear_refs";
    std::fs::write(file, "5")
        .map_err(|error| format!("{file}: {error}; resident memory is measured on Linux"))
}

/// Gives freed memory that the allocator keeps back to the system, where that is glibc's.
pub(crate) fn trim() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: the call touches memory that nobody has in use, and takes the allocator's own locks.
    unsafe {
        libc::malloc_trim(0);
    }
}

fn bytes_of(key: &str) -> Result<u64, String> {
    let file = "/proc/self/status";
    let text = std::fs::read_to_string(file)
        .map_err(|error| format!("{file}: {error}; resident memory is measured on Linux"))?;
    let line = text.lines().find_map(|line| line.strip_prefix(key));
    let kibibytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    Ok(1024
        * kibibytes.ok_or_else(|| format!("{file}: no line {key}; resident memory is measured on Linux"))?)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    #[test]
    fn what_is_touched_is_resident_and_the_peak_outlives_it() {
        // Other tests share this process: only its own memory is sure to be there.
        super::reset_peak().unwrap();
        let touched = std::hint::black_box(vec![1u8; 64 << 20]);
        assert!(super::now().unwrap() >= touched.len() as u64);
        drop(touched);
        assert!(super::peak().unwrap() >= 64 << 20);
        super::trim();
    }
}
