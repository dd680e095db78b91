//! Memory: huge pages and streaming stores.

pub(crate) mod huge_pages;
pub(crate) mod stream;
