//! What the targets check, apart from where their input comes from: the tests have each check its seeds.

pub mod configuration;
pub mod rays;
#[cfg(feature = "harness")]
pub mod results;
pub mod saved_tree;
pub mod scene_file;
pub mod views;

/// Has the thread that asks do all parallel work: to wake another takes longer than most inputs.
///
/// # Panics
/// If a pool was made before.
pub fn one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first pool of the process");
}
