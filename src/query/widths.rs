//! A tree of either width. Its width is a type, so that each query is compiled once for both.

/// What there is of a tree of nodes of up to four children, or of up to eight.
#[derive(Debug)]
pub(super) enum OfWidth<A, B> {
    Four(A),
    Eight(B),
}

impl<A, B> OfWidth<A, B> {
    /// Most children of a node.
    pub fn width(&self) -> usize {
        match self {
            Self::Four(_) => 4,
            Self::Eight(_) => 8,
        }
    }

    /// That of four, if it is one.
    pub fn four(&self) -> Option<&A> {
        if let Self::Four(built) = self { Some(built) } else { None }
    }

    /// That of eight, if it is one.
    pub fn eight(&self) -> Option<&B> {
        if let Self::Eight(built) = self { Some(built) } else { None }
    }
}

/// The value of `$value`, where `$built` stands for what `$tree` holds, whatever its width.
macro_rules! at_width {
    ($tree:expr, $built:ident => $value:expr) => {
        match $tree {
            $crate::query::widths::OfWidth::Four($built) => $value,
            $crate::query::widths::OfWidth::Eight($built) => $value,
        }
    };
}
pub(super) use at_width;
