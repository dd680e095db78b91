//! Figures within Markdown pages: the text between two markers is generated from committed rows, and a check tells
//! whether it still agrees with them. `results/README.md` describes the markers.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod error;
pub mod findings;
mod marker;

pub use error::ReadmeError;

use marker::{KINDS, Marker};
use std::path::Path;

const END: &str = "<!-- end -->";

/// Generates the text between all markers of `text` again. Results are relative to `folder`, the page's own.
///
/// # Errors
/// Markers that cannot be understood, rows that cannot be read, or no marker.
pub fn regenerate(text: &str, folder: &Path) -> Result<String, ReadmeError> {
    let mut out = String::new();
    let (mut is_code, mut blocks) = (false, 0);
    let mut lines = text.lines().enumerate();
    while let Some((index, content)) = lines.next() {
        let line = index + 1;
        is_code ^= content.trim_start().starts_with("```");
        if is_code || !content.contains("<!--") {
            out += &format!("{content}\n");
        } else if let Some(marker) = Marker::of(content.trim(), line)? {
            // A block: all lines up to the end's.
            let until = lines.by_ref().find(|(_, line)| line.trim() == END || Marker::starts(line));
            if until.is_none_or(|(_, line)| line.trim() != END) {
                return Err(marker.wrong(format!("{} without {END} on a line of its own", marker.kind)));
            }
            out += &format!("{content}\n{}\n{END}\n", marker.content(folder)?.trim_end());
            blocks += 1;
        } else {
            let (content, count) = inline(content, line, folder)?;
            out += &format!("{content}\n");
            blocks += count;
        }
    }
    if blocks == 0 { Err(ReadmeError::None) } else { Ok(out) }
}

/// A line with the text between its markers generated again, and their number.
fn inline(mut rest: &str, line: usize, folder: &Path) -> Result<(String, usize), ReadmeError> {
    let (mut out, mut count) = (String::new(), 0);
    while let Some(start) = rest.find("<!--") {
        let Some(length) = rest[start..].find("-->") else { break };
        let after = start + length + "-->".len();
        let comment = &rest[start..after];
        out += &rest[..after];
        rest = &rest[after..];
        let Some(marker) = Marker::of(comment, line)? else {
            if comment == END {
                let kinds = KINDS.map(|kind| kind.0).join(", ");
                let reason = format!("{END} without a beginning; there are {kinds}");
                return Err(ReadmeError::Marker { line, reason });
            }
            continue;
        };
        let end = rest.find(END).ok_or_else(|| marker.wrong(format!("{} without {END}", marker.kind)))?;
        out += &(marker.content(folder)? + END);
        rest = &rest[end + END.len()..];
        count += 1;
    }
    Ok((out + rest, count))
}

/// Lines that differ, as `-` what stands there and `+` what should, at most twenty.
#[allow(clippy::indexing_slicing, reason = "what both begin and end with is no more than either has")]
pub fn differences(old: &str, new: &str) -> String {
    let (old, new): (Vec<&str>, Vec<&str>) = (old.lines().collect(), new.lines().collect());
    let same_tail = |(a, b): &(&&str, &&str)| a == b;
    let head = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let tail = old[head..].iter().rev().zip(new[head..].iter().rev()).take_while(same_tail).count();
    let (old, new) = (&old[head..old.len() - tail], &new[head..new.len() - tail]);
    let mut lines: Vec<String> = Vec::new();
    for index in 0..old.len().max(new.len()) {
        let (a, b) = (old.get(index), new.get(index));
        if a != b {
            lines.extend(a.map(|line| format!("{:>5} -{line}", head + index + 1)));
            lines.extend(b.map(|line| format!("{:>5} +{line}", head + index + 1)));
        }
    }
    if lines.len() > 20 {
        lines.truncate(20);
        lines.push("      ...".into());
    }
    lines.join("\n")
}
