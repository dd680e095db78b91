//! The binary tree over a row of leaves with the deltas of neighbours: their Cartesian tree, in one pass with a
//! stack (cf. Apetrei 2014).

/// More than the levels at which neighbours are separated: each subtree on the stack has a delta of its own, but for
/// two within a subtree with full leaves.
const STACK: usize = 128;

/// Builds the tree over `leaves`, one or more, each with the delta to the leaf before. `merge` makes the
/// parent of two subtrees; `filler` is never read.
#[inline(always)]
pub(crate) fn cartesian_tree<T: Copy>(
    filler: T,
    leaves: impl Iterator<Item = (T, u8)>,
    mut merge: impl FnMut([T; 2]) -> T,
) -> T {
    let mut stack = CartesianStack { subtrees: [filler; STACK], deltas: [u8::MAX; STACK], last: 0 };
    for (leaf, delta) in leaves {
        stack.merge_below(delta, &mut merge);
        stack.push(leaf, delta);
    }
    stack.merge_below(u8::MAX, &mut merge);
    stack.subtrees[stack.last]
}

/// Subtrees that wait for their right siblings, in descending order of their deltas.
struct CartesianStack<T> {
    subtrees: [T; STACK],
    deltas: [u8; STACK],
    /// The first subtree is at 1, above a delta that is greater than all.
    last: usize,
}

impl<T: Copy> CartesianStack<T> {
    #[inline(always)]
    fn push(&mut self, subtree: T, delta: u8) {
        self.last += 1;
        self.subtrees[self.last] = subtree;
        self.deltas[self.last] = delta;
    }

    /// Merges the subtrees whose delta is below `delta`.
    #[inline(always)]
    fn merge_below(&mut self, delta: u8, merge: &mut impl FnMut([T; 2]) -> T) {
        while self.deltas[self.last] < delta {
            let children = [self.subtrees[self.last - 1], self.subtrees[self.last]];
            self.last -= 1;
            self.subtrees[self.last] = merge(children);
        }
    }
}
