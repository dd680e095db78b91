//! Bounds on depths and sizes of trees, and why they suffice. The assertions at the end are checked by the compiler.

use crate::geometry::Mesh;

/// Most children of an inner node.
pub(crate) const MAX_WIDTH: usize = 8;

/// Stops the compiler where nodes would have another number of children than kernels and builders are made for.
pub(crate) const fn check_width<const N: usize>() {
    assert!(N == 4 || N == MAX_WIDTH, "nodes have four or eight children");
}

/// Triangles of a leaf block.
pub(crate) const BLOCK: u32 = 4;

/// Most blocks in one leaf, as in Embree.
pub const MAX_LEAF_BLOCKS: usize = 7;

/// Most triangles in one leaf.
pub(crate) const MAX_LEAF: u32 = BLOCK * MAX_LEAF_BLOCKS as u32;

/// Most leaf blocks of a tree: a link has 28 bits for the first block of a leaf.
pub(crate) const MAX_BLOCKS: usize = 1 << 28;

/// Most references per triangle that a configuration may allow its splits of triangles to make, all together.
/// A block holds at least one reference, so a mesh of [`Mesh::MAX_TRIANGLES`] fits into [`MAX_BLOCKS`] however
/// badly the blocks are filled.
pub(crate) const MAX_REFERENCES_PER_TRIANGLE: usize = 4;

/// Most references of a build.
const MAX_REFERENCES: usize = Mesh::MAX_TRIANGLES * MAX_REFERENCES_PER_TRIANGLE;

/// Most inner levels a tree may have: Embree's traversal stack holds no more, and neither does ours. Each level
/// of a wide tree replaces at least one level of the binary tree it is collapsed from, so a bound on the levels
/// of the binary tree bounds the wide tree, too.
pub const MAX_DEPTH: usize = 80;

/// Items that wait on the stack while a tree is traversed. Each level leaves at most seven of eight children
/// waiting while the eighth is visited; the lowest level has all eight on the stack for a moment.
pub(crate) const TRAVERSAL_STACK: usize = (MAX_WIDTH - 1) * MAX_DEPTH + 1;

/// From this depth on, cuts are halved by count rather than split by the SAH.
pub(crate) const CUT_DEPTH: u32 = 50;

/// From this depth on, cuts over finished clusters, which are not opened, are halved by count.
pub(crate) const FINISHED_CUT_DEPTH: u32 = 32;

/// Most inner levels of a finished cluster.
pub(crate) const FINISHED_LEVELS: u32 = 20;

/// From this depth on, subtrees of [`SUBTREE_MOST`] references or fewer are halved by count; it counts from the
/// root of the subtree, which lies above [`CUT_DEPTH`].
pub(crate) const SUBTREE_DEPTH: u32 = 12;

/// Most references of a subtree built by one sweep: they are numbered by bytes.
pub(crate) const SUBTREE_MOST: usize = 256;

/// Bits of a Morton code, and so the most levels above triangles of equal codes.
pub(crate) const MORTON_BITS: u32 = u32::BITS;

/// Triangles of equal Morton codes are partitioned by the middle of their centroids down to this depth below
/// the first of them, then halved by count.
pub(crate) const MIDDLE_DEPTH: u32 = 12;

/// From this depth on, a binary tree whose depth its builder did not bound, bottom-up or by binned SAH, is no longer
/// followed: its references are halved by count. Large subtrees are halved earlier, see [`follows_clusters`].
pub(crate) const FOLLOWED_DEPTH: u32 = 64;

/// Inner levels above leaves of one block if `references` are halved by count.
pub(crate) const fn halvings(references: usize) -> u32 {
    references.div_ceil(BLOCK as usize).next_power_of_two().trailing_zeros()
}

/// Whether a subtree of a cluster tree at `depth` may be split where its clusters are: either side then still
/// has room to be halved. The halves below need `halvings(references)` levels at most, so no subtree ends below
/// [`MAX_DEPTH`].
pub(crate) const fn follows_clusters(depth: u32, references: usize) -> bool {
    depth < FOLLOWED_DEPTH && depth + halvings(references) < MAX_DEPTH as u32
}

/// Levels of splits that [`follows_clusters`] allows in any subtree of `references` at `depth`, whatever its shape.
pub(crate) const fn followed_levels(depth: u32, references: usize) -> u32 {
    let room = (MAX_DEPTH as u32).saturating_sub(halvings(references));
    (if room < FOLLOWED_DEPTH { room } else { FOLLOWED_DEPTH }).saturating_sub(depth)
}

/// Blocks are numbered without overflow.
const _: () = assert!(MAX_REFERENCES <= MAX_BLOCKS);
/// Trees of refined cuts.
const _: () = assert!(CUT_DEPTH + halvings(MAX_REFERENCES) <= MAX_DEPTH as u32);
/// Trees of refined cuts over finished clusters, of which there are no more than references: cuts are halved down to
/// one of them.
const _: () = assert!(
    FINISHED_CUT_DEPTH + halvings(MAX_REFERENCES * BLOCK as usize) + FINISHED_LEVELS <= MAX_DEPTH as u32
);
/// Trees of refined cuts whose lowest levels are built by one sweep.
const _: () = assert!(CUT_DEPTH + SUBTREE_DEPTH + halvings(SUBTREE_MOST) <= MAX_DEPTH as u32);
/// Linear trees. Full leaves add no level: two to four of them lie in one to three levels, and the radix tree over the
/// same references has no fewer leaves, so as many levels at least. Only its four leaves may lie in two: then the full
/// ones are the same.
const _: () = assert!(MORTON_BITS + MIDDLE_DEPTH + halvings(MAX_REFERENCES) <= MAX_DEPTH as u32);
/// The root of a cluster tree: from there on [`follows_clusters`] keeps the bound.
const _: () = assert!(halvings(MAX_REFERENCES) < MAX_DEPTH as u32);
/// Leaves.
const _: () = assert!(MAX_LEAF == 28);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_ends_in_blocks_after_as_many_levels() {
        for references in 1..3000 {
            let (mut most, mut levels) = (references, 0);
            while most > BLOCK as usize {
                most = most.div_ceil(2);
                levels += 1;
            }
            assert_eq!(halvings(references), levels, "{references}");
        }
    }

    #[test]
    fn no_cluster_tree_grows_deeper_than_the_bound() {
        for references in [1, 5, 1000, 1 << 20, MAX_REFERENCES] {
            // A chain: one reference leaves at each level.
            let (mut depth, mut left) = (0, references);
            while left > BLOCK as usize && follows_clusters(depth, left) {
                depth += 1;
                left -= 1;
            }
            assert!(depth + halvings(left) <= MAX_DEPTH as u32, "{references}");
        }
        for (depth, references) in [(0, 5), (40, 1 << 20), (60, 4096), (62, 1 << 19), (70, 9)] {
            let levels = followed_levels(depth, references);
            assert!((depth..depth + levels).all(|at| follows_clusters(at, references)));
            assert!(!follows_clusters(depth + levels, references));
        }
        assert!(follows_clusters(63, 1 << 17) && !follows_clusters(63, 1 << 19) && !follows_clusters(64, 5));
    }
}
