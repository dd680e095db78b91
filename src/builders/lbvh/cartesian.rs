//! The stack that makes a binary tree of subtrees in a row and the heights at which neighbours part.

/// More than the heights there are: each subtree on the stack has one of its own.
const WAITING: usize = 128;

/// Subtrees that wait for siblings to their right: each parts from the one before at a lower height than that from
/// its own.
pub(crate) struct Waiting<T> {
    subtrees: [T; WAITING],
    heights: [u8; WAITING],
    /// The first subtree is at 1, above what is higher than all.
    last: usize,
}

impl<T: Copy> Waiting<T> {
    /// None; `filler` is never looked at.
    pub fn new(filler: T) -> Self {
        Self { subtrees: [filler; WAITING], heights: [u8::MAX; WAITING], last: 0 }
    }

    /// Appends a subtree that parts from the one before at `height`.
    #[inline]
    pub fn push(&mut self, subtree: T, height: u8) {
        self.last += 1;
        self.subtrees[self.last] = subtree;
        self.heights[self.last] = height;
    }

    /// Unites those that part below `height`.
    #[inline]
    pub fn unite_below(&mut self, height: u8, mut unite: impl FnMut([T; 2]) -> T) {
        while self.heights[self.last] < height {
            let children = [self.subtrees[self.last - 1], self.subtrees[self.last]];
            self.last -= 1;
            self.subtrees[self.last] = unite(children);
        }
    }

    /// The last subtree.
    pub fn last(&self) -> T {
        self.subtrees[self.last]
    }
}
