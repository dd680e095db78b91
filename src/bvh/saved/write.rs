//! Saving a tree: into a file beside, which takes the place of an older one when it is whole.

use super::CHUNK;
use super::SavedError;
use super::header::{BYTES, Header, can_be_loaded, checksum, step};
use super::replace::replace;
use crate::bvh::WideBvh;
use crate::bvh::limits::check_width;
use crate::bvh::record::Record;
use crate::geometry::Mesh;
use rayon::prelude::*;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Chunks converted at a time.
const BATCH: usize = 64;

impl<const N: usize> WideBvh<N> {
    /// Saves the tree, which `builder` built over `mesh` as it is now: that is not checked here, but in
    /// [`Bvh::save`](crate::Bvh::save).
    ///
    /// # Errors
    /// An unwritable place, or one that is no regular file; more leaf blocks than can be loaded.
    pub fn save(&self, mesh: &Mesh, builder: &str, path: impl AsRef<Path>) -> Result<(), SavedError> {
        self.write(mesh, builder, path.as_ref())
    }

    fn write(&self, mesh: &Mesh, builder: &str, path: &Path) -> Result<(), SavedError> {
        const { check_width::<N>() };
        let (nodes, blocks) = (self.nodes.len() as u64, self.blocks.len() as u64);
        if !can_be_loaded(nodes, blocks, mesh.len() as u64) {
            return Err(SavedError::TooMany { path: path.to_owned(), nodes, blocks });
        }
        // Several programs, or threads of one, may save the same tree at a time.
        static SAVED: AtomicUsize = AtomicUsize::new(0);
        let mark = format!(".{}-{}.part", std::process::id(), SAVED.fetch_add(1, Relaxed));
        let write = |file: &mut File| {
            file.write_all(&[0; BYTES])?;
            let sum = put(&self.nodes, 0, file)?;
            let sum = put(&self.blocks, sum, file)?;
            let header = Header {
                width: N as u32,
                root: self.root,
                nodes,
                blocks,
                bounds: self.bounds,
                mesh: mesh.fingerprint(),
                triangles: mesh.len() as u64,
                checksum: sum,
                builder: builder.to_owned(),
            };
            file.seek(SeekFrom::Start(0))?;
            file.write_all(&header.to_bytes())
        };
        replace(path, &mark, write).map_err(SavedError::io(path))
    }
}

/// Appends the records and returns `sum` with their checksums.
fn put<R: Record>(records: &[R], mut sum: u64, file: &mut File) -> io::Result<u64> {
    for batch in records.chunks(CHUNK * BATCH) {
        let chunks: Vec<(Vec<u8>, u64)> = batch
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut bytes = vec![0; chunk.len() * R::BYTES];
                chunk.iter().zip(bytes.chunks_mut(R::BYTES)).for_each(|(record, to)| record.put(to));
                let sum = checksum(&bytes);
                (bytes, sum)
            })
            .collect();
        for (bytes, of_chunk) in chunks {
            file.write_all(&bytes)?;
            sum = step(sum, of_chunk);
        }
    }
    Ok(sum)
}
