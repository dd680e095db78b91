//! The JSON of a file and, of `.glb`, its binary chunk.

use crate::scene::files::error::Fault;
use crate::scene::files::guard::Guard;
use std::io::{BufRead, Read};

/// The two parts of a file.
pub(super) struct Container {
    pub json: Vec<u8>,
    /// The data of the first buffer, where the container has it.
    pub binary: Option<Vec<u8>>,
}

/// What a parsed JSON takes for each of its bytes, roughly.
const PARSED: u64 = 4;

impl Container {
    pub fn of_json(reader: &mut dyn BufRead, guard: &Guard) -> Result<Self, Fault> {
        let mut json = Vec::new();
        loop {
            let bytes = reader.fill_buf().map_err(|error| damaged("JSON", &error.to_string()))?;
            let read = bytes.len();
            if read == 0 {
                return Ok(Self { json, binary: None });
            }
            guard.allow(PARSED * (json.len() + read) as u64)?;
            if json.capacity() < json.len() + read {
                let more = read.max(json.len());
                guard.reserve(&mut json, more)?;
            }
            json.extend_from_slice(bytes);
            reader.consume(read);
        }
    }

    pub fn of_binary(reader: &mut dyn BufRead, guard: &Guard) -> Result<Self, Fault> {
        const REMEDY: &str = "this is no binary glTF 2 file";
        let header = words::<3>(reader, "header")?;
        if header[0] != u32::from_le_bytes(*b"glTF") {
            return Err(Fault::new("header", "does not begin with glTF", REMEDY));
        }
        if header[1] != 2 {
            return Err(Fault::new("header", &format!("container version {}", header[1]), REMEDY));
        }
        guard.allow(u64::from(header[2]))?;
        let [length, kind] = words::<2>(reader, "first chunk")?;
        if kind != u32::from_le_bytes(*b"JSON") {
            return Err(Fault::new("first chunk", "not JSON", REMEDY));
        }
        guard.allow(PARSED * u64::from(length))?;
        let json = exactly(reader, length, guard, "JSON chunk")?;
        // A chunk of another kind is for programs that know it.
        let is_end =
            reader.fill_buf().map_err(|error| damaged("second chunk", &error.to_string()))?.is_empty();
        let binary = match is_end {
            true => None,
            false => {
                let [length, kind] = words::<2>(reader, "second chunk")?;
                guard.allow(json.len() as u64 + u64::from(length))?;
                let is_binary = kind == u32::from_le_bytes(*b"BIN\0");
                is_binary.then(|| exactly(reader, length, guard, "binary chunk")).transpose()?
            }
        };
        Ok(Self { json, binary })
    }
}

fn damaged(place: &str, problem: &str) -> Fault {
    Fault::new(place, problem, Fault::DAMAGED)
}

/// The next little-endian words.
fn words<const N: usize>(reader: &mut dyn BufRead, place: &str) -> Result<[u32; N], Fault> {
    let mut words = [0; N];
    for word in &mut words {
        let mut bytes = [0; 4];
        reader.read_exact(&mut bytes).map_err(|_| damaged(place, "the data ends here"))?;
        *word = u32::from_le_bytes(bytes);
    }
    Ok(words)
}

/// The next `length` bytes, the guard having allowed them.
pub(super) fn exactly(
    reader: &mut dyn BufRead,
    length: u32,
    guard: &Guard,
    place: &str,
) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    guard.reserve(&mut bytes, length as usize)?;
    reader
        .take(u64::from(length))
        .read_to_end(&mut bytes)
        .map_err(|error| damaged(place, &error.to_string()))?;
    if bytes.len() < length as usize {
        return Err(damaged(place, &format!("ends after {} of {length} bytes", bytes.len())));
    }
    Ok(bytes)
}
