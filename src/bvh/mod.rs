//! The wide tree every builder emits, what it costs, and the proof that it is whole.

mod wide;

pub use wide::{Bvh4, Bvh8, Child, Link, MAX_DEPTH, MAX_LEAF_BLOCKS, TriangleBlock, WideBvh, WideNode};
