//! The auxiliary BVH (paper 4.7).

pub(crate) mod area_scale;
pub(crate) mod auxiliary;
pub(crate) mod cartesian;
pub(crate) mod deltas;
pub(crate) mod direct;
pub(crate) mod direct_treelet;
pub(crate) mod equal_codes;
pub(crate) mod morton;
pub(crate) mod prefetch;
pub(crate) mod sort;
pub(crate) mod top_tree;
pub(crate) mod treelet;
