//! Loading a tree: sizes are checked against the file's before memory is taken, links before they are followed.

use super::CHUNK;
use super::SavedError;
use super::header::{BYTES, Header, checksum, step};
use crate::bvh::WideBvh;
use crate::bvh::record::Record;
use crate::geometry::Mesh;
use crate::scene::mesh_fingerprint;
use rayon::prelude::*;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Chunks read at a time.
const BATCH: usize = 16;

/// What the file at `path` says of its tree.
///
/// # Errors
/// No such file, or not a saved tree.
pub fn header_of(path: &Path) -> Result<Header, SavedError> {
    Ok(open(path)?.1)
}

/// The file after its header, which fits its length.
fn open(path: &Path) -> Result<(File, Header), SavedError> {
    let io = SavedError::io(path);
    let metadata = std::fs::metadata(path).map_err(&io)?;
    if !metadata.is_file() {
        return Err(SavedError::unusable(path, "not a regular file"));
    }
    let mut file = File::open(path).map_err(&io)?;
    let mut bytes = [0; BYTES];
    file.read_exact(&mut bytes).map_err(|_| SavedError::unusable(path, "shorter than a saved tree"))?;
    let header = Header::of_bytes(&bytes).map_err(|what| SavedError::unusable(path, what))?;
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
    pub fn load(mesh: &Mesh, path: &Path) -> Result<Self, SavedError> {
        let (mut file, header) = open(path)?;
        if header.width != N as u32 {
            let what = format!("a tree of {} children per node, not {N}", header.width);
            return Err(SavedError::unusable(path, what));
        }
        if (header.triangles, header.mesh) != (mesh.len() as u64, mesh_fingerprint(mesh)) {
            let Header { triangles, mesh, .. } = header;
            return Err(SavedError::OtherMesh { path: path.to_owned(), triangles, mesh });
        }
        let (nodes, sum) = get(header.nodes, 0, &mut file, path)?;
        let (blocks, sum) = get(header.blocks, sum, &mut file, path)?;
        if sum != header.checksum {
            return Err(SavedError::unusable(path, "damaged nodes or blocks"));
        }
        let tree = Self { root: header.root, bounds: header.bounds, nodes, blocks };
        tree.validate_links(mesh.len())
            .map_err(|source| SavedError::Invalid { path: path.to_owned(), source })?;
        Ok(tree)
    }
}

/// The next `count` records, and `sum` with their checksums.
fn get<R: Record>(
    count: u64,
    mut sum: u64,
    file: &mut File,
    path: &Path,
) -> Result<(Vec<R>, u64), SavedError> {
    let io = SavedError::io(path);
    // As many as the file is long.
    let count = count as usize;
    let mut records: Vec<R> = Vec::new();
    let no_memory = |_| std::io::Error::from(std::io::ErrorKind::OutOfMemory);
    records.try_reserve_exact(count).map_err(no_memory).map_err(&io)?;
    let mut bytes = vec![0; R::BYTES * (CHUNK * BATCH).min(count)];
    while records.len() < count {
        let batch = (count - records.len()).min(CHUNK * BATCH);
        let bytes = &mut bytes[..R::BYTES * batch];
        file.read_exact(bytes).map_err(&io)?;
        let sums: Vec<u64> = bytes.par_chunks(R::BYTES * CHUNK).map(checksum).collect();
        sum = sums.into_iter().fold(sum, step);
        records.par_extend(bytes.par_chunks(R::BYTES).with_min_len(CHUNK / 4).map(R::get));
    }
    Ok((records, sum))
}
