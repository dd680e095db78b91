//! Loading a tree: sizes are checked against the file's before memory is taken, links before they are followed.

use super::CHUNK;
use super::SavedError;
use super::header::{BYTES, Header, MAGIC, can_be_loaded, checksum, step};
use crate::bvh::links::Named;
use crate::bvh::record::Record;
use crate::bvh::validate::Invalid;
use crate::bvh::{TriangleBlock, WideBvh, WideNode};
use crate::geometry::Mesh;
use crate::memory::huge_pages;
use crate::memory::runs::{self, Run};
use std::fs::File;
#[cfg(not(unix))]
use std::io::Seek;
use std::io::{self, Read};
use std::path::Path;

/// What the file at `path` says of its tree.
///
/// # Errors
/// No such file, or not a saved tree.
pub fn header_of(path: impl AsRef<Path>) -> Result<Header, SavedError> {
    Ok(SavedTree::open(path.as_ref())?.header)
}

/// A file opened after its header, which fits its length: what is loaded from it is that tree, whatever takes its
/// place meanwhile.
pub(crate) struct SavedTree<'a> {
    file: File,
    path: &'a Path,
    /// What the file says of its tree.
    pub header: Header,
}

impl<'a> SavedTree<'a> {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// No such file, or not a saved tree.
    pub fn open(path: &'a Path) -> Result<Self, SavedError> {
        let (file, header) = open(path)?;
        Ok(Self { file, path, header })
    }
}

fn open(path: &Path) -> Result<(File, Header), SavedError> {
    let io = SavedError::io(path);
    // Before it is opened: that would wait for whoever writes into a pipe.
    if !std::fs::metadata(path).map_err(&io)?.is_file() {
        return Err(SavedError::not_a_tree(path, "not a regular file"));
    }
    let mut file = File::open(path).map_err(&io)?;
    // Of the file that is open: another may have taken its place.
    let metadata = file.metadata().map_err(&io)?;
    let mut bytes = Vec::with_capacity(BYTES);
    file.by_ref().take(BYTES as u64).read_to_end(&mut bytes).map_err(&io)?;
    if bytes.is_empty() || bytes.iter().zip(&MAGIC).any(|(byte, magic)| byte != magic) {
        return Err(SavedError::not_a_tree(path, "not a saved tree"));
    }
    let bytes = bytes
        .first_chunk::<BYTES>()
        .ok_or_else(|| SavedError::unusable(path, "shorter than a saved tree"))?;
    let header = Header::of_bytes(bytes).map_err(|what| SavedError::unusable(path, what))?;
    let node = match header.width {
        4 => 128,
        8 => 256,
        width => return Err(SavedError::unusable(path, format!("nodes of {width} children"))),
    };
    let of = |count: u64, bytes: u64| count.checked_mul(bytes);
    let length = of(header.nodes, node)
        .zip(of(header.blocks, 160))
        .and_then(|(nodes, blocks)| nodes.checked_add(blocks)?.checked_add(BYTES as u64));
    if length != Some(metadata.len()) {
        return Err(SavedError::unusable(
            path,
            format!("of {} bytes, not as long as its header says", metadata.len()),
        ));
    }
    Ok((file, header))
}

impl<const N: usize> WideBvh<N> {
    /// Loads the tree that was saved at `path` for `mesh`, on the current rayon pool.
    ///
    /// # Errors
    /// [`SavedError`]: a file that is damaged, of another width, of another mesh, or whose links form no tree.
    pub fn load(mesh: &Mesh, path: impl AsRef<Path>) -> Result<Self, SavedError> {
        Self::read(mesh, SavedTree::open(path.as_ref())?)
    }

    /// Loads the tree of an open file, likewise.
    pub(crate) fn read(mesh: &Mesh, saved: SavedTree<'_>) -> Result<Self, SavedError> {
        let SavedTree { file, path, header } = saved;
        if header.width != N as u32 {
            return Err(SavedError::OtherWidth {
                path: path.to_owned(),
                width: header.width,
                asked: N as u32,
            });
        }
        if (header.triangles, header.mesh) != (mesh.len() as u64, mesh.fingerprint()) {
            let Header { triangles, mesh, .. } = header;
            return Err(SavedError::OtherMesh { path: path.to_owned(), triangles, mesh });
        }
        // Before memory is taken for them.
        let Header { nodes, blocks, triangles, .. } = header;
        if !can_be_loaded(nodes, blocks, triangles) {
            return Err(SavedError::TooMany { path: path.to_owned(), nodes, blocks });
        }
        let blocks_at = BYTES as u64 + header.nodes * size_of::<WideNode<N>>() as u64;
        let invalid = SavedError::invalid(path);
        let named = Named::new(mesh.len()).map_err(|source| invalid(source.into()))?;
        let (nodes, sum, _) = get(header.nodes, 0, &file, BYTES as u64, path, |_, _| Ok(()))?;
        let note = |i: usize, block: &TriangleBlock| named.note(i, block);
        let (blocks, sum, noted) = get(header.blocks, sum, &file, blocks_at, path, note)?;
        if sum != header.checksum {
            return Err(SavedError::unusable(path, "damaged nodes or blocks"));
        }
        let tree = Self { root: header.root, bounds: header.bounds, nodes, blocks };
        noted.and_then(|()| tree.validate_nodes()).and_then(|()| named.validate()).map_err(&invalid)?;
        Ok(tree)
    }
}

/// `count` records from byte `begin` on, `sum` with their checksums, and the first flaw that `look` finds in one: each
/// chunk goes from the file through a thread's cache, where it is looked at, to its place.
#[expect(clippy::type_complexity, reason = "its parts are told above")]
fn get<R: Record + Copy>(
    count: u64,
    sum: u64,
    file: &File,
    begin: u64,
    path: &Path,
    look: impl Fn(usize, &R) -> Result<(), Invalid> + Sync + Send,
) -> Result<(Vec<R>, u64, Result<(), Invalid>), SavedError> {
    // As many as the file is long.
    let count = count as usize;
    let mut records: Vec<R> = Vec::new();
    huge_pages::try_reserve(&mut records, count, "a saved tree")
        .map_err(|source| SavedError::OutOfMemory { path: path.to_owned(), source })?;
    let chunk = R::BYTES * CHUNK;
    let one = |bytes: &mut Vec<u8>, number: usize, run: &mut Run<'_, R>| {
        // A run is no longer than a chunk.
        let (bytes, _) =
            bytes.split_at_mut_checked(R::BYTES * run.len()).ok_or(io::ErrorKind::InvalidData)?;
        read_at(file, path, bytes, begin + (number * chunk) as u64)?;
        let mut looked = Ok(());
        for (i, bytes) in bytes.chunks_exact(R::BYTES).enumerate() {
            let record = R::get(bytes);
            looked = looked.and_then(|()| look(number * CHUNK + i, &record));
            run.push(record);
        }
        Ok((checksum(bytes), looked))
    };
    let chunks =
        runs::fill(&mut records, count, CHUNK, || vec![0; chunk], one).map_err(SavedError::io(path))?;
    let add = |(sum, found): (u64, Result<(), Invalid>), (of_chunk, looked)| {
        (step(sum, of_chunk), found.and(looked))
    };
    let (sum, looked) = chunks.into_iter().fold((sum, Ok(())), add);
    Ok((records, sum, looked))
}

#[cfg(unix)]
fn read_at(file: &File, _: &Path, bytes: &mut [u8], at: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, at)
}

#[cfg(not(unix))]
fn read_at(_: &File, path: &Path, bytes: &mut [u8], at: u64) -> io::Result<()> {
    let mut file = File::open(path)?;
    file.seek(io::SeekFrom::Start(at))?;
    file.read_exact(bytes)
}
