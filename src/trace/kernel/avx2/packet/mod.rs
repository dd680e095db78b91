//! Many rays at a time. Where many are left, a vector has a lane for each: [a box](boxes) or [a triangle](triangles) is
//! tested against all of them at once. Where [few] are, it has a lane for each child or triangle. Either is done in the
//! operations and the order of [`FastAvx2`], so that each ray has the answers that it has by itself. One case is left
//! out: here a ray that touches a box at a plane of -0.0 meets it, as distances are compared as floats and not by their
//! bits.

mod boxes;
mod few;
mod triangles;

pub(in crate::trace::kernel) use boxes::Met;

use super::boxes::Slabs;
use super::fast::FastAvx2;
use crate::geometry::Ray;
use crate::simd::vector::Lanes;
use crate::trace::kernel::scalar::SMALLEST_DIRECTION;

/// Most rays of a packet: a mask has a bit for each.
pub(in crate::trace::kernel) const MOST: usize = 64;

/// Some of the rays.
pub(in crate::trace::kernel) type Mask = u64;

/// A value of each ray; longer, as sixteen floats are loaded even where eight are used.
type Row = [f32; MOST + 8];

/// The rays of a packet: all directions have the same signs.
#[cfg_attr(test, derive(Clone))]
pub(in crate::trace::kernel) struct Packet {
    /// Number of rays.
    rays: usize,
    /// Whether the upper side of boxes is met first, by axis.
    near: [bool; 3],
    rdir: [Row; 3],
    org_rdir: [Row; 3],
    org: [Row; 3],
    dir: [Row; 3],
    tnear: Row,
    tfar: Row,
}

impl Packet {
    /// A packet without rays.
    pub(in crate::trace::kernel) fn new() -> Self {
        const ROW: Row = [0.0; MOST + 8];
        let rows = [ROW; 3];
        let (rdir, org_rdir, org, dir) = (rows, rows, rows, rows);
        Self { rays: 0, near: [false; 3], rdir, org_rdir, org, dir, tnear: ROW, tfar: ROW }
    }

    /// Number of rays.
    #[inline(always)]
    pub(in crate::trace::kernel) fn len(&self) -> usize {
        self.rays
    }

    /// Adds a valid ray, for which there must be room.
    #[inline(always)]
    pub(in crate::trace::kernel) fn push(&mut self, ray: &Ray) {
        let i = self.rays % MOST;
        let (org, dir) = (ray.org.to_array(), ray.dir.to_array());
        for axis in 0..3 {
            self.org[axis][i] = org[axis];
            self.dir[axis][i] = dir[axis];
        }
        self.tnear[i] = ray.tnear;
        self.tfar[i] = ray.tfar;
        self.rays += 1;
    }

    /// Prepares the rays for [`Packet::meet`] and [`Packet::hit`], as `FastAvx2::new` does. Call it within
    /// [`Lanes::run`].
    #[inline(always)]
    pub(in crate::trace::kernel) fn prepare<L: Lanes>(&mut self, lanes: L) {
        let (zero, one, smallest) = (lanes.splat(0.0), lanes.splat(1.0), lanes.splat(SMALLEST_DIRECTION));
        for at in vectors::<L>() {
            for axis in 0..3 {
                let (org, dir) = (load(lanes, &self.org[axis], at), load(lanes, &self.dir[axis], at));
                let dir = lanes.select(lanes.lt(lanes.flip(dir, dir), smallest), smallest, dir);
                let estimate = lanes.reciprocal(dir);
                let rdir = lanes.fmadd(estimate, lanes.fnmadd(dir, estimate, one), estimate);
                store(lanes, rdir, &mut self.rdir[axis], at);
                store(lanes, lanes.mul(org, rdir), &mut self.org_rdir[axis], at);
            }
            let tnear = load(lanes, &self.tnear, at);
            store(lanes, lanes.max(tnear, zero), &mut self.tnear, at);
        }
        self.near = [0, 1, 2].map(|axis| self.rdir[axis][0] < 0.0);
    }

    /// Ray `i` by itself.
    #[inline(always)]
    pub(in crate::trace::kernel) fn ray<R>(&self, token: R, i: usize) -> FastAvx2<R> {
        let i = i % MOST;
        let of = |rows: &[Row; 3]| [rows[0][i], rows[1][i], rows[2][i]];
        let org_rdir = of(&self.org_rdir);
        let slabs = Slabs::of_sides(of(&self.rdir), [org_rdir; 2], self.near, self.tnear[i]);
        FastAvx2 { token, slabs, org: of(&self.org), dir: of(&self.dir) }
    }

    /// The last end of an interval, or 0 if that is later. An end that is no number, as of a distance that single
    /// precision cannot tell, does not count: its ray hits nothing more.
    #[inline(always)]
    pub(in crate::trace::kernel) fn farthest(&self) -> f32 {
        // Eight at a time: rows hold zeros where no ray is.
        let mut most = [0f32; 8];
        for ends in self.tfar[..MOST].as_chunks::<8>().0 {
            for (most, &end) in most.iter_mut().zip(ends) {
                *most = if end > *most { end } else { *most };
            }
        }
        most.into_iter().fold(0.0, f32::max)
    }

    /// Ends the interval of ray `i` at `tfar`.
    #[inline(always)]
    pub(in crate::trace::kernel) fn shorten(&mut self, i: usize, tfar: f32) {
        self.tfar[i % MOST] = tfar;
    }

    /// Whether so many of `rays` are left, three of four lanes in each vector that has any, that a lane for each is
    /// faster than [a lane for each child or triangle](few).
    #[inline(always)]
    pub(in crate::trace::kernel) fn is_worth<L: Lanes>(rays: Mask) -> bool {
        // The last lane of each vector; a carry reaches it from any other.
        let last = (Mask::MAX / ((1 << L::N) - 1)) << (L::N - 1);
        let vectors = (((rays & !last) + !last) | rays) & last;
        4 * rays.count_ones() >= 3 * L::N as u32 * vectors.count_ones()
    }
}

/// The first lanes of the vectors that a packet fills.
#[inline(always)]
fn vectors<L: Lanes>() -> impl Iterator<Item = usize> {
    (0..MOST / L::N).map(|vector| vector * L::N)
}

/// The `count` of `rays` from `first` on.
#[inline(always)]
fn of(rays: Mask, first: usize, count: usize) -> Mask {
    rays >> first & ((1 << count) - 1)
}

#[inline(always)]
fn store<L: Lanes>(lanes: L, x: L::F, row: &mut Row, at: usize) {
    if let Some(to) = row[at..].first_chunk_mut() {
        lanes.store(x, to);
    }
}

#[inline(always)]
fn load<L: Lanes>(lanes: L, row: &Row, at: usize) -> L::F {
    lanes.load(row[at..].first_chunk().unwrap_or(&[0.0; 16]))
}

#[inline(always)]
fn load3<L: Lanes>(lanes: L, rows: &[Row; 3], at: usize) -> [L::F; 3] {
    [load(lanes, &rows[0], at), load(lanes, &rows[1], at), load(lanes, &rows[2], at)]
}
