//! Finds Embree 3 or 4, checks its version, generates the bindings and compiles the shim.
//!
//! Looks in `EMBREE_DIR`, or else in `EMBREE3_DIR` (a prefix with `include/embree4` or `include/embree3`, and
//! `lib`), if one is set, and nowhere else; otherwise in the places where distributions install it. Where both
//! versions are, Embree 3 is taken, with which the published figures were measured. An error names everything
//! missing in one paragraph.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{env, fs, panic};

/// Names the packages; ends every complaint about something missing.
const PACKAGES: &str = "Debian/Ubuntu: apt install libembree-dev libclang-dev; Arch: pacman -S embree clang; \
    Homebrew: brew install embree llvm; elsewhere set EMBREE_DIR to Embree's prefix (with include/embree3 or \
    include/embree4, and lib) and LIBCLANG_PATH to libclang's folder. The phr library also builds without Embree: \
    --no-default-features";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=c");
    println!("cargo::rustc-check-cfg=cfg(embree4)");
    for variable in [
        "DOCS_RS",
        "EMBREE_DIR",
        "EMBREE3_DIR",
        "LIBCLANG_PATH",
        "LLVM_CONFIG_PATH",
        "BINDGEN_EXTRA_CLANG_ARGS",
    ] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    if let Err(complaint) = run() {
        println!("cargo::error={}", complaint.replace('\n', " "));
    }
}

fn run() -> Result<(), String> {
    if env::var_os("DOCS_RS").is_some() {
        return without_embree();
    }
    let embree = Embree::find()?;
    let version = embree.version()?;
    generate_bindings(&embree)?;
    cc::Build::new()
        .include(&embree.include)
        .define("EMBREE_MAJOR", embree.major.to_string().as_str())
        .file("c/shim.c")
        .std("c99")
        .warnings(true)
        .try_compile("embree_sys_shim")
        .map_err(|why| format!("the C compiler could not compile Embree's inline functions: {why}"))?;
    if embree.major == 4 {
        println!("cargo::rustc-cfg=embree4");
    }
    println!("cargo::rustc-link-search=native={}", embree.lib.display());
    println!("cargo::rustc-link-lib=dylib=embree{}", embree.major);
    // The loader looks among the system's libraries, and would find the distribution's Embree there. `phr` does the same.
    if ["EMBREE_DIR", "EMBREE3_DIR"].into_iter().any(|name| prefix(name).is_some()) {
        println!("cargo::rustc-link-arg-tests=-Wl,-rpath,{}", embree.lib.display());
    }
    println!("cargo::metadata=include={}", embree.include.display());
    println!("cargo::metadata=lib={}", embree.lib.display());
    println!("cargo::metadata=major={}", embree.major);
    println!("cargo::metadata=version={version}");
    Ok(())
}

/// The registry's documentation is made where there is no Embree: without bindings.
fn without_embree() -> Result<(), String> {
    let bindings = bindings_path()?;
    fs::write(&bindings, "").map_err(|why| format!("{}: {why}", bindings.display()))
}

/// Where the generated bindings go.
fn bindings_path() -> Result<PathBuf, String> {
    let out = env::var_os("OUT_DIR").ok_or("OUT_DIR is not set; build with cargo")?;
    Ok(Path::new(&out).join("embree.rs"))
}

/// An installation.
struct Embree {
    /// 3 or 4.
    major: u32,
    /// The folder that holds `embree3/rtcore.h` or `embree4/rtcore.h`.
    include: PathBuf,
    /// The folder that holds the library.
    lib: PathBuf,
}

impl Embree {
    fn find() -> Result<Self, String> {
        let os = env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
        let arch = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
        let libs = [format!("lib/{arch}-linux-gnu"), "lib64".into(), "lib".into()];
        let suffix = if os == "macos" { "dylib" } else { "so" };
        let (prefixes, place) = places(os == "macos");
        let majors = majors()?;
        let mut found_header = None;
        for &major in &majors {
            let library = format!("libembree{major}.{suffix}");
            for prefix in &prefixes {
                let include = prefix.join("include");
                if !include.join(format!("embree{major}/rtcore.h")).is_file() {
                    continue;
                }
                let lib = libs.iter().map(|lib| prefix.join(lib)).find(|lib| lib.join(&library).exists());
                match lib {
                    Some(lib) => return Ok(Self { major, include, lib }),
                    None => found_header = Some((include, library.clone())),
                }
            }
        }
        let names = majors.iter().map(u32::to_string).collect::<Vec<_>>().join(" or ");
        Err(match found_header {
            Some((include, library)) => format!(
                "Embree's headers are in {} but {library} was not found beside them. {PACKAGES}",
                include.display()
            ),
            None => format!("Embree {names} (rtcore.h) was not found {place}. {PACKAGES}"),
        })
    }

    /// The version in the header, e.g. "3.13.5".
    fn version(&self) -> Result<String, String> {
        let major = self.major;
        let path = self.include.join(format!("embree{major}/rtcore_config.h"));
        let text =
            fs::read_to_string(&path).map_err(|why| format!("{}: {why}. {PACKAGES}", path.display()))?;
        let part = |name: &str| -> Option<u32> {
            let line =
                text.lines().find(|line| line.trim_start().starts_with(&format!("#define {name} ")))?;
            line.split_whitespace().nth(2)?.parse().ok()
        };
        match (part("RTC_VERSION_MAJOR"), part("RTC_VERSION_MINOR"), part("RTC_VERSION_PATCH")) {
            (Some(found), Some(minor), Some(patch)) if found == major => {
                Ok(format!("{major}.{minor}.{patch}"))
            }
            (Some(found), ..) => {
                Err(format!("{} belongs to Embree {found}, not {major}. {PACKAGES}", path.display()))
            }
            _ => Err(format!("{} names no RTC_VERSION_MAJOR. {PACKAGES}", path.display())),
        }
    }
}

/// Versions that will do, the preferred one first.
fn majors() -> Result<Vec<u32>, String> {
    let is_wanted = |major: u32| env::var_os(format!("CARGO_FEATURE_EMBREE{major}")).is_some();
    let is_for_3 = prefix("EMBREE_DIR").is_none() && prefix("EMBREE3_DIR").is_some();
    match (is_wanted(3), is_wanted(4)) {
        (false, true) if is_for_3 => {
            Err("the feature embree4 asks for Embree 4, and EMBREE3_DIR names an Embree 3; set EMBREE_DIR instead"
                .into())
        }
        (false, true) => Ok(vec![4]),
        (true, false) => Ok(vec![3]),
        _ if is_for_3 => Ok(vec![3]),
        _ => Ok(vec![3, 4]),
    }
}

/// The variable's value, unless it is empty.
fn prefix(variable: &str) -> Option<OsString> {
    env::var_os(variable).filter(|prefix| !prefix.is_empty())
}

/// The prefixes to look in, and how to say so.
fn places(is_macos: bool) -> (Vec<PathBuf>, String) {
    for variable in ["EMBREE_DIR", "EMBREE3_DIR"] {
        if let Some(prefix) = prefix(variable) {
            let place = format!("in {variable}={}", prefix.to_string_lossy());
            return (vec![PathBuf::from(prefix)], place);
        }
    }
    let usual: &[&str] = if is_macos {
        &["/opt/homebrew/opt/embree@3", "/opt/homebrew", "/usr/local/opt/embree@3", "/usr/local"]
    } else {
        &["/usr", "/usr/local", "/home/linuxbrew/.linuxbrew/opt/embree@3", "/home/linuxbrew/.linuxbrew"]
    };
    (usual.iter().map(PathBuf::from).collect(), format!("in {}", usual.join(", ")))
}

fn generate_bindings(embree: &Embree) -> Result<(), String> {
    // bindgen panics where libclang cannot be loaded: say that in our words, without a backtrace.
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let libclang = panic::catch_unwind(bindgen::clang_version);
    panic::set_hook(hook);
    if libclang.is_err() {
        return Err(format!("libclang, which generates the bindings to Embree, was not found. {PACKAGES}"));
    }
    let out = bindings_path()?;
    bindgen::builder()
        .header("c/embree.h")
        .clang_arg(format!("-DEMBREE_MAJOR={}", embree.major))
        .clang_arg(format!("-I{}", embree.include.display()))
        .allowlist_item("(rtc|RTC|embree_sys_).*")
        .prepend_enum_name(false)
        .derive_default(true)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .parse_callbacks(Box::new(bindgen::CargoCallbacks::new()))
        .parse_callbacks(Box::new(ShimNames))
        .generate()
        .map_err(|why| {
            format!("libclang could not read Embree's headers: {}. {PACKAGES}", why.to_string().trim())
        })?
        .write_to_file(&out)
        .map_err(|why| format!("{}: {why}", out.display()))
}

/// Gives the shim's functions the names of the inline functions behind them.
#[derive(Debug)]
struct ShimNames;

impl bindgen::callbacks::ParseCallbacks for ShimNames {
    fn item_name(&self, item: bindgen::callbacks::ItemInfo<'_>) -> Option<String> {
        item.name.strip_prefix("embree_sys_rtc").map(|rest| format!("rtc{rest}"))
    }
}
