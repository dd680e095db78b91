//! The checker itself, on small sources with one fault each.

use crate::module_tree::ModuleTree;
use crate::sources::Sources;
use crate::unsafe_code::{misplaced, stray_detection};

const ORDER: &[&str] = &["low", "high::first", "high::second"];

/// Sources of the modules `low` and `high`, the latter of two, with further files or other texts for these.
fn sources(changes: &[(&str, &str)]) -> Sources {
    let mut files = vec![
        ("lib.rs", "pub mod low; pub mod high;"),
        ("low/mod.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
        ("low/a.rs", "pub struct A;"),
        ("low/b.rs", "use super::A; pub struct B(A);"),
        ("high/mod.rs", "mod first; mod second; pub use first::First;"),
        ("high/first.rs", "use crate::low::{A, B}; pub struct First { a: A, b: B }"),
        ("high/second.rs", "use super::First; pub fn second(first: First) -> First { first }"),
    ];
    for &(name, text) in changes {
        files.retain(|file| file.0 != name);
        files.push((name, text));
    }
    Sources::of(&files)
}

fn tree(changes: &[(&str, &str)]) -> ModuleTree {
    ModuleTree::of(&sources(changes))
}

#[track_caller]
fn upward(file: &str, text: &str, expected: &str) {
    let found = tree(&[(file, text)]).upward_imports(ORDER);
    assert!(found.len() == 1 && found[0].contains(expected), "{expected}: {found:?}");
}

#[track_caller]
fn circle(changes: &[(&str, &str)], expected: &[&str]) {
    let found = ModuleTree::with_tests(&sources(changes)).circles();
    assert!(
        found.len() == 1 && expected.iter().all(|part| found[0].contains(part)),
        "{expected:?}: {found:?}"
    );
}

#[test]
fn sound_sources_pass() {
    let sound = tree(&[]);
    assert_eq!(sound.upward_imports(ORDER), [""; 0]);
    assert_eq!(sound.circles(), [""; 0]);
    assert_eq!(sound.unresolved(), [""; 0]);
}

#[test]
fn imports_upward_are_found() {
    upward(
        "low/a.rs",
        "pub struct A;\nuse crate::high::First;",
        "low/a.rs:2 `crate::high::First` uses high::first",
    );
    upward("low/a.rs", "pub struct A(super::super::high::First);", "`super::super::high::First`");
    upward("high/first.rs", "pub struct First; use super::second::second;", "uses high::second");
    upward(
        "low/mod.rs",
        "mod a; mod b; pub use a::A; pub use b::B; pub use crate::high::First;",
        "low/mod.rs:1",
    );
    upward("low/a.rs", "pub struct A; fn f() { use crate::high; }", "");
}

#[test]
fn inline_paths_upward_are_found() {
    let in_call = "pub struct A;\nfn f() {\n    crate::high::second::second();\n}";
    upward("low/a.rs", in_call, "low/a.rs:3 `crate::high::second::second` uses high::second");
    upward("low/a.rs", "pub struct A { first: Vec<crate::high::First> }", "uses high::first");
    upward("low/a.rs", "pub struct A; impl crate::high::first::T for A {}", "uses high::first");
    upward(
        "low/a.rs",
        "pub struct A; fn f() { assert!(crate::high::second::second()); }",
        "uses high::second",
    );
    let attribute = "pub struct A { #[serde(default = \"crate::high::second::second\")] x: u8 }";
    upward("low/a.rs", attribute, "uses high::second");
    upward("low/a.rs", "pub struct A; mod inner { fn f() { crate::high::First; } }", "uses high::first");
    upward("low/a.rs", "pub struct A; pub fn f() { use crate as c; c::high::First; }", "uses high::first");
}

#[test]
fn names_under_another_name_are_followed() {
    // A glob, and a module imported under another name.
    upward(
        "high/first.rs",
        "pub struct First; use super::*; fn f() { second::second() }",
        "uses high::second",
    );
    upward("high/first.rs", "pub struct First; use super::second as s;", "uses high::second");
}

#[test]
fn modules_outside_of_the_order_are_found() {
    let found = tree(&[("lib.rs", "mod low; mod high; mod new;"), ("new.rs", "")]).upward_imports(ORDER);
    assert_eq!(found, ["new.rs: not in the order of modules"]);
    let outline = "mod first; mod second; pub use first::First; pub struct Own;";
    let found = tree(&[("high/mod.rs", outline)]).upward_imports(ORDER);
    assert_eq!(found, ["high/mod.rs: `Own` belongs into a module of the order"]);
}

#[test]
fn tests_and_documentation_may_name_anything() {
    let text = "//! See [`crate::high::First`].
        #[doc = \"[`crate::high::First`]\"] pub struct A;
        #[cfg(test)] use crate::high::First;
        #[cfg(all(test, feature = \"x\"))] mod tests { use crate::high::First; }
        #[cfg(test)] mod missing;
        #[test] fn f() { crate::high::second::second(); }";
    assert_eq!(tree(&[("low/a.rs", text)]).upward_imports(ORDER), [""; 0]);
    upward("low/a.rs", "pub struct A; #[cfg(not(test))] use crate::high::First;", "uses high::first");
    upward("low/a.rs", "pub struct A; #[cfg(any(test, unix))] use crate::high::First;", "uses high::first");
}

#[test]
fn circles_are_found() {
    let direct = ("low/a.rs", "use super::b::B;\npub struct A(Box<B>);");
    circle(&[direct], &["low/a.rs:1 `super::b::B` -> low/b.rs", "low/b.rs:1 `super::A` -> low/a.rs"]);
    // Through the re-export of the outline.
    circle(&[("low/a.rs", "use crate::low::B;\npub struct A(Box<B>);")], &["`crate::low::B` -> low/b.rs"]);
    // By a path in code, in a macro, or to the outline's own items.
    circle(&[("low/a.rs", "pub struct A; fn f() { super::B; }")], &["`super::B` -> low/b.rs"]);
    circle(&[("low/a.rs", "pub struct A; fn f() { vec![super::B]; }")], &["`super::B` -> low/b.rs"]);
    let own = "mod a; mod b; pub use a::A; pub use b::B; pub const N: usize = 1; fn f() { a::A; }";
    circle(
        &[("low/mod.rs", own), ("low/a.rs", "pub struct A([u8; super::N]);")],
        &["`super::N` -> low/mod.rs"],
    );
}

#[test]
fn circles_among_files_of_tests_are_found() {
    let outline = "mod a; mod b; pub use a::A; pub use b::B; #[cfg(test)] mod c; #[cfg(test)] mod d;";
    let c = ("low/c.rs", "pub struct C; #[test] fn f() { super::d::D; }");
    circle(
        &[("low/mod.rs", outline), c, ("low/d.rs", "pub struct D(super::c::C);")],
        &["low/c.rs:1 `super::d::D` -> low/d.rs", "`super::c::C` -> low/c.rs"],
    );
    // The tests of a file may use what uses the file.
    let tests = ("low/a.rs", "pub struct A; #[cfg(test)] mod tests { use super::super::B; }");
    let sound = sources(&[("low/mod.rs", outline), tests, c, ("low/d.rs", "pub struct D(super::B);")]);
    assert_eq!(ModuleTree::with_tests(&sound).circles(), [""; 0]);
}

#[test]
fn the_shortest_circle_is_told() {
    let changes = [
        ("low/mod.rs", "mod a; mod b; mod c; pub use a::A; pub use b::B;"),
        ("low/a.rs", "pub struct A; fn f() { super::c::C; super::B; }"),
        ("low/c.rs", "pub struct C; fn f() { super::B; }"),
    ];
    circle(&changes, &["-> low/b.rs, low/b.rs:1 `super::A` -> low/a.rs"]);
}

#[test]
fn paths_that_lead_nowhere_are_found() {
    let found = tree(&[("low/a.rs", "pub struct A; fn f() { crate::low::gone(); }")]).unresolved();
    assert_eq!(found, ["low/a.rs:1 `crate::low::gone` leads nowhere"]);
}

#[test]
fn unsafe_code_outside_of_the_list_is_found() {
    let argued =
        "#![allow(unsafe_code)]\nfn f() {\n    // SAFETY: none.\n    let x =\n        unsafe { g() };\n}";
    let faults = |text: &str, allowed: &[&str]| misplaced(&Sources::of(&[("a.rs", text)]), allowed);
    assert_eq!(faults(argued, &["a.rs"]), [""; 0]);
    assert_eq!(faults(argued, &[]).len(), 1);
    assert_eq!(faults("#![allow(unsafe_code)]", &[]).len(), 1);
    assert_eq!(faults("fn f() {}", &[]), [""; 0]);
    assert!(faults("#![allow(unsafe_code)]\nfn f() {}", &["a.rs"])[0].contains("take it off the list"));
    assert!(faults("unsafe fn f() {}", &["a.rs"])[0].contains("is missing at its head"));
    assert!(faults("fn f() {}", &["a.rs", "b.rs"])[2].contains("b.rs: no such file"));
    for unargued in [
        "#![allow(unsafe_code)]\n\nunsafe impl Send for A {}",
        "#![allow(unsafe_code)]\n// SAFETY: of another.\nfn g() {}\nfn f() { unsafe { g() } }",
        "#![allow(unsafe_code)]\nmacro_rules! m { () => { unsafe { g() } } }",
    ] {
        let found = faults(unargued, &["a.rs"]);
        assert!(found.len() == 1 && found[0].contains("no SAFETY comment"), "{unargued}: {found:?}");
    }
    let detects =
        Sources::of(&[("simd.rs", "has!(is_x86_feature_detected)"), ("a.rs", "is_x86_feature_detected!()")]);
    assert!(stray_detection(&detects, "simd.rs")[0].starts_with("a.rs: "));
}

#[test]
fn long_files_wide_comments_and_odd_folders_are_found() {
    let sources =
        Sources::of(&[("a.rs", "1\n2\n3"), ("b/c.rs", "1"), ("b/d/e.rs", "1"), ("b/d/f.rs", "1\n2\n3\n4")]);
    let reason = |file| (file, "a reason");
    assert_eq!(sources.long_files(3, &[]), ["b/d/f.rs: 4 lines are more than 3; split it"]);
    assert_eq!(sources.long_files(3, &[reason("b/d/f.rs")]), [""; 0]);
    assert_eq!(sources.long_files(3, &[reason("b/d/f.rs"), reason("a.rs")]).len(), 1);
    assert_eq!(sources.wide_comments(3), [""; 0]);
    let wide = Sources::of(&[("a.rs", "let long_code = 1;\n    // abc\n")]);
    assert_eq!(wide.wide_comments(9), ["a.rs:2: 10 columns are more than 9; wrap it"]);
    assert_eq!(sources.odd_folders(2), [""; 0]);
    assert_eq!(sources.odd_folders(1).len(), 2);
    assert_eq!(Sources::of(&[("a/b.rs", "")]).odd_folders(9).len(), 1);
}

#[test]
fn sections_without_exactly_one_file_are_found() {
    let heads: Vec<String> = (1..=7).map(|n| format!("//! Paper 4.{n}: a section.\n\nfn f() {{}}")).collect();
    let names: Vec<String> = (1..=7).map(|n| format!("builders/{n}.rs")).collect();
    let mut files: Vec<(&str, &str)> =
        names.iter().map(String::as_str).zip(heads.iter().map(String::as_str)).collect();
    let missing = |files: &[(&str, &str)]| Sources::of(files).undefined_sections("builders/");
    files.push(("builders/naive/3.rs", "//! Paper 4.3: the oracle's."));
    files.push(("builders/x.rs", "//! A variant of\n\n//! Paper 4.3: not at the head."));
    assert_eq!(missing(&files), [""; 0]);
    files.push(("builders/y.rs", "//! Another.\n//! Paper 4.3: again."));
    assert_eq!(missing(&files).len(), 1);
    assert_eq!(missing(&files[1..]).len(), 2);
}
