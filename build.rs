//! Which Embree was found, and where the loader finds one of the user's own choice; provenance for the records of the
//! harness: git revision, compiler and target features.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // The loader looks among the system's libraries, and would find the distribution's Embree there.
    let mut is_chosen = false;
    for prefix in ["EMBREE_DIR", "EMBREE3_DIR"] {
        println!("cargo:rerun-if-env-changed={prefix}");
        is_chosen |= std::env::var_os(prefix).is_some_and(|prefix| !prefix.is_empty());
    }
    if let (true, Ok(lib)) = (is_chosen, std::env::var("DEP_EMBREE_LIB")) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{lib}");
    }
    println!("cargo:rustc-check-cfg=cfg(embree4)");
    if std::env::var("DEP_EMBREE_MAJOR").is_ok_and(|major| major == "4") {
        println!("cargo:rustc-cfg=embree4");
    }
    // Only the harness reads it, and a library is not to be compiled again at each commit.
    if std::env::var_os("CARGO_FEATURE_HARNESS").is_some() {
        provenance();
    }
}

fn provenance() {
    println!("cargo:rerun-if-changed=src");
    let is_own = is_own_repository();
    for file in ["HEAD", "logs/HEAD"].iter().filter(|_| is_own) {
        let path = output("git", &["rev-parse", "--git-path", file]);
        if let Some(path) = path.filter(|path| Path::new(path).exists()) {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    set("PHR_GIT_REV", is_own.then(revision).flatten());
    set("PHR_RUSTC", output(&rustc, &["--version"]));
    set("PHR_TARGET", std::env::var("TARGET").ok());
    set("PHR_PROFILE", std::env::var("PROFILE").ok());
    set("PHR_OPT_LEVEL", std::env::var("OPT_LEVEL").ok());
    set("PHR_TARGET_FEATURES", std::env::var("CARGO_CFG_TARGET_FEATURE").ok());
    set(
        "PHR_RUSTFLAGS",
        std::env::var("CARGO_ENCODED_RUSTFLAGS").ok().map(|flags| flags.replace('\x1f', " ")),
    );
}

/// Whether git's top level is the manifest's folder: that of a copy within another repository tells nothing of it.
fn is_own_repository() -> bool {
    let top_level = output("git", &["rev-parse", "--show-toplevel"]).map(std::fs::canonicalize);
    let own = std::env::var_os("CARGO_MANIFEST_DIR").map(std::fs::canonicalize);
    matches!((top_level, own), (Some(Ok(top_level)), Some(Ok(own))) if top_level == own)
}

/// The commit, marked where tracked files differ from it.
fn revision() -> Option<String> {
    let commit = output("git", &["rev-parse", "--short=12", "HEAD"])?;
    let changed =
        output("git", &["--no-optional-locks", "status", "--porcelain", "--untracked-files=no"]).is_some();
    Some(if changed { format!("{commit}-dirty") } else { commit })
}

/// A command's standard output, or `None` where it fails or says nothing.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok().filter(|o| o.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (!text.is_empty()).then_some(text)
}

fn set(name: &str, value: Option<String>) {
    println!("cargo:rustc-env={name}={}", value.as_deref().unwrap_or("unknown"));
}
