//! Which of the children that a ray meets it visits next. Branches decide where the processor `FORESEES` them: it then
//! fetches the child before it knows. Elsewhere an only child is looked up, and two are put in order by moves.

#![allow(unsafe_code)]

use super::stack::{Item, Stack, ordered};
use crate::bvh::{Link, WideNode};
use std::hint::black_box;

/// The link of the only child in `mask`, found by branches: where these are foreseen, as with rays that follow each
/// other, the child is fetched while its box is still tested. A table would have to wait for the test.
#[inline(always)]
pub(super) fn only<const N: usize>(node: &WideNode<N>, mask: u32) -> Link {
    // A black box for each child, or the compiler would make a table of them.
    let link = |slot: usize| Link::from_bits(black_box(node.links[slot].bits()));
    for slot in 0..N - 1 {
        if mask >> slot & 1 == 1 {
            return link(slot);
        }
    }
    link(N - 1)
}

/// The nearest of the children in `mask`, entered at `entries`, of which there is one at least, two where the processor
/// `FORESEES`; `prefetch` is told all, and the others wait on `stack`, the nearest uppermost. Of those at the same
/// distance the one of the lesser link is nearer: inner nodes before leaves, then that which lies first in memory.
///
/// # Safety
/// As [`Stack::push`], for each child.
#[inline(always)]
pub(super) unsafe fn nearest<const N: usize, const FORESEES: bool>(
    node: &WideNode<N>,
    mut mask: u32,
    entries: &[u32; N],
    prefetch: impl Fn(Link),
    stack: &mut Stack<'_>,
) -> Link {
    let mut next = || {
        let slot = mask.trailing_zeros() as usize % N;
        mask &= mask - 1;
        let item = Item::new(entries[slot], node.links[slot]);
        prefetch(item.link());
        (item, mask == 0)
    };
    let (a, last) = next();
    if !FORESEES && last {
        return a.link();
    }
    let (b, last) = next();
    if last {
        if FORESEES {
            // A branch, not moves: where it is foreseen, the nearer child is fetched before the comparison.
            if a < b {
                // SAFETY: the caller's promise.
                unsafe { stack.push(b) };
                return a.link();
            }
            // SAFETY: the caller's promise.
            unsafe { stack.push(a) };
            return b.link();
        }
        let (a, b) = ordered(a, b);
        // SAFETY: the caller's promise.
        unsafe { stack.push(b) };
        return a.link();
    }
    let (c, last) = next();
    if last {
        let (a, b) = ordered(a, b);
        let (b, c) = ordered(b, c);
        let (a, b) = ordered(a, b);
        // SAFETY: the caller's promise.
        unsafe { stack.push_all([c, b]) };
        return a.link();
    }
    let (d, last) = next();
    let (a, b) = ordered(a, b);
    let (c, d) = ordered(c, d);
    let (a, c) = ordered(a, c);
    let (b, d) = ordered(b, d);
    let (b, c) = ordered(b, c);
    if N == 4 || last {
        // SAFETY: the caller's promise.
        unsafe { stack.push_all([d, c, b]) };
        return a.link();
    }
    let base = stack.len();
    // SAFETY: the caller's promise; of five or more all are there for a moment.
    unsafe { stack.push_all([d, c, b, a]) };
    loop {
        let (item, last) = next();
        // SAFETY: see above.
        unsafe { stack.insert(base, item) };
        if last {
            break;
        }
    }
    stack.pop().map_or(Link::EMPTY, Item::link)
}
