//! The lines of a text file, of which none takes more than a bounded amount of memory.

use super::error::Fault;
use std::io::{BufRead, Read};

/// Bytes kept of a line: a face of a million vertices.
pub(super) const LONGEST: usize = 1 << 24;

/// What some editors put before the first line of UTF-8.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Reads line by line and counts.
pub(super) struct Lines<'a> {
    inner: &'a mut dyn BufRead,
    line: Vec<u8>,
    /// From 1.
    number: usize,
    is_cut: bool,
}

impl<'a> Lines<'a> {
    pub fn new(inner: &'a mut dyn BufRead) -> Self {
        Self { inner, line: Vec::new(), number: 0, is_cut: false }
    }

    /// Reads a line; false at the end of the file. What is beyond [`LONGEST`] is passed over.
    pub fn next(&mut self) -> Result<bool, Fault> {
        self.line.clear();
        self.is_cut = false;
        self.append()
    }

    /// Reads a line with its continuation lines (backslash at the end); one whose first word `is_text` is not continued
    /// beyond the line of that word.
    pub fn next_joined(&mut self, is_text: fn(&[u8]) -> bool) -> Result<bool, Fault> {
        self.line.clear();
        self.is_cut = false;
        // Known from the first word on: to look for it in every line that is appended would take a time that is
        // quadratic in their number.
        let mut known = None;
        loop {
            let before = self.line.len();
            if !self.append()? {
                return Ok(!self.line.is_empty());
            }
            let ends_here = known.unwrap_or_else(|| {
                let (word, is_continued) = first_word(self.line.get(before..).unwrap_or_default());
                known = (!word.is_empty()).then(|| is_text(word));
                // A comment ends with its line, however it ends.
                known == Some(true) && (!is_continued || word.starts_with(b"#"))
            });
            let Some(end) = self.line.trim_ascii_end().strip_suffix(b"\\").map(<[u8]>::len) else {
                return Ok(true);
            };
            if self.is_cut || ends_here {
                return Ok(true);
            }
            self.line.truncate(end);
            self.line.push(b' ');
        }
    }

    /// Appends the next line to what is held; false if there is none.
    fn append(&mut self) -> Result<bool, Fault> {
        let room = (LONGEST + 1 - self.line.len().min(LONGEST)) as u64;
        let read = (&mut *self.inner).take(room).read_until(b'\n', &mut self.line);
        let read = read.map_err(|error| self.fault(&error.to_string()))?;
        if read == 0 {
            return Ok(false);
        }
        self.number += 1;
        if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        if self.line.len() > LONGEST && self.line.last() != Some(&b'\n') {
            self.is_cut = true;
            self.inner.skip_until(b'\n').map_err(|error| self.fault(&error.to_string()))?;
        }
        Ok(true)
    }

    /// The words of the line.
    pub fn words(&self) -> impl Iterator<Item = &[u8]> {
        self.line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
    }

    /// Refuses a line of which the end was passed over.
    pub fn check_whole(&self) -> Result<(), Fault> {
        if !self.is_cut {
            return Ok(());
        }
        Err(Fault::new(
            self.place(),
            "longer than 16 MiB",
            "split its polygon, or fetch the file again if it is damaged",
        ))
    }

    /// This line, in words.
    pub fn place(&self) -> String {
        format!("line {}", self.number)
    }

    /// A fault at this line.
    pub fn fault(&self, problem: &str) -> Fault {
        Fault::new(self.place(), problem, Fault::DAMAGED)
    }
}

/// The first word of a line, without a backslash at its end, and whether it has one.
fn first_word(line: &[u8]) -> (&[u8], bool) {
    let word = line.trim_ascii_start().split(u8::is_ascii_whitespace).next().unwrap_or_default();
    word.strip_suffix(b"\\").map_or((word, false), |word| (word, true))
}

/// A number of a text file.
pub(super) fn number(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_name(word: &[u8]) -> bool {
        word.starts_with(b"#") || word == b"g"
    }

    #[test]
    fn a_byte_order_mark_is_no_word() {
        let mut reader = std::io::BufReader::with_capacity(2, &b"\xEF\xBB\xBFv 1\n\xEF\xBB\xBFv"[..]);
        let mut lines = Lines::new(&mut reader);
        assert!(lines.next_joined(is_name).unwrap());
        assert_eq!(lines.words().collect::<Vec<_>>(), [&b"v"[..], b"1"]);
        assert!(lines.next_joined(is_name).unwrap());
        assert_eq!(lines.words().collect::<Vec<_>>(), [b"\xEF\xBB\xBFv"], "within a file it is data");
    }

    #[test]
    fn backslashes_continue_lines_but_not_comments_and_names() {
        let text = &b"\\\n\\\nf 1 \\\n2\\\n\n# a\\\n g b\\\ng\\\nc\\\nv\\\n3\n#a\\\nv 1\n"[..];
        let mut reader = std::io::BufReader::new(text);
        let mut lines = Lines::new(&mut reader);
        let mut all = Vec::new();
        while lines.next_joined(is_name).unwrap() {
            let words: Vec<String> = lines.words().map(|word| String::from_utf8_lossy(word).into()).collect();
            all.push(words.join(" "));
        }
        assert_eq!(all, ["f 1 2", "# a\\", "g b\\", "g c\\", "v 3", "#a\\", "v 1"]);
    }

    /// Quadratic in the number of lines, this would take hours.
    #[test]
    fn millions_of_continued_lines_are_one() {
        let text = "\\\n".repeat(1 << 21) + "v 1\n";
        let mut reader = std::io::BufReader::new(text.as_bytes());
        let mut lines = Lines::new(&mut reader);
        assert!(lines.next_joined(is_name).unwrap());
        assert_eq!(lines.words().collect::<Vec<_>>(), [&b"v"[..], b"1"]);
        assert!(!lines.next_joined(is_name).unwrap());
    }

    #[test]
    fn long_lines_are_passed_over_in_little_memory() {
        let long = std::io::repeat(b'x').take(3 * LONGEST as u64);
        let mut reader = std::io::BufReader::new((&b"one \\\ntwo\n# "[..]).chain(long).chain(&b"\nlast"[..]));
        let mut lines = Lines::new(&mut reader);
        let words = |lines: &Lines<'_>| lines.words().map(<[u8]>::len).collect::<Vec<_>>();
        assert!(lines.next_joined(is_name).unwrap());
        assert_eq!(words(&lines), [3, 3]);
        assert!(lines.next_joined(is_name).unwrap());
        assert!(lines.check_whole().unwrap_err().place == "line 3" && lines.line.capacity() < 3 * LONGEST);
        assert!(lines.next_joined(is_name).unwrap());
        lines.check_whole().unwrap();
        assert_eq!((words(&lines), lines.number), (vec![4], 4));
        assert!(!lines.next_joined(is_name).unwrap());
    }
}
