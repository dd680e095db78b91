//! The header of a PLY file, taken off the stream in bounded memory: comments of any length are passed over.

use super::error::Fault;
use std::io::{BufRead, Read};

/// Bytes that a header may have without its comments.
const LONGEST: usize = 1 << 16;

/// The header without comments, up to and including the line `end_header`; or what there is of it.
pub(super) fn take(reader: &mut dyn BufRead) -> Result<Vec<u8>, Fault> {
    let fault = |problem: &str| Fault::new("header", problem, "this is no PLY file or its header is damaged");
    let mut header = Vec::new();
    loop {
        let begin = header.len();
        let room = (LONGEST - begin) as u64;
        let read = (&mut *reader).take(room).read_until(b'\n', &mut header);
        if read.map_err(|error| fault(&error.to_string()))? == 0 {
            return if room == 0 { Err(fault("longer than 64 KiB")) } else { Ok(header) };
        }
        let line = header.get(begin..).unwrap_or_default();
        let word = line.split(u8::is_ascii_whitespace).find(|word| !word.is_empty()).unwrap_or_default();
        let is_whole = line.ends_with(b"\n");
        if begin == 0 && word != b"ply" {
            return Err(fault("File must start with 'ply'"));
        }
        match word {
            b"end_header" => return Ok(header),
            b"comment" | b"obj_info" => {
                header.truncate(begin);
                if !is_whole {
                    reader.skip_until(b'\n').map_err(|error| fault(&error.to_string()))?;
                }
            }
            _ => {}
        }
    }
}
