//! Memory: huge pages, streaming stores, prefetches, a pool of buffers kept from build to build, and what is resident.

pub(crate) mod huge_pages;
pub(crate) mod pool;
pub(crate) mod prefetch;
#[cfg(feature = "harness")]
pub(crate) mod resident;
pub(crate) mod stream;
