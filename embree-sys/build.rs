//! Finds Embree 3, checks its version, generates the bindings and compiles the shim.
//!
//! Looks in `EMBREE3_DIR` (a prefix with `include/embree3` and `lib`) if that is set, and nowhere else;
//! otherwise in the places where distributions install it. An error names everything missing in one paragraph.

use std::path::{Path, PathBuf};
use std::{env, fs, panic};

/// Names the packages; ends every complaint about something missing.
const PACKAGES: &str = "Debian/Ubuntu: apt install libembree-dev libclang-dev; Arch: pacman -S embree3 clang; \
    Homebrew: brew install embree@3 llvm; elsewhere set EMBREE3_DIR to Embree's prefix (with include/embree3 and \
    lib) and LIBCLANG_PATH to libclang's folder. The phr library also builds without Embree: --no-default-features";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=c");
    for variable in ["EMBREE3_DIR", "LIBCLANG_PATH", "LLVM_CONFIG_PATH", "BINDGEN_EXTRA_CLANG_ARGS"] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    if let Err(complaint) = run() {
        println!("cargo::error={}", complaint.replace('\n', " "));
    }
}

fn run() -> Result<(), String> {
    let embree = Embree::find()?;
    let version = embree.version()?;
    generate_bindings(&embree)?;
    cc::Build::new()
        .include(&embree.include)
        .file("c/shim.c")
        .std("c99")
        .warnings(true)
        .try_compile("embree_sys_shim")
        .map_err(|why| format!("the C compiler could not compile Embree's inline functions: {why}"))?;
    println!("cargo::rustc-link-search=native={}", embree.lib.display());
    println!("cargo::rustc-link-lib=dylib=embree3");
    println!("cargo::metadata=include={}", embree.include.display());
    println!("cargo::metadata=lib={}", embree.lib.display());
    println!("cargo::metadata=version={version}");
    Ok(())
}

/// An installation: the folder that holds `embree3/rtcore.h` and the one that holds the library.
struct Embree {
    include: PathBuf,
    lib: PathBuf,
}

impl Embree {
    fn find() -> Result<Self, String> {
        let arch = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
        let os = env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
        let library = if os == "macos" { "libembree3.dylib" } else { "libembree3.so" };
        let (prefixes, place) = match env::var_os("EMBREE3_DIR") {
            Some(prefix) => {
                (vec![PathBuf::from(&prefix)], format!("in EMBREE3_DIR={}", prefix.to_string_lossy()))
            }
            None => {
                let usual: &[&str] = if os == "macos" {
                    &["/opt/homebrew/opt/embree@3", "/opt/homebrew", "/usr/local/opt/embree@3", "/usr/local"]
                } else {
                    &["/usr", "/usr/local", "/home/linuxbrew/.linuxbrew/opt/embree@3"]
                };
                (usual.iter().map(PathBuf::from).collect(), format!("in {}", usual.join(", ")))
            }
        };
        let libs = [format!("lib/{arch}-linux-gnu"), "lib64".into(), "lib".into()];
        let mut found_header = None;
        for prefix in &prefixes {
            let include = prefix.join("include");
            if !include.join("embree3/rtcore.h").is_file() {
                continue;
            }
            let lib = libs.iter().map(|lib| prefix.join(lib)).find(|lib| lib.join(library).exists());
            match lib {
                Some(lib) => return Ok(Self { include, lib }),
                None => found_header = Some(include),
            }
        }
        Err(match found_header {
            Some(include) => format!(
                "Embree 3's headers are in {} but {library} was not found beside them. {PACKAGES}",
                include.display()
            ),
            None => format!("Embree 3 (embree3/rtcore.h) was not found {place}. {PACKAGES}"),
        })
    }

    /// The version in the header, e.g. "3.13.5".
    fn version(&self) -> Result<String, String> {
        let path = self.include.join("embree3/rtcore_config.h");
        let text =
            fs::read_to_string(&path).map_err(|why| format!("{}: {why}. {PACKAGES}", path.display()))?;
        let part = |name: &str| -> Option<u32> {
            let line =
                text.lines().find(|line| line.trim_start().starts_with(&format!("#define {name} ")))?;
            line.split_whitespace().nth(2)?.parse().ok()
        };
        match (part("RTC_VERSION_MAJOR"), part("RTC_VERSION_MINOR"), part("RTC_VERSION_PATCH")) {
            (Some(3), Some(minor), Some(patch)) => Ok(format!("3.{minor}.{patch}")),
            (Some(major), ..) => {
                Err(format!("{} belongs to Embree {major}, but 3 is needed. {PACKAGES}", path.display()))
            }
            _ => Err(format!("{} names no RTC_VERSION_MAJOR. {PACKAGES}", path.display())),
        }
    }
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
    let out =
        Path::new(&env::var_os("OUT_DIR").ok_or("OUT_DIR is not set; build with cargo")?).join("embree3.rs");
    bindgen::builder()
        .header("c/embree3.h")
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
