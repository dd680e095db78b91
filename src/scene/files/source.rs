//! Opens scene files: regular ones only, decompressed, and no more of them than their size promises.

use super::error::SceneError;
use super::guard::{Guard, MOST_EXPANSION, most_expanded};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// How a file is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Gzip,
    Zstd,
}

/// Buffer between file or decoder and parser, bytes, of files as long.
const BUFFER: u64 = 1 << 20;
/// Windows up to 2^27 bytes (`zstd --long`) are accepted.
const ZSTD_WINDOW_LOG: u32 = 27;

/// Opens a regular file. Others may block for ever or have no end.
pub(super) fn open(path: &Path) -> Result<(File, u64), SceneError> {
    let unreadable = |source| SceneError::Unreadable { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(SceneError::Directory(path.to_owned()));
    }
    if !metadata.is_file() {
        return Err(SceneError::NotAFile(path.to_owned()));
    }
    Ok((File::open(path).map_err(unreadable)?, metadata.len()))
}

/// The file's content, of `path` and `guard`'s limits.
pub(super) fn reader<'a>(
    path: &Path,
    compression: Compression,
    guard: &'a Guard,
) -> Result<Box<dyn BufRead + 'a>, SceneError> {
    let (file, length) = open(path)?;
    let left = most_expanded(length);
    let buffer = |most: u64| most.clamp(1 << 10, BUFFER) as usize;
    let own = buffer(length);
    let plain = |inner: Box<dyn Read>| {
        let most = buffer(length.saturating_mul(MOST_EXPANSION));
        Box::new(BufReader::with_capacity(most, Expanded { inner, left, guard }))
    };
    Ok(match compression {
        Compression::None => Box::new(BufReader::with_capacity(own, file)),
        Compression::Gzip => {
            plain(Box::new(flate2::bufread::MultiGzDecoder::new(BufReader::with_capacity(own, file))))
        }
        Compression::Zstd => {
            let decoder = zstd::Decoder::new(file).and_then(|mut decoder| {
                decoder.window_log_max(ZSTD_WINDOW_LOG)?;
                Ok(decoder)
            });
            let unreadable = |source| SceneError::Unreadable { path: path.to_owned(), source };
            plain(Box::new(decoder.map_err(unreadable)?))
        }
    })
}

/// What comes out of a decoder, which may be far more than went in.
struct Expanded<'a> {
    inner: Box<dyn Read>,
    left: u64,
    guard: &'a Guard,
}

impl Read for Expanded<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(buffer).map_err(|error| match error.kind() {
            io::ErrorKind::Interrupted => error,
            _ => {
                let remedy = "fetch or compress it again, or end its name as its content is";
                io::Error::other(self.guard.refuse("its compressed content", &error.to_string(), remedy))
            }
        })?;
        self.left = self.left.checked_sub(read as u64).ok_or_else(|| {
            let problem = format!("grows more than {MOST_EXPANSION}-fold when decompressed");
            io::Error::other(self.guard.refuse("its size", &problem, "decompress it first and look at it"))
        })?;
        Ok(read)
    }
}

/// The content of a regular file of at most `most` bytes.
pub(super) fn read_small(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"));
    }
    let mut content = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut content)?;
    if content.len() as u64 > most {
        return Err(io::Error::new(io::ErrorKind::InvalidData, format!("larger than {most} bytes")));
    }
    Ok(content)
}
