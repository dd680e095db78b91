//! The traversal of a group, after Embree's coherent streams (Woop, "A Ray Tracing Kernel Framework", 2014; Barringer and
//! Akenine-Moeller, "Dynamic Ray Stream Traversal", 2014): depth first, nearest child first, each child with the rays that
//! meet its box. Generic over the lanes of a vector.

use super::group::{Bounds, Packet, SIZE};
use crate::bvh::limits::TRAVERSAL_STACK;
use crate::bvh::{Child, Link, TriangleBlock, WideNode};
use crate::simd::vector::Lanes;
use crate::trace::kernel::sound_tree::SoundTree;
use arrayvec::ArrayVec;

/// A child that waits, with the rays that met its box.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    link: Link,
    /// Where a ray enters it at the earliest.
    entry: f32,
    rays: u64,
}

/// As for single rays, the depth of a tree bounds the children that wait.
pub(super) type Stack = ArrayVec<Waiting, TRAVERSAL_STACK>;

/// What a traversal works on.
pub(super) struct Traversal<'a, L, const N: usize> {
    pub(super) lanes: L,
    pub(super) tree: SoundTree<'a, N>,
    pub(super) packets: &'a mut [Packet],
    pub(super) bounds: Bounds,
    /// Up to so many rays leave the group.
    pub(super) few: u32,
    /// Empty before and after; kept for its memory.
    pub(super) stack: &'a mut Stack,
}

impl<L: Lanes, const N: usize> Traversal<'_, L, N> {
    /// Traces `rays` of the group, for any hit if `ANY`, else for the closest, which the packets then hold. `single` goes on
    /// with a few rays below a link: it updates the packets, and returns those that hit. Returns the rays that hit anything
    /// if `ANY`.
    #[inline(always)]
    pub(super) fn run<const ANY: bool>(
        &mut self,
        rays: u64,
        mut single: impl FnMut(&mut [Packet], Link, u64) -> u64,
    ) -> u64 {
        let mut done = 0;
        self.stack.push(Waiting { link: self.tree.root(), entry: 0.0, rays });
        while let Some(Waiting { link, entry, rays: met }) = self.stack.pop() {
            let met = met & !done;
            if met == 0 || entry > self.bounds.t {
                continue;
            }
            if met.count_ones() <= self.few {
                let hit = single(self.packets, link, met);
                if ANY {
                    done |= hit;
                }
                continue;
            }
            match link.get() {
                Child::Empty => {}
                Child::Inner(index) => {
                    self.children::<ANY>(&self.tree.nodes()[index], met);
                }
                Child::Leaf { first, count } => {
                    let mut left = met;
                    let mut hit = 0;
                    for block in &self.tree.blocks()[first..first + count] {
                        hit |= self.block::<ANY>(block, left);
                        left = if ANY { met & !hit } else { met };
                        if left == 0 {
                            break;
                        }
                    }
                    if ANY {
                        done |= hit;
                    } else if hit != 0 {
                        self.farthest();
                    }
                }
            }
        }
        done
    }

    /// Puts the children of `node` that any of `rays` meets on the stack, the nearest on top.
    #[inline(always)]
    fn children<const ANY: bool>(&mut self, node: &WideNode<N>, rays: u64) {
        let base = self.stack.len();
        let (mut children, entries) = self.bounds.enter(node);
        while children != 0 {
            let slot = children.trailing_zeros() as usize % N;
            children &= children - 1;
            let met = self.meeting(node, slot, rays);
            if met == 0 {
                continue;
            }
            let child = Waiting { link: node.links[slot], entry: entries[slot], rays: met };
            let mut at = self.stack.len();
            self.stack.push(child);
            while !ANY && at > base && self.stack[at - 1].entry < child.entry {
                self.stack[at] = self.stack[at - 1];
                at -= 1;
            }
            self.stack[at] = child;
        }
    }

    /// Those of `rays` that meet the box of `slot`.
    #[inline(always)]
    fn meeting(&self, node: &WideNode<N>, slot: usize, rays: u64) -> u64 {
        let l = self.lanes;
        let (mut near, mut far) = ([l.splat(0.0); 3], [l.splat(0.0); 3]);
        for axis in 0..3 {
            let (lower, upper) = (l.splat(node.lower[axis][slot]), l.splat(node.upper[axis][slot]));
            (near[axis], far[axis]) =
                if self.bounds.is_positive(axis) { (lower, upper) } else { (upper, lower) };
        }
        let mut met = 0;
        for (index, packet) in self.packets.iter().enumerate() {
            if part::<L>(rays, index) == 0 {
                continue;
            }
            let (mut enter, mut leave) = (l.load(&packet.tnear), l.load(&packet.t));
            for axis in 0..3 {
                let (rdir, org_rdir) = (l.load(&packet.rdir[axis]), l.load(&packet.org_rdir[axis]));
                enter = l.max(l.mul_sub(near[axis], rdir, org_rdir), enter);
                leave = l.min(l.mul_sub(far[axis], rdir, org_rdir), leave);
            }
            met |= u64::from(l.bits(l.le(enter, leave))) << (index * L::N);
        }
        met & rays
    }

    /// Tests the triangles of `block` against `rays`, as the single-ray kernel does; returns those that hit.
    #[inline(always)]
    fn block<const ANY: bool>(&mut self, block: &TriangleBlock, rays: u64) -> u64 {
        let l = self.lanes;
        let (zero, one, minus) = (l.splat(0.0), l.splat(1.0), l.splat(-0.0));
        let mut hit = 0;
        for (lane, prim) in block.ids().enumerate() {
            let (v0, e1, e2) =
                (corner(l, &block.v0, lane), corner(l, &block.e1, lane), corner(l, &block.e2, lane));
            let normal = cross(l, e2, e1);
            for (index, packet) in self.packets.iter_mut().enumerate() {
                let part = part::<L>(rays, index);
                if part == 0 {
                    continue;
                }
                let (org, dir) = (load(l, &packet.org), load(l, &packet.dir));
                let c = [l.sub(v0[0], org[0]), l.sub(v0[1], org[1]), l.sub(v0[2], org[2])];
                let r = cross(l, c, dir);
                let den = dot(l, normal, dir);
                let sign = l.both(den, minus);
                let den = l.xor(den, sign);
                let (u, v) = (l.xor(dot(l, r, e2), sign), l.xor(dot(l, r, e1), sign));
                let inside = l
                    .and(l.and(l.le(zero, u), l.le(zero, v)), l.and(l.lt(zero, den), l.le(l.add(u, v), den)));
                if l.bits(inside) & part == 0 {
                    continue;
                }
                let t = l.xor(dot(l, normal, c), sign);
                let beyond = l.lt(l.mul(den, l.load(&packet.tnear)), t);
                let before = l.le(t, l.mul(den, l.load(&packet.t)));
                let found = l.bits(l.and(inside, l.and(beyond, before))) & part;
                if found == 0 {
                    continue;
                }
                hit |= u64::from(found) << (index * L::N);
                if !ANY {
                    let mask = l.mask(found);
                    replace(l, mask, l.div(t, den), &mut packet.t);
                    replace(l, mask, l.min(l.div(u, den), one), &mut packet.u);
                    replace(l, mask, l.min(l.div(v, den), one), &mut packet.v);
                    let mut left = found;
                    while left != 0 {
                        packet.prim[left.trailing_zeros() as usize % 16] = prim;
                        left &= left - 1;
                    }
                }
            }
        }
        hit
    }

    /// Notes that closer hits were found.
    #[inline(always)]
    fn farthest(&mut self) {
        let l = self.lanes;
        let mut most = l.load(&self.packets[0].t);
        for packet in &self.packets[1..] {
            most = l.max(most, l.load(&packet.t));
        }
        let mut each = [f32::NEG_INFINITY; 16];
        l.store(most, &mut each);
        self.bounds.t = each.into_iter().fold(f32::NEG_INFINITY, |a, b| if a > b { a } else { b });
    }
}

/// The bits of packet `index`.
#[inline(always)]
fn part<L: Lanes>(rays: u64, index: usize) -> u32 {
    const { assert!(L::N * (SIZE / L::N) == SIZE) };
    (rays >> (index * L::N)) as u32 & ((1 << L::N) - 1)
}

/// The vector of `lane`, for all rays.
#[inline(always)]
fn corner<L: Lanes>(l: L, v: &[[f32; 4]; 3], lane: usize) -> [L::F; 3] {
    [l.splat(v[0][lane]), l.splat(v[1][lane]), l.splat(v[2][lane])]
}

#[inline(always)]
fn load<L: Lanes>(l: L, v: &[[f32; 16]; 3]) -> [L::F; 3] {
    [l.load(&v[0]), l.load(&v[1]), l.load(&v[2])]
}

#[inline(always)]
fn replace<L: Lanes>(l: L, mask: L::M, new: L::F, of: &mut [f32; 16]) {
    l.store(l.select(mask, new, l.load(of)), of);
}

#[inline(always)]
fn dot<L: Lanes>(l: L, a: [L::F; 3], b: [L::F; 3]) -> L::F {
    l.mul_add(a[0], b[0], l.mul_add(a[1], b[1], l.mul(a[2], b[2])))
}

#[inline(always)]
fn cross<L: Lanes>(l: L, a: [L::F; 3], b: [L::F; 3]) -> [L::F; 3] {
    [
        l.mul_sub(a[1], b[2], l.mul(a[2], b[1])),
        l.mul_sub(a[2], b[0], l.mul(a[0], b[2])),
        l.mul_sub(a[0], b[1], l.mul(a[1], b[0])),
    ]
}
