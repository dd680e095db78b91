//! Memory: huge pages, streaming stores, prefetches, and a pool of buffers kept from build to build.

pub(crate) mod huge_pages;
pub(crate) mod pool;
pub(crate) mod prefetch;
pub(crate) mod stream;
