//! Memory: huge pages and failed allocations, streaming stores, prefetches, arrays filled by all threads, a pool of
//! buffers kept from build to build, and what is resident.

pub(crate) mod huge_pages;
mod out_of_memory;
pub(crate) mod pool;
pub(crate) mod prefetch;
#[cfg(feature = "harness")]
pub(crate) mod resident;
pub(crate) mod runs;
pub(crate) mod stream;

pub use out_of_memory::OutOfMemory;
pub(crate) use out_of_memory::catch_out_of_memory;
