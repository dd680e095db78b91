//! Paper 4.5: a wide node is formed by opening the largest child until there are as many as the node holds.

use crate::builders::binary::kind::Kind;
use arrayvec::ArrayVec;

/// Which child of a wide node in the making is opened first: the greatest. Children of [`Kind::Inner`] come before
/// those of [`Kind::SoftLeaf`], larger ones before smaller ones, and leaves are not opened.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub(crate) struct Priority(u64);

impl Priority {
    const SOFT: u64 = 1 << 32;
    const INNER: u64 = 2 << 32;

    /// Of a child of the given kind and half area.
    #[inline(always)]
    pub fn new(kind: Kind, half_area: f32) -> Self {
        let class = match kind {
            Kind::Inner => Self::INNER,
            Kind::SoftLeaf => Self::SOFT,
            Kind::Leaf => 0,
        };
        // Areas are not negative: their bits are in their order.
        Self(class | u64::from(half_area.to_bits()))
    }

    /// Whether one of `children` children may be opened: a soft leaf only if it is not alone, as opening it would
    /// cost a node else.
    #[inline(always)]
    fn may_open(self, children: usize) -> bool {
        self.0 >= if children > 1 { Self::SOFT } else { Self::INNER }
    }
}

/// Opens the child of the greatest priority, the first of equal ones, until there are `N` children or none may be
/// opened. `open` replaces the child at an index by two ([`replace`]), one, or none; it may give up with `None`.
#[inline(always)]
pub(crate) fn open_largest<T, const N: usize>(
    children: &mut ArrayVec<T, N>,
    priority: impl Fn(&T) -> Priority,
    mut open: impl FnMut(&mut ArrayVec<T, N>, usize) -> Option<()>,
) -> Option<()> {
    while (1..N).contains(&children.len()) {
        let first = (0, priority(&children[0]));
        let later = children.iter().map(&priority).enumerate().skip(1);
        let (next, largest) = later.fold(first, |best, other| if other.1 > best.1 { other } else { best });
        if !largest.may_open(children.len()) {
            break;
        }
        open(children, next)?;
    }
    Some(())
}

/// Replaces the child at an index by two, in order.
#[inline(always)]
pub(crate) fn replace<T, const N: usize>(children: &mut ArrayVec<T, N>, index: usize, [left, right]: [T; 2]) {
    children[index] = left;
    children.insert(index + 1, right);
}
