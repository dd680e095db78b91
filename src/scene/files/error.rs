//! Errors of scene files.

use crate::geometry::{Dropped, MeshError};
use crate::scene::one_line::{LONG, one_line};
use std::path::{Path, PathBuf};

/// Most characters of a place, a problem or a remark.
pub(super) const SHORT: usize = 160;

/// Why a scene could not be loaded: one line that names the file, the place in it and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file is missing or cannot be opened.
    #[error("{}: {source}; check the path and its permissions", shown(path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// The path names a directory.
    #[error("{}: a directory; name a scene file in it (.ply, .obj, .stl, .gltf or .glb)", shown(.0))]
    Directory(PathBuf),
    /// A pipe, a device or a socket.
    #[error("{}: not a regular file; copy what it gives to one and name that", shown(.0))]
    NotAFile(PathBuf),
    /// No format by its name.
    #[error(
        "{}: not a scene file by its name; give a .ply, .obj, .stl, .gltf or .glb, plain or with .gz or .zst",
        shown(.0)
    )]
    UnknownFormat(PathBuf),
    /// The content violates the format.
    #[error("{}: {place}: {problem}; {remedy}", shown(path))]
    Malformed {
        /// The file.
        path: PathBuf,
        /// A line, or an element and its index from 0.
        place: String,
        /// The fault at that place.
        problem: String,
        /// The remedy.
        remedy: &'static str,
    },
    /// The file could be read but has no triangle that can be built over.
    #[error(
        "{}: no usable triangle among the {given} given{}; check that the file holds faces with finite vertices",
        shown(path),
        why_empty(dropped, first_dropped.as_deref(), remarks)
    )]
    Empty {
        /// The file.
        path: PathBuf,
        /// Triangles given.
        given: usize,
        /// Triangles dropped, by reason.
        dropped: Dropped,
        /// Where the file has the first of these, as in
        /// [`Contents::first_dropped`](crate::scene::Contents::first_dropped).
        first_dropped: Option<String>,
        /// What is no triangle, and what of the file was not applied, in words.
        remarks: Vec<String>,
    },
    /// The file could be read but holds no mesh that can be built.
    #[error("{}: {source}", shown(path))]
    Unusable {
        /// The file.
        path: PathBuf,
        /// The fault of the mesh.
        source: MeshError,
    },
}

/// A path in a message: a file's name may hold the end of a line.
fn shown(path: &Path) -> String {
    one_line(&path.display().to_string(), LONG)
}

/// Why no triangle is left, in parentheses; nothing where nothing is known.
fn why_empty(dropped: &Dropped, first: Option<&str>, remarks: &[String]) -> String {
    let of_dropped = (dropped.total() > 0).then(|| {
        let first = first.map_or_else(String::new, |place| format!(", first: {place}"));
        format!("{dropped}{first}")
    });
    let all: Vec<String> = of_dropped.into_iter().chain(remarks.iter().cloned()).collect();
    if all.is_empty() { String::new() } else { format!(" ({})", one_line(&all.join("; "), LONG)) }
}

/// A fault found by the reader of one format; the caller adds the file's name.
#[derive(Debug)]
pub(in crate::scene) struct Fault {
    /// A line, or an element and its index from 0.
    pub place: String,
    /// The fault at that place.
    pub problem: String,
    /// The remedy.
    pub remedy: &'static str,
}

impl Fault {
    /// The remedy for missing or damaged bytes.
    pub const DAMAGED: &'static str = "the file is truncated or damaged, fetch or export it again";

    /// `place` and `problem` may quote the file: control characters are replaced and the length is limited.
    pub fn new(place: impl AsRef<str>, problem: &str, remedy: &'static str) -> Self {
        Self { place: one_line(place.as_ref(), SHORT), problem: one_line(problem, SHORT), remedy }
    }

    /// The same, with the file's name.
    pub fn in_file(self, path: &Path) -> SceneError {
        let Self { place, problem, remedy } = self;
        SceneError::Malformed { path: path.to_owned(), place, problem, remedy }
    }
}
