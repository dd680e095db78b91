//! The sources of a crate, by path within `src`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Path within `src`, with slashes, and text of each file.
pub struct Sources(pub BTreeMap<String, String>);

impl Sources {
    /// All Rust files below `folder`.
    pub fn read(folder: &Path) -> Self {
        let mut files = BTreeMap::new();
        let mut pending = vec![folder.to_path_buf()];
        while let Some(folder_below) = pending.pop() {
            for entry in std::fs::read_dir(&folder_below).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    pending.push(path);
                } else if path.extension().is_some_and(|extension| extension == "rs") {
                    let name = path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/");
                    files.insert(name, std::fs::read_to_string(&path).unwrap());
                }
            }
        }
        Self(files)
    }

    /// The files given.
    pub fn of(files: &[(&str, &str)]) -> Self {
        Self(files.iter().map(|&(name, text)| (name.to_owned(), text.to_owned())).collect())
    }

    /// Files longer than `most` lines, but for `exceptions`, and exceptions that are not longer.
    pub fn long_files(&self, most: usize, exceptions: &[(&str, &str)]) -> Vec<String> {
        let is_exception = |name: &str| exceptions.iter().any(|&(exception, _)| exception == name);
        let long = self.0.iter().filter(|(name, text)| (text.lines().count() > most) != is_exception(name));
        long.map(|(name, text)| match is_exception(name) {
            true => format!("{name}: {} lines need no exception; take it off the list", text.lines().count()),
            false => format!("{name}: {} lines are more than {most}; split it", text.lines().count()),
        })
        .collect()
    }

    /// Lines of comments wider than `most` columns; code is the formatter's.
    pub fn wide_comments(&self, most: usize) -> Vec<String> {
        let mut wide = Vec::new();
        for (name, text) in &self.0 {
            for (index, line) in text.lines().enumerate() {
                let width = line.chars().count();
                if line.trim_start().starts_with("//") && width > most {
                    wide.push(format!("{name}:{}: {width} columns are more than {most}; wrap it", index + 1));
                }
            }
        }
        wide
    }

    /// Folders of fewer than two or more than `most` files and folders. The root holds what the order of the
    /// modules lists, however many.
    pub fn odd_folders(&self, most: usize) -> Vec<String> {
        let mut folders: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for name in self.0.keys() {
            let mut rest = name.as_str();
            while let Some((folder, entry)) = rest.rsplit_once('/') {
                folders.entry(folder).or_default().insert(entry);
                rest = folder;
            }
        }
        let odd = folders.iter().filter(|(_, entries)| !(2..=most).contains(&entries.len()));
        odd.map(|(folder, entries)| format!("{folder}: {} entries; 2 to {most} may be", entries.len()))
            .collect()
    }

    /// Sections 4.1 to 4.7 that not exactly one file below `folder` defines, `naive` ones apart. A file that
    /// defines a section says so on a line of its own at its head: `//! Paper 4.3: refinement.`
    pub fn undefined_sections(&self, folder: &str) -> Vec<String> {
        let defines = |text: &str, marker: &str| {
            text.lines().take_while(|line| line.starts_with("//!")).any(|line| line.starts_with(marker))
        };
        let mut found = Vec::new();
        for section in 1..=7 {
            let marker = format!("//! Paper 4.{section}:");
            let files: Vec<&String> = self
                .0
                .iter()
                .filter(|(name, text)| {
                    name.starts_with(folder) && !name.contains("/naive/") && defines(text, &marker)
                })
                .map(|(name, _)| name)
                .collect();
            if files.len() != 1 {
                found.push(format!("`{marker}` heads {} files, not one: {files:?}", files.len()));
            }
        }
        found
    }
}
