//! Paper 4.5: a wide node is formed by opening the largest child until there are as many as the node holds.

use crate::builders::binary::kind::Kind;
use crate::bvh::limits::WIDTH;
use arrayvec::ArrayVec;

/// Which child of a wide node in the making is opened first: the greatest. Children of [`Kind::Inner`] come before those
/// of [`Kind::SoftLeaf`], larger ones before smaller ones, and leaves are not opened.
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

    /// Whether one of `children` children may be opened: a soft leaf only if it is not alone, as opening it would cost a
    /// node else.
    #[inline(always)]
    fn may_open(self, children: usize) -> bool {
        self.0 >= if children > 1 { Self::SOFT } else { Self::INNER }
    }
}

/// Opens the child of the greatest priority, the first of equal ones, until there are [`WIDTH`] children or none may be
/// opened. `open` gives what takes a child's place: two children in order, one, or none. `None` if `open` gives up.
#[inline(always)]
pub(crate) fn open_largest<T>(
    children: &mut ArrayVec<T, WIDTH>,
    priority: impl Fn(&T) -> Priority,
    mut open: impl FnMut(&T) -> Option<[Option<T>; 2]>,
) -> Option<()> {
    while (1..WIDTH).contains(&children.len()) {
        let first = (0, priority(&children[0]));
        let later = children.iter().map(&priority).enumerate().skip(1);
        let (next, largest) = later.fold(first, |best, other| if other.1 > best.1 { other } else { best });
        if !largest.may_open(children.len()) {
            break;
        }
        match open(&children[next])? {
            [Some(left), Some(right)] => {
                children[next] = left;
                children.insert(next + 1, right);
            }
            [Some(only), None] | [None, Some(only)] => children[next] = only,
            [None, None] => {
                children.remove(next);
            }
        }
    }
    Some(())
}
