//! Build-from-hierarchy with cuts of constant length (Hunt, Mark, Fussell 2007, adapted to BVHs as in paper 5): PHR's
//! recursion, refined by opening the largest nodes until the cut is long enough, without spatial splits.

mod constant_length;
pub(crate) mod pipeline;
