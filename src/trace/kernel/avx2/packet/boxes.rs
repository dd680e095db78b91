//! The children of a node that rays of a packet meet.

use super::{Mask, Packet, load, load3, of, vectors};
use crate::bvh::{Link, WideNode};
use crate::simd::vector::Lanes;

/// The children of a node that rays of a packet meet.
#[cfg_attr(test, derive(PartialEq, Debug))]
pub(in crate::trace::kernel) struct Met<const N: usize> {
    /// The rays that meet each, as a mask.
    pub rays: [Mask; N],
    /// Where the first of them enters it, or another ray of the packet if that is earlier, as bits of a float that
    /// is not negative; 0 where nobody asks.
    pub entry: [u32; N],
    /// A bit for each child that any of them meets.
    pub children: u32,
}

impl Packet {
    /// The children of `node` that `rays` meet; of any hits nobody asks where. Call it within [`Lanes::run`].
    #[inline(always)]
    pub(in crate::trace::kernel) fn meet<L: Lanes, const N: usize, const ANY: bool>(
        &self,
        lanes: L,
        node: &WideNode<N>,
        rays: Mask,
    ) -> Met<N> {
        let mut met = Met { rays: [0; N], entry: [if ANY { 0 } else { u32::MAX }; N], children: 0 };
        let sides = [&node.lower, &node.upper];
        let [x, y, z] = self.near.map(usize::from);
        let first = [&sides[x][0], &sides[y][1], &sides[z][2]];
        let last = [&sides[1 - x][0], &sides[1 - y][1], &sides[1 - z][2]];
        for at in vectors::<L>() {
            let alive = of(rays, at, L::N);
            if alive == 0 {
                continue;
            }
            let rdir = load3(lanes, &self.rdir, at);
            let org_rdir = load3(lanes, &self.org_rdir, at);
            let (tnear, tfar) = (load(lanes, &self.tnear, at), load(lanes, &self.tfar, at));
            for slot in 0..N {
                if node.links[slot] == Link::EMPTY {
                    continue;
                }
                let [a, b, c] = slabs(lanes, first, slot, rdir, org_rdir);
                let [d, e, f] = slabs(lanes, last, slot, rdir, org_rdir);
                // Of two the second is kept where either is no number: the box is then met.
                let enter = lanes.max(lanes.max(a, b), lanes.max(c, tnear));
                let leave = lanes.min(lanes.min(d, e), lanes.min(f, tfar));
                let is_met = lanes.le(enter, leave);
                let bits = lanes.bits(is_met) & alive as u32;
                met.rays[slot] |= Mask::from(bits) << at;
                met.children |= u32::from(bits != 0) << slot;
                if !ANY && bits != 0 {
                    let entry = lanes.least(lanes.select(is_met, enter, lanes.splat(f32::INFINITY)));
                    met.entry[slot] = met.entry[slot].min(entry.to_bits());
                }
            }
        }
        met
    }
}

/// Where rays meet three planes of a child.
#[inline(always)]
fn slabs<L: Lanes, const N: usize>(
    lanes: L,
    [x, y, z]: [&[f32; N]; 3],
    slot: usize,
    rdir: [L::F; 3],
    org_rdir: [L::F; 3],
) -> [L::F; 3] {
    // Not by `map`, which is not always inlined.
    [
        lanes.fmsub(lanes.splat(x[slot]), rdir[0], org_rdir[0]),
        lanes.fmsub(lanes.splat(y[slot]), rdir[1], org_rdir[1]),
        lanes.fmsub(lanes.splat(z[slot]), rdir[2], org_rdir[2]),
    ]
}
