//! What the sources are held to: the order of modules, no circles among files, those of tests included, `unsafe` in a
//! few files, small files and folders, one defining file for each section of the paper, and few dependencies.

mod dependencies;
mod imports;
mod items;
mod licences;
mod module_tree;
mod readers;
mod sources;
mod synthetic;
mod unsafe_code;

use module_tree::ModuleTree;
use sources::Sources;
use std::path::Path;

/// The order of the modules: each imports only from those before it. Tests may import from anywhere.
const ORDER: &[&str] = &[
    "random",
    "memory",
    "geometry",
    "scene",
    "bvh",
    "simd",
    "parallel",
    "builders::prims",
    "builders::api",
    "builders::binary",
    "builders::wide",
    "builders::lbvh",
    "builders::clusters",
    "builders::split",
    "builders::phr",
    "builders::hunt",
    "builders::optimise",
    "builders::registry",
    "builders::steps",
    "embree",
    "peers",
    "trace",
    "query",
    "bench",
    "report",
    "experiments",
    "cli",
];

/// The files that may have `unsafe` code.
const UNSAFE_FILES: &[&str] = &[
    // Functions compiled for an instruction set run behind tokens.
    "simd/mod.rs",
    "simd/vector.rs",
    "trace/kernel/avx2/boxes.rs",
    "trace/kernel/avx2/crossing.rs",
    "trace/kernel/avx2/fast.rs",
    "trace/kernel/avx2/mod.rs",
    "trace/kernel/avx2/packet/few.rs",
    "trace/kernel/avx2/watertight.rs",
    // Memory from the system, prefetches, and stores past the caches.
    "memory/huge_pages.rs",
    "memory/prefetch.rs",
    "memory/resident.rs",
    "memory/runs.rs",
    "memory/stream.rs",
    // Threads that write to places of their own of one array.
    "parallel/disjoint.rs",
    "parallel/ordered_append.rs",
    "parallel/radix_sort.rs",
    // Four floats loaded at once.
    "geometry/mesh.rs",
    // Floats within bounds to integers; an array written before it is read; nodes and blocks as plain vectors.
    "builders/lbvh/morton.rs",
    "builders/lbvh/sort.rs",
    "bvh/vectors.rs",
    // Links and a stack without bounds checks.
    "trace/kernel/batch/interleave.rs",
    "trace/kernel/batch/stream.rs",
    "trace/kernel/children.rs",
    "trace/kernel/sound_tree.rs",
    "trace/kernel/stack.rs",
    "trace/kernel/traverse.rs",
    // Embree's C interface.
    "embree/arguments.rs",
    "embree/build_bvh/callbacks.rs",
    "embree/build_bvh/mod.rs",
    "embree/capture.rs",
    "embree/device.rs",
    "embree/instances.rs",
    "embree/moving.rs",
    "embree/packets.rs",
    "embree/query.rs",
    "embree/scene.rs",
    "embree/streams.rs",
    // Embree's tree in memory.
    "embree/tree/graft.rs",
    "embree/tree/layout.rs",
    "embree/tree/native.rs",
    "embree/tree/pages.rs",
];

/// Files that read and that clippy does not look at, and why.
const UNJUDGED: &[(&str, &str)] = &[
    ("embree/tree/layout.rs", "it reads the memory of a committed scene, at places that it has found itself"),
    ("report/advice/model/mod.rs", "the model is compiled in"),
    ("report/page/mod.rs", "it looks for names of folders alone"),
];

/// Most lines of a file, tests included, and files that may be longer, with the reason.
const MOST_LINES: usize = 300;
const LONG_FILES: &[(&str, &str)] = &[];

/// Most columns of a line of a comment.
const MOST_COLUMNS: usize = 120;

/// Most files and folders of a folder.
const MOST_ENTRIES: usize = 16;

fn sources() -> Sources {
    Sources::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

#[track_caller]
fn none(violations: &[String]) {
    assert!(violations.is_empty(), "{} violations:\n{}", violations.len(), violations.join("\n"));
}

#[test]
fn modules_import_only_from_those_before_them() {
    none(&ModuleTree::of(&sources()).upward_imports(ORDER));
}

#[test]
fn no_circle_among_files() {
    none(&ModuleTree::with_tests(&sources()).circles());
}

#[test]
fn every_path_is_followed() {
    none(&ModuleTree::of(&sources()).unresolved());
}

#[test]
fn unsafe_code_is_where_the_list_says_and_argued_for() {
    none(&unsafe_code::misplaced(&sources(), UNSAFE_FILES));
}

#[test]
fn instruction_sets_are_detected_in_one_place() {
    none(&unsafe_code::stray_detection(&sources(), "simd/mod.rs"));
}

#[test]
fn what_reads_files_neither_indexes_nor_unwraps() {
    none(&readers::unjudged(&sources(), UNJUDGED));
}

#[test]
fn files_are_short() {
    none(&sources().long_files(MOST_LINES, LONG_FILES));
}

#[test]
fn comments_are_narrow() {
    none(&sources().wide_comments(MOST_COLUMNS));
}

#[test]
fn folders_are_small() {
    none(&sources().odd_folders(MOST_ENTRIES));
}

#[test]
fn each_section_of_the_paper_has_one_defining_file() {
    none(&sources().undefined_sections("builders/"));
}
