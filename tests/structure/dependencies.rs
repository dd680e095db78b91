//! What the library depends on without features: few crates, on any platform, and no C.

use std::collections::BTreeSet;
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
