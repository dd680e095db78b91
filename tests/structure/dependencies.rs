//! What the library depends on without features: few crates, on any platform, and no C.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The crates that the library names itself; libc on unix.
const CORE: [&str; 5] = ["arrayvec", "glam", "libc", "rayon", "thiserror"];

/// Most crates in all: those above, and what they need in turn.
const MOST: usize = 16;

/// Crates that compile or find C.
const COMPILERS: [&str; 7] = ["autotools", "bindgen", "cc", "cmake", "pkg-config", "system-deps", "vcpkg"];

/// The crates that the library is built from, itself left out, each with its distance from it.
fn crates(arguments: &[&str]) -> Vec<(usize, String)> {
    let output = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()))
        .args([
            "tree",
            "--offline",
            "-p",
            "phr",
            "-e",
            "normal,build",
            "--no-default-features",
            "--no-dedupe",
        ])
        .args(["--prefix", "depth", "--format", " {p}"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let of_line = |line: &str| {
        let mut words = line.split(' ');
        let depth = words.next().and_then(|depth| depth.parse().ok());
        (depth.expect("a depth comes first"), words.next().expect("a name follows").to_owned())
    };
    text.lines().map(of_line).filter(|(depth, _)| *depth > 0).collect()
}

fn names(crates: &[(usize, String)]) -> BTreeSet<&str> {
    crates.iter().map(|(_, name)| name.as_str()).collect()
}

/// Those that have to do with C.
fn of_c<'a>(names: &BTreeSet<&'a str>) -> Vec<&'a str> {
    let is_c = |name: &&str| name.ends_with("-sys") || COMPILERS.contains(name);
    names.iter().copied().filter(is_c).collect()
}

#[test]
fn the_library_alone_needs_few_crates_and_no_c() {
    let crates = crates(&["--target", "all"]);
    let direct: BTreeSet<&str> =
        crates.iter().filter(|(depth, _)| *depth == 1).map(|(_, name)| name.as_str()).collect();
    assert_eq!(direct, BTreeSet::from(CORE));
    let all = names(&crates);
    assert!(all.len() <= MOST, "{} crates, at most {MOST} are wanted: {all:?}", all.len());
    assert_eq!(of_c(&all), [""; 0], "crates that compile or bind C");
    for heavy in ["serde", "serde_json", "regex", "clap"] {
        assert!(!all.contains(heavy), "{heavy} belongs behind a feature");
    }
}

#[test]
fn c_would_be_seen() {
    let crates = crates(&["--features", "files"]);
    assert_eq!(of_c(&names(&crates)), ["cc", "pkg-config", "zstd-sys"]);
}

/// The crates that a manifest names under `section`, as code names them, unless it has them under another name.
fn named<'a>(manifest: &'a str, section: &str) -> Vec<&'a str> {
    let (_, after) = manifest.split_once(&format!("\n[{section}]\n")).unwrap();
    let lines = after.lines().take_while(|line| !line.starts_with('['));
    lines.filter_map(|line| Some(line.split_once(" = ")?.0)).filter(|name| !name.starts_with('#')).collect()
}

/// All code below `folder`.
fn code(folder: &Path, text: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            code(&path, text);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            text.push_str(&std::fs::read_to_string(&path).unwrap());
        }
    }
}

/// `make audit` asks cargo-machete, which not every machine has.
#[test]
fn every_crate_that_is_named_is_used() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = std::fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let all_code = |folders: &[&str]| {
        let mut text = String::new();
        folders.iter().for_each(|folder| code(&root.join(folder), &mut text));
        text
    };
    let of = |section: &str, text: &str| {
        let names = named(&manifest, section);
        assert!(!names.is_empty(), "{section}");
        let is_used = |name: &&str| {
            let name = name.replace('-', "_");
            [format!("{name}::"), format!("use {name}"), format!("derive({name}")]
                .iter()
                .any(|use_| text.contains(use_))
        };
        names.into_iter().filter(|name| !is_used(name)).map(str::to_owned).collect::<Vec<_>>()
    };
    let (library, tests) = (all_code(&["src"]), all_code(&["tests", "benches", "examples"]));
    assert_eq!(of("dependencies", &library), [""; 0], "named in Cargo.toml and not used in src");
    assert_eq!(
        of("target.'cfg(unix)'.dependencies", &library),
        [""; 0],
        "named in Cargo.toml and not used in src"
    );
    assert_eq!(of("dev-dependencies", &tests), [""; 0], "named in Cargo.toml and not used in tests");
    assert_eq!(
        of("dependencies", "use rayon::prelude::*;").len(),
        named(&manifest, "dependencies").len() - 1
    );
}
