//! Traversal kernels, the path tracer and its recorded rays.
