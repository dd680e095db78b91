//! Captures the standard output of C code.

#![allow(unsafe_code)]

use std::io::{self, Read, Write};
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::thread;

/// Runs `f` with the process's standard output (descriptor 1) sent to a pipe, and returns the output.
/// Rust's own standard output is locked meanwhile, so that no other thread's lines are taken; C code of other
/// threads would be.
///
/// # Errors
/// If standard output is closed or descriptors run out.
pub(super) fn stdout_of<T>(f: impl FnOnce() -> T) -> io::Result<(T, String)> {
    let mut lock = io::stdout().lock();
    lock.flush()?;
    flush_c();
    let saved = lock.as_fd().try_clone_to_owned()?;
    let (mut reader, writer) = io::pipe()?;
    let drain = thread::Builder::new().name("embree-output".to_owned()).spawn(move || {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).map(|_| bytes)
    })?;
    let redirected = point_stdout_at(&writer).map(|()| Restore(saved));
    drop(writer);
    let restore = redirected?;
    let result = f();
    drop(restore);
    let bytes = drain.join().map_err(|_| io::Error::other("the reading thread panicked"))??;
    Ok((result, String::from_utf8_lossy(&bytes).into_owned()))
}

/// Points descriptor 1 back where it was, also when the captured code panics.
struct Restore(OwnedFd);

impl Drop for Restore {
    fn drop(&mut self) {
        flush_c();
        // Fails for no descriptor that is open, as both are.
        let _ = point_stdout_at(&self.0);
    }
}

fn point_stdout_at(target: &impl AsRawFd) -> io::Result<()> {
    loop {
        // SAFETY: both descriptors are open; the one behind 1 is closed by the kernel, and nobody owns it in
        // Rust (`io::stdout` borrows the number, which stays open).
        if unsafe { libc::dup2(target.as_raw_fd(), libc::STDOUT_FILENO) } >= 0 {
            return Ok(());
        }
        let error = io::Error::last_os_error();
        if error.kind() != io::ErrorKind::Interrupted {
            return Err(error);
        }
    }
}

/// Flushes the buffers of C streams.
fn flush_c() {
    // SAFETY: a null stream means all; the C library locks each.
    unsafe { libc::fflush(std::ptr::null_mut()) };
}
