//! The bytes of the buffers in use: the container's, of a data URI, or of a file beside.

use super::container::exactly;
use crate::scene::files::error::{Fault, SceneError};
use crate::scene::files::guard::Guard;
use crate::scene::files::source::open;
use gltf::json::{Index, Root, accessor::Accessor, buffer};
use std::collections::BTreeSet;
use std::io::BufReader;
use std::path::{Component, Path};

/// By buffer; empty where it is not in use.
pub(super) struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    /// Loads those that `accessors` read from. `binary` is the container's chunk.
    pub fn load(
        root: &Root,
        accessors: &BTreeSet<usize>,
        mut binary: Option<Vec<u8>>,
        path: &Path,
        guard: &Guard,
    ) -> Result<Self, Fault> {
        let of = accessors.iter().filter_map(|&accessor| root.accessors.get(accessor));
        let views = of.flat_map(views).filter_map(|view| root.buffer_views.get(view.value()));
        let used: BTreeSet<usize> = views.map(|view| view.buffer.value()).collect();
        let lengths = used.iter().filter_map(|&index| Some(root.buffers.get(index)?.byte_length.0));
        guard.allow(lengths.fold(0, u64::saturating_add))?;
        let mut buffers: Vec<Vec<u8>> = root.buffers.iter().map(|_| Vec::new()).collect();
        for index in used {
            let Some(buffer) = root.buffers.get(index) else { continue };
            let fault = |problem: &str| Fault::new(format!("buffer {index}"), problem, Fault::DAMAGED);
            let bytes = match &buffer.uri {
                None if index == 0 => binary.take().ok_or_else(|| fault("has no data"))?,
                None => return Err(fault("has no data")),
                Some(uri) if uri.starts_with("data:") => {
                    let url = data_url::DataUrl::process(uri).map_err(|_| fault("a malformed data URI"))?;
                    url.decode_to_vec().map_err(|_| fault("a data URI that is no base64"))?.0
                }
                Some(uri) => beside(path, uri, [index as u64, buffer.byte_length.0], guard)?,
            };
            let length = buffer.byte_length.0;
            if (bytes.len() as u64) < length {
                return Err(fault(&format!("has {} bytes of {length}", bytes.len())));
            }
            if let Some(place) = buffers.get_mut(index) {
                *place = bytes;
            }
        }
        Ok(Self(buffers))
    }

    /// The bytes of a view.
    pub fn view(&self, root: &Root, index: Index<buffer::View>) -> Result<&[u8], Fault> {
        let fault =
            |problem: &str| Fault::new(format!("bufferView {}", index.value()), problem, Fault::DAMAGED);
        let view = root.buffer_views.get(index.value()).ok_or_else(|| fault("there is no such view"))?;
        let buffer = self.0.get(view.buffer.value()).ok_or_else(|| fault("there is no such buffer"))?;
        let begin = view.byte_offset.map_or(0, |offset| offset.0);
        let range = begin
            .checked_add(view.byte_length.0)
            .and_then(|end| Some(usize::try_from(begin).ok()?..usize::try_from(end).ok()?));
        range.and_then(|range| buffer.get(range)).ok_or_else(|| fault("beyond the end of its buffer"))
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.0.iter().map(|buffer| buffer.capacity() as u64).sum()
    }
}

/// The views that an accessor reads from.
fn views(accessor: &Accessor) -> impl Iterator<Item = Index<buffer::View>> {
    let sparse = accessor.sparse.iter();
    let sparse = sparse.flat_map(|sparse| [sparse.indices.buffer_view, sparse.values.buffer_view]);
    accessor.buffer_view.into_iter().chain(sparse)
}

/// The first `length` bytes of buffer `index`, of the file that `uri` names beside the scene's.
fn beside(scene: &Path, uri: &str, [index, length]: [u64; 2], guard: &Guard) -> Result<Vec<u8>, Fault> {
    let fault = |problem: &str, remedy| Fault::new(format!("buffer {index}"), problem, remedy);
    if uri.contains("://") {
        let remedy = "fetch that file and name it by its path in the scene's folder";
        return Err(fault(&format!("{uri} is not a file"), remedy));
    }
    let name = decoded(uri).ok_or_else(|| fault(&format!("{uri} names no file"), Fault::DAMAGED))?;
    // A scene from elsewhere is not to read what is not its own.
    if !Path::new(&name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        let problem = format!("{uri} lies outside the scene's folder");
        return Err(fault(&problem, "put it beside the scene and name it so"));
    }
    let (file, _) = open(&scene.with_file_name(&name)).map_err(|error| match error {
        SceneError::Unreadable { source, .. } => {
            fault(&format!("{name}: {source}"), "put that file beside the scene, readable")
        }
        _ => fault(&format!("{name}: not a regular file"), "put the file of that name beside the scene"),
    })?;
    let length =
        u32::try_from(length).map_err(|_| fault("larger than 4 GiB", "split it into smaller buffers"))?;
    exactly(&mut BufReader::new(file), length, guard, uri)
}

/// `uri` with its escapes (`%20`) resolved.
fn decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::new();
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        let mut digit = || (rest.next()? as char).to_digit(16);
        bytes.push(if byte == b'%' { (16 * digit()? + digit()?) as u8 } else { byte });
    }
    String::from_utf8(bytes).ok()
}
