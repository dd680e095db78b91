//! Parallel building blocks: a recursion divided into tasks, an append in the order of the tasks, a radix sort.

pub(crate) mod disjoint;
pub(crate) mod ordered_append;
pub(crate) mod radix_sort;
pub(crate) mod task_tree;
