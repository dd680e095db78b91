//! What a side of a split is taken to cost beside its area (paper 4.2, equation 1).

/// How the nodes of a side are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Weight {
    /// Every node of the cut is one, as in equation 1.
    Nodes,
    /// Every four are one: what leaves cost, where the nodes are single triangles.
    Quartets,
}

/// A split must cost less than this part of no split (`S n`) to count as a gain: among boxes all alike every
/// split costs `S n` but for rounding, and the first of them would peel off one node at a time.
const GAIN: f32 = 1.0 - 1.0 / (1 << 20) as f32;

impl Weight {
    /// The weight of `n` nodes.
    #[inline]
    pub fn of(self, n: usize) -> f32 {
        match self {
            Self::Nodes => n as f32,
            Self::Quartets => n.div_ceil(4) as f32,
        }
    }

    /// Splits of `n` nodes in a box of half `area` must cost less than this.
    #[inline]
    pub fn limit(self, area: f32, n: usize) -> f32 {
        match self {
            Self::Nodes => area * n as f32 * GAIN,
            // Of a few triangles the best split is taken, whatever it costs.
            Self::Quartets => f32::INFINITY,
        }
    }
}
