//! The library as its users meet it: scenes, builders, trees, rays. One program, since each takes seconds to link.

mod builders;
mod changed_builders;
mod configurations;
mod costs;
mod embree;
mod hits;
mod instances;
mod moving;
mod platform;
mod primitives;
mod query;
mod scene_files;
mod scene_formats;
mod scene_limits;
mod scene_views;
mod trace_agreement;
mod trace_batches;
mod trace_embree;
mod trace_kernel;
mod trace_path;
mod trace_support;
mod trace_verify;
mod trace_watertight;
mod tree_hashes;
mod trees;
mod upload;

/// Whether there is time for all that can be compared, as in continuous integration.
fn thorough() -> bool {
    std::env::var_os("PHR_THOROUGH").is_some()
}
