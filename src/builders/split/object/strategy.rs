//! Which way finds the object split of a cut: by its length and the instruction set.

use super::bins::Bins;
use super::full_sweep::FullSweep;
use super::lanes;
use super::ranks::{self, RankSweep};
use super::split::ObjectSplit;
use crate::builders::binary::node::Node;
use crate::builders::split::cost::Weight;
use crate::geometry::Aabb;
use crate::simd::Isa;

/// From this length on bins are faster than sorting, where ranks are not counted.
const LONG: usize = 24;

/// Memory of sweeps.
#[derive(Default)]
pub(crate) struct ObjectSweep {
    full: FullSweep,
    ranks: RankSweep,
    bins: Bins,
}

impl ObjectSweep {
    /// The object split of `nodes` (two or more, with union `bounds`), as [`FullSweep::best`] defines it, and the bins
    /// that were made of them: they tell where spatial splits may be cheap ([`Bins::planes_below`]).
    #[inline]
    pub fn find(
        &mut self,
        isa: Isa,
        nodes: &[Node],
        bounds: Aabb,
        weight: Weight,
    ) -> (ObjectSplit, Option<&Bins>) {
        let n = nodes.len();
        let limit = weight.limit(bounds.half_area(), n);
        if let [a, b] = nodes {
            return (ObjectSplit::of_two(a, b, limit), None);
        }
        let split = match isa {
            Isa::Avx512(token) if n <= lanes::MOST => lanes::avx512(token, nodes, limit, weight),
            Isa::Avx2(token) if n <= lanes::MOST_AVX2 => lanes::avx2(token, nodes, limit, weight),
            Isa::Avx512(token) if n <= ranks::MOST => self.ranks.best(token, nodes, limit, weight),
            Isa::Avx2(token) if n <= ranks::MOST_AVX2 => self.ranks.best(token, nodes, limit, weight),
            _ if n >= LONG => {
                let Self { full, bins, .. } = self;
                let split = isa.run(
                    #[inline(always)]
                    || bins.best(full, nodes, limit, weight),
                );
                return (split, Some(bins));
            }
            _ => self.full.best(nodes, limit, weight),
        };
        (split, None)
    }
}
