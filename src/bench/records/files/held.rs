//! One program at a time in a folder.

use std::fs::{File, TryLockError};
use std::path::Path;

/// Another program has the folder.
#[derive(Debug)]
pub struct HeldByAnother;

/// Keeps other programs that ask for it out of `folder` until the file is dropped or this program has ended, however
/// it does. Where folders cannot be locked, as on some file systems, none is kept out.
///
/// # Errors
/// Another program has it.
pub fn hold(folder: &Path) -> Result<Option<File>, HeldByAnother> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Err(HeldByAnother),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_held_until_the_file_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let held = hold(folder.path()).unwrap();
        assert!(held.is_none() || hold(folder.path()).is_err());
        drop(held);
        assert!(hold(folder.path()).is_ok());
    }
}
