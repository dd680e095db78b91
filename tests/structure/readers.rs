//! Files that read what comes from outside, where a mistake of others must be an error: there nothing is indexed or
//! unwrapped unless a comment says why it may be.

use crate::sources::Sources;

/// Calls that read files.
const READS: [&str; 6] =
    ["fs::read(", "read_to_string(", "File::open(", "read_dir(", "serde_json::from_", "read_csv"];

/// The attribute that has clippy look, at the head of a file or of a folder's `mod.rs`.
const LOOKS: &str =
    "#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]";

/// Files that read and that clippy does not look at, but for `exceptions`, and exceptions that need none.
pub fn unjudged(sources: &Sources, exceptions: &[(&str, &str)]) -> Vec<String> {
    let mut found = Vec::new();
    for (file, text) in &sources.0 {
        // Tests may unwrap.
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        let reads = code.into_iter().any(|line| READS.iter().any(|call| line.contains(call)));
        let is_exception = exceptions.iter().any(|(exception, _)| exception == file);
        match reads && !file.ends_with("tests.rs") && !is_looked_at(sources, file) {
            true if !is_exception => found.push(format!("{file}: reads files; put {LOOKS} at its head")),
            false if is_exception => found.push(format!("{file}: needs no exception; take it off the list")),
            _ => {}
        }
    }
    let missing = exceptions.iter().filter(|(file, _)| !sources.0.contains_key(*file));
    found.extend(missing.map(|(file, _)| format!("{file}: no such file; take it off the list")));
    found
}

/// Whether the file or a folder that it is in has the attribute.
fn is_looked_at(sources: &Sources, file: &str) -> bool {
    let has = |name: &str| sources.0.get(name).is_some_and(|text| text.lines().any(|line| line == LOOKS));
    let folders = file.match_indices('/').map(|(end, _)| format!("{}/mod.rs", &file[..end]));
    has(file) || folders.into_iter().any(|folder| has(&folder))
}

#[test]
fn readers_are_found() {
    let read = "fn f() { std::fs::read(\"x\").unwrap(); }";
    let judged = format!("//! Words.\n\n{LOOKS}\n\n{read}");
    let tested = format!("#[cfg(test)]\nmod tests {{ {read} }}");
    let files =
        [("a.rs", read), ("b/mod.rs", &judged), ("b/c.rs", read), ("d.rs", &judged), ("e.rs", &tested)];
    let sources = Sources::of(&files);
    let found = unjudged(&sources, &[]);
    assert!(found.len() == 1 && found[0].starts_with("a.rs: reads files"), "{found:?}");
    assert_eq!(unjudged(&sources, &[("a.rs", "why")]), [""; 0]);
    let found = unjudged(&sources, &[("a.rs", "why"), ("d.rs", "why"), ("f.rs", "why")]);
    assert!(
        found.len() == 2 && found[0].starts_with("d.rs: needs no") && found[1].contains("no such"),
        "{found:?}"
    );
}
