//! The recursion of binned SAH.

use super::bins::{Binning, SahBins, info};
use super::config::BinnedSahConfig;
use crate::builders::binary::node::Node;
use crate::builders::lbvh::key::{MortonKey, reference};
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::{GRAIN, PrimInfo, PrimRefs};
use crate::bvh::limits::FOLLOWED_DEPTH;
use crate::geometry::Aabb;
use crate::memory::huge_pages;
use crate::parallel;

/// A reference with its box.
type Item = (MortonKey, Aabb);

/// Smaller subtrees are built by one thread.
const SERIAL: usize = 1 << 12;

/// The root of the tree over `keys`, whose pairs go to `pairs`: those below a node in a row that ends with its own.
/// Keys are put into the order of the leaves. `None` without keys.
pub(crate) fn binned_sah<G: Geometry>(
    config: &BinnedSahConfig,
    refs: &PrimRefs<'_, G>,
    keys: &mut [MortonKey],
    pairs: &mut Vec<[Node; 2]>,
) -> Option<Node> {
    huge_pages::resize(pairs, keys.len().saturating_sub(1), [Node::ZERO; 2], "pairs of nodes");
    let mut items: Vec<Item> = Vec::new();
    huge_pages::resize(&mut items, keys.len(), (0, Aabb::EMPTY), "references with their boxes");
    parallel::for_each(items.chunks_mut(GRAIN).zip(keys.chunks(GRAIN)), |(items, keys)| {
        items.iter_mut().zip(keys).for_each(|(item, &key)| *item = (key, refs.bounds(reference(key))));
    });
    let root = (!items.is_empty()).then(|| build(config, &mut items, (0, 0), 0, pairs));
    keys.iter_mut().zip(&items).for_each(|(key, item)| *key = item.0);
    root
}

/// The subtree over items from position `first` on, whose pairs are numbered from `base` on.
fn build(
    config: &BinnedSahConfig,
    items: &mut [Item],
    (first, base): (usize, usize),
    depth: u32,
    pairs: &mut [[Node; 2]],
) -> Node {
    if let [(_, bounds)] = items {
        return Node::leaf(*bounds, first, 1);
    }
    // Below some depth items are halved, as where all have one centroid.
    let split = if depth < FOLLOWED_DEPTH { split(config, items) } else { None };
    let split = split.unwrap_or(items.len() / 2);
    let (is_serial, place) = (items.len() < SERIAL, base + items.len() - 2);
    let (left, right) = items.split_at_mut(split);
    let (last, rest) = pairs.split_last_mut().expect("there is a pair less than items");
    let (left_pairs, right_pairs) = rest.split_at_mut(split - 1);
    let mut left = || build(config, left, (first, base), depth + 1, left_pairs);
    let mut right = || build(config, right, (first + split, base + split - 1), depth + 1, right_pairs);
    let (left, right) = if is_serial { (left(), right()) } else { parallel::join(left, right) };
    *last = [left, right];
    Node::inner(last, place)
}

/// Puts the items of the cheapest split's left side first, either side in its order; `None` if there is no split.
fn split(config: &BinnedSahConfig, items: &mut [Item]) -> Option<usize> {
    if items.len() == 2 {
        return None;
    }
    let boxes = |items: &[Item]| info(items.iter().map(|(_, bounds)| *bounds));
    let centers = in_parts(items, boxes).into_iter().fold(PrimInfo::EMPTY, PrimInfo::union).centers;
    let binning = Binning::new(centers, config.bins.min(4 + items.len() / 20));
    let bins = |items: &[Item]| SahBins::of(&binning, items.iter().map(|(_, bounds)| *bounds));
    let bins = in_parts(items, bins).into_iter().reduce(|a, b| a.union(&b))?;
    let plane = bins.cheapest()?;
    let is_left = |item: &Item| binning.bin(item.1, plane.axis) < plane.bin;
    let (mut left, mut right) = (0, Vec::new());
    huge_pages::reserve(&mut right, items.len(), "references on the right");
    for at in 0..items.len() {
        let item = items[at];
        if is_left(&item) {
            items[left] = item;
            left += 1;
        } else {
            right.push(item);
        }
    }
    items[left..].copy_from_slice(&right);
    Some(left)
}

/// What `f` makes of parts of the items, in order.
fn in_parts<R: Send>(items: &[Item], f: impl Fn(&[Item]) -> R + Sync + Send) -> Vec<R> {
    if items.len() <= GRAIN { vec![f(items)] } else { parallel::map(items.chunks(GRAIN), f) }
}
