//! Several rays at a time on one core: each visits one node or leaf, then it is the next one's turn. While one
//! waits for memory, or for the comparison that its next step depends on, the processor works on the others.

#![allow(unsafe_code)]

use crate::bvh::limits::TRAVERSAL_STACK;
use crate::bvh::{Child, Link, WideNode};
use crate::geometry::{Hit, Ray};
use crate::simd::Avx2;
use crate::trace::kernel::sound_tree::SoundTree;
use crate::trace::kernel::traverse::{Entries, Kernel};
use std::arch::x86_64::*;
use std::mem::MaybeUninit;

/// Rays under way at a time.
const FLIGHT: usize = 16;

/// Children that wait: [`TRAVERSAL_STACK`], and those that a store of whole vectors writes beyond them.
const ROOM: usize = TRAVERSAL_STACK + 7;

/// A ray under way.
#[derive(Clone, Copy)]
struct UnderWay<K> {
    kernel: K,
    /// The closest hit so far; before the first its `t` is the end of the interval.
    hit: Hit,
    /// Children that wait.
    waiting: usize,
    /// Its place in the batch.
    index: usize,
}

/// The children that wait for a ray, the nearest last; written up to their number.
struct Waiting {
    links: [MaybeUninit<Link>; ROOM],
    entries: [MaybeUninit<u32>; ROOM],
}

/// Traces the valid ones of `rays` at `places`, for any hit if `ANY`, else for the closest, and tells `answer` the
/// place and the hit of each, in no order; of an any hit it only tells whether there is one. Compile it for AVX2.
#[inline(always)]
pub(super) fn run<K: Kernel, const N: usize, const ANY: bool>(
    token: Avx2,
    setup: K::Setup,
    tree: SoundTree<'_, N, K::Block>,
    rays: &[Ray],
    mut places: impl Iterator<Item = usize>,
    mut answer: impl FnMut(usize, Hit),
) {
    let mut valid = || places.find(|&place| rays[place].is_valid());
    let start = |place: usize, waiting: &mut Waiting| {
        let ray = &rays[place];
        waiting.links[0].write(tree.root());
        waiting.entries[0].write(0);
        UnderWay {
            kernel: K::new(setup, ray),
            hit: Hit { t: ray.tfar, ..Hit::MISS },
            waiting: 1,
            index: place,
        }
    };
    let mut stacks =
        [const { Waiting { links: [MaybeUninit::uninit(); ROOM], entries: [MaybeUninit::uninit(); ROOM] } };
            FLIGHT];
    let mut flight = arrayvec::ArrayVec::<UnderWay<K>, FLIGHT>::new();
    for waiting in &mut stacks {
        if let Some(place) = valid() {
            flight.push(start(place, waiting));
        }
    }
    while !flight.is_empty() {
        let mut turn = 0;
        while turn < flight.len() {
            let waiting = &mut stacks[turn];
            let ray = &mut flight[turn];
            match pop::<ANY>(waiting, &mut ray.waiting, ray.hit.t) {
                Some(link) => {
                    visit::<K, N, ANY>(token, tree, link, ray, waiting);
                    if ray.waiting > 0 {
                        // SAFETY: below their number children are written.
                        let link = unsafe { waiting.links.get_unchecked(ray.waiting - 1).assume_init() };
                        K::prefetch(tree.address(link), size_of::<WideNode<N>>());
                    }
                    turn += 1;
                }
                None => {
                    // Of any hit there is no distance.
                    answer(ray.index, if ANY { ray.hit } else { ray.hit.measured() });
                    if let Some(place) = valid() {
                        *ray = start(place, waiting);
                    } else {
                        // The last one takes its place, with its children.
                        let last = flight.len() - 1;
                        let count = flight[last].waiting;
                        flight.swap_remove(turn);
                        if turn < last {
                            let (before, from) = stacks.split_at_mut(last);
                            before[turn].links[..count].copy_from_slice(&from[0].links[..count]);
                            before[turn].entries[..count].copy_from_slice(&from[0].entries[..count]);
                        }
                    }
                }
            }
        }
    }
}

/// Takes the nearest child that is not behind `t`.
#[inline(always)]
fn pop<const ANY: bool>(waiting: &Waiting, count: &mut usize, t: f32) -> Option<Link> {
    while *count > 0 {
        *count -= 1;
        // SAFETY: below their number children are written.
        let (link, entry) = unsafe {
            (waiting.links.get_unchecked(*count).assume_init(), waiting.entries.get_unchecked(*count))
        };
        // SAFETY: as above; for any hits no entry is written, and none is read.
        if ANY || f32::from_bits(unsafe { entry.assume_init() }) <= t {
            return Some(link);
        }
    }
    None
}

/// Visits the node or the leaf at `link`, which was reached from the root.
#[inline(always)]
fn visit<K: Kernel, const N: usize, const ANY: bool>(
    token: Avx2,
    tree: SoundTree<'_, N, K::Block>,
    link: Link,
    ray: &mut UnderWay<K>,
    waiting: &mut Waiting,
) {
    if link.is_inner() {
        // SAFETY: links come from the stack, and there from nodes reached from the root.
        let node = unsafe { tree.node(link.bits() as usize) };
        let (mask, entries) = ray.kernel.enter(node, ray.hit.t);
        debug_assert!(ray.waiting + N <= ROOM);
        // SAFETY: the token proves AVX2. Each of at most `MAX_DEPTH` levels leaves at most seven children waiting,
        // so that there is room for the eight of the lowest.
        unsafe {
            let links = waiting.links.as_mut_ptr().add(ray.waiting);
            let to = waiting.entries.as_mut_ptr().add(ray.waiting);
            push::<N, ANY>(token, node, mask, &entries, links.cast(), to.cast());
        }
        ray.waiting += mask.count_ones() as usize;
    } else if let Child::Leaf { first, count } = link.get() {
        // SAFETY: as for the node.
        for block in unsafe { tree.leaf(first, count) } {
            if !ANY {
                ray.kernel.closest(block, &mut ray.hit);
            } else if ray.kernel.any(block, ray.hit.t) {
                ray.hit.prim = 0;
                ray.waiting = 0;
                return;
            }
        }
    }
}

/// Writes the links of the children in `mask` and, unless `ANY`, where they are entered, the nearest last. The
/// lowest bits of entries hold the slot while they are sorted, and are zeros after it: no entry is greater than it
/// was, so that a child entered at the very end of the interval is visited.
///
/// # Safety
/// `N` elements may be written at `links` and at `to`.
#[inline(always)]
unsafe fn push<const N: usize, const ANY: bool>(
    _: Avx2,
    node: &WideNode<N>,
    mask: u32,
    entries: &Entries<N>,
    links: *mut __m256i,
    to: *mut __m256i,
) {
    // SAFETY: the token proves AVX2; nodes and entries are of `N` elements, 4 or 8, unaligned loads and stores of
    // as many are within them, those to `links` and `to` by the caller's promise.
    unsafe {
        if N == 8 {
            let from = _mm256_loadu_si256(node.links.as_ptr().cast());
            if ANY {
                let slots =
                    _mm256_cvtepu8_epi32(_mm_loadl_epi64(SLOTS[mask as usize & 0xff].as_ptr().cast()));
                _mm256_storeu_si256(links, _mm256_permutevar8x32_epi32(from, slots));
                return;
            }
            let slots = _mm256_cvtepu8_epi32(_mm_loadl_epi64(SLOTS[mask as usize & 0xff].as_ptr().cast()));
            let count = mask.count_ones();
            if count <= 4 {
                // Nearly always: those met are put together first, so that four are to be sorted.
                let entry = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(entries.0.as_ptr().cast()), slots);
                let entry = _mm_andnot_si128(_mm_set1_epi32(7), _mm256_castsi256_si128(entry));
                let key = _mm_or_si128(entry, _mm256_castsi256_si128(slots));
                let met = _mm_cmpgt_epi32(_mm_set1_epi32(count as i32), _mm_setr_epi32(0, 1, 2, 3));
                let key = descending4(_mm_blendv_epi8(_mm_set1_epi32(-1), key, met));
                let sorted = _mm256_permutevar8x32_epi32(from, _mm256_castsi128_si256(key));
                _mm_storeu_si128(links.cast(), _mm256_castsi256_si128(sorted));
                _mm_storeu_si128(to.cast(), _mm_andnot_si128(_mm_set1_epi32(7), key));
                return;
            }
            let each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let met = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(mask as i32), each), each);
            let entry =
                _mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_loadu_si256(entries.0.as_ptr().cast()));
            let key = _mm256_or_si256(entry, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
            let key = descending8(_mm256_blendv_epi8(_mm256_set1_epi32(-1), key, met));
            _mm256_storeu_si256(links, _mm256_permutevar8x32_epi32(from, key));
            _mm256_storeu_si256(to, _mm256_andnot_si256(_mm256_set1_epi32(7), key));
        } else {
            let from = _mm_loadu_ps(node.links.as_ptr().cast());
            if ANY {
                let slots = _mm_cvtepu8_epi32(_mm_loadl_epi64(SLOTS[mask as usize & 0xf].as_ptr().cast()));
                _mm_storeu_ps(links.cast(), _mm_permutevar_ps(from, slots));
                return;
            }
            let each = _mm_setr_epi32(1, 2, 4, 8);
            let met = _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(mask as i32), each), each);
            let entry = _mm_andnot_si128(_mm_set1_epi32(3), _mm_loadu_si128(entries.0.as_ptr().cast()));
            let key = _mm_or_si128(entry, _mm_setr_epi32(0, 1, 2, 3));
            let key = descending4(_mm_blendv_epi8(_mm_set1_epi32(-1), key, met));
            _mm_storeu_ps(links.cast(), _mm_permutevar_ps(from, key));
            _mm_storeu_si128(to.cast(), _mm_andnot_si128(_mm_set1_epi32(3), key));
        }
    }
}

/// The slots in a mask, the lowest first.
static SLOTS: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut count, mut slot) = (0, 0);
        while slot < 8 {
            if mask >> slot & 1 == 1 {
                table[mask][count] = slot as u8;
                count += 1;
            }
            slot += 1;
        }
        mask += 1;
    }
    table
};

/// One step of a sorting network: each lane and its partner, the greater of them first but where the mask says.
macro_rules! step {
    ($x:ident, $partner:expr, $min:ident, $max:ident, $blend:ident, $lesser:literal) => {
        let partner = $partner;
        let $x = $blend::<$lesser>($max($x, partner), $min($x, partner));
    };
}

/// Sorts signed integers, the greatest first, by Batcher's bitonic network.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn descending8(x: __m256i) -> __m256i {
    macro_rules! next {
        ($x:ident, $partner:expr, $lesser:literal) => {
            step!($x, $partner, _mm256_min_epi32, _mm256_max_epi32, _mm256_blend_epi32, $lesser)
        };
    }
    // SAFETY: the caller's promise.
    unsafe {
        next!(x, _mm256_shuffle_epi32::<0b10_11_00_01>(x), 0b1010_1010);
        next!(x, _mm256_shuffle_epi32::<0b00_01_10_11>(x), 0b1100_1100);
        next!(x, _mm256_shuffle_epi32::<0b10_11_00_01>(x), 0b1010_1010);
        next!(x, _mm256_permutevar8x32_epi32(x, _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0)), 0b1111_0000);
        next!(x, _mm256_shuffle_epi32::<0b01_00_11_10>(x), 0b1100_1100);
        next!(x, _mm256_shuffle_epi32::<0b10_11_00_01>(x), 0b1010_1010);
        x
    }
}

/// The same of four.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn descending4(x: __m128i) -> __m128i {
    macro_rules! next {
        ($x:ident, $partner:expr, $lesser:literal) => {
            step!($x, $partner, _mm_min_epi32, _mm_max_epi32, _mm_blend_epi32, $lesser)
        };
    }
    // SAFETY: the caller's promise.
    unsafe {
        next!(x, _mm_shuffle_epi32::<0b10_11_00_01>(x), 0b1010);
        next!(x, _mm_shuffle_epi32::<0b00_01_10_11>(x), 0b1100);
        next!(x, _mm_shuffle_epi32::<0b10_11_00_01>(x), 0b1010);
        x
    }
}
