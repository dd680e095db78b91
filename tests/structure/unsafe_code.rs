//! Where `unsafe` is, and whether it is argued for.

use crate::sources::Sources;
use proc_macro2::{TokenStream, TokenTree};

/// Files with `unsafe` that are not among `allowed`, those among them without it, and what has no argument.
/// The compiler denies `unsafe_code` but where a file allows it, so the files that do must be the same.
pub fn misplaced(sources: &Sources, allowed: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for (file, text) in &sources.0 {
        let tokens: TokenStream = text.parse().unwrap_or_else(|error| panic!("{file}: {error}"));
        let mut uses = Uses::default();
        uses.scan(tokens);
        let is_allowed = allowed.contains(&file.as_str());
        if let Some(line) = uses.lines.iter().chain(&uses.allowed).min().filter(|_| !is_allowed) {
            found.push(format!("{file}:{line}: unsafe code outside of the list of files that may have it"));
        }
        if is_allowed && uses.lines.is_empty() {
            found.push(format!("{file}: no unsafe code; take it off the list"));
        }
        if is_allowed && !text.lines().any(|line| line == "#![allow(unsafe_code)]") {
            found.push(format!("{file}: `#![allow(unsafe_code)]` is missing at its head"));
        }
        let lines: Vec<&str> = text.lines().collect();
        let unargued = uses.to_argue.iter().filter(|&&line| !is_argued(&lines[..line]));
        found.extend(unargued.map(|line| format!("{file}:{line}: no SAFETY comment above")));
    }
    let missing = allowed.iter().filter(|&&file| !sources.0.contains_key(file));
    found.extend(missing.map(|file| format!("{file}: no such file; take it off the list")));
    found
}

/// Files other than `home` that ask the processor what it can do.
pub fn stray_detection(sources: &Sources, home: &str) -> Vec<String> {
    let detects = |text: &str| text.contains("is_x86_feature_detected") || text.contains("__cpuid");
    let stray = sources.0.iter().filter(|(file, text)| *file != home && detects(text));
    stray
        .map(|(file, _)| format!("{file}: instruction sets are detected in {home} alone; take a token"))
        .collect()
}

/// Lines with `unsafe`, counted from 1.
#[derive(Default)]
struct Uses {
    lines: Vec<usize>,
    /// Blocks and implementations.
    to_argue: Vec<usize>,
    /// Names of the lint, which an attribute allows.
    allowed: Vec<usize>,
}

impl Uses {
    fn scan(&mut self, tokens: TokenStream) {
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match token {
                TokenTree::Ident(ident) if ident == "unsafe" => {
                    let line = ident.span().start().line;
                    self.lines.push(line);
                    match tokens.peek() {
                        Some(TokenTree::Group(_)) => self.to_argue.push(line),
                        Some(TokenTree::Ident(next)) if next == "impl" => self.to_argue.push(line),
                        _ => {}
                    }
                }
                TokenTree::Ident(ident) if ident == "unsafe_code" => {
                    self.allowed.push(ident.span().start().line);
                }
                TokenTree::Group(group) => self.scan(group.stream()),
                _ => {}
            }
        }
    }
}

/// Whether a SAFETY comment stands above the statement that the last of `lines` is part of.
fn is_argued(lines: &[&str]) -> bool {
    let is_comment = |line: &str| line.starts_with("//");
    for (distance, line) in lines.iter().rev().map(|line| line.trim()).enumerate() {
        if line.contains("SAFETY:") {
            return true;
        }
        let ends_another = line.is_empty() || line.ends_with([';', '{', '}']);
        if distance > 0 && !is_comment(line) && ends_another {
            return false;
        }
    }
    false
}
