//! Files that are whole at any moment: what is written goes into a file beside, which takes the place of the old one.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// Writes the file at `path`: at any time, also after a kill, it is the old one or the new one, whole. What is written
/// until then is in a file beside, `mark` behind its name. A link stays, and what it leads to is replaced; one that
/// leads nowhere is replaced itself.
///
/// # Errors
/// An unwritable place, or one that is there and no regular file, as a device.
pub(crate) fn replace(
    path: &Path,
    mark: &str,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let place = match std::fs::metadata(path) {
        Ok(there) if !there.is_file() => {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"));
        }
        Ok(_) => std::fs::canonicalize(path)?,
        Err(_) => path.to_owned(),
    };
    let part = beside(&place, mark);
    let written = File::create(&part).and_then(|mut file| {
        write(&mut file)?;
        file.sync_data()?;
        std::fs::rename(&part, &place)
    });
    if written.is_err() {
        // On a full disk what was written of it would only be in the way. That it cannot be removed is no news.
        let _ = std::fs::remove_file(&part);
    }
    written
}

fn beside(path: &Path, mark: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(mark);
    path.with_file_name(name)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Write as _;

    #[test]
    fn links_stay_and_what_is_no_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.path().join(name));
        let write = |path: &Path| replace(path, ".part", |file| file.write_all(b"new"));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        let told = |path: &Path| write(path).unwrap_err().to_string();
        assert_eq!([told(folder.path()), told(Path::new("/dev/null"))], ["not a regular file"; 2]);
        let failed = replace(&file, ".part", |_| Err(io::Error::other("full")));
        assert_eq!(
            (failed.unwrap_err().to_string(), std::fs::read(&file).unwrap()),
            ("full".into(), b"new".into())
        );
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
