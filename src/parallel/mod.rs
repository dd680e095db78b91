//! Parallel building blocks: appending in order, sorting.

pub(crate) mod ordered_append;
pub(crate) mod radix_sort;
