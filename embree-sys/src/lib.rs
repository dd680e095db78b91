//! Bindings to Embree 3.
