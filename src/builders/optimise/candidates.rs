//! Which nodes may look for better places: those that promise most and have not looked in vain.

use super::tree::{ROOT, Tree};
use crate::memory::huge_pages;
use crate::parallel;

/// Pairs per task.
const CHUNK: usize = 1 << 14;
/// Low bits of an area's pattern that are not told apart.
const SHIFT: u32 = 19;
const BUCKETS: usize = 1 << (31 - SHIFT);

/// Nodes that promise most, and the memory to find them.
#[derive(Default)]
pub(crate) struct Candidates {
    /// The nodes, by index.
    pub nodes: Vec<u32>,
    /// The bucket of what moving each node could gain; 0 for nothing.
    promises: Vec<[u16; 2]>,
}

impl Candidates {
    /// Finds the `wanted` nodes of `tree` of the highest promise among those not `tried`.
    pub fn find(&mut self, tree: &Tree, tried: &[bool], wanted: usize) {
        huge_pages::resize(&mut self.promises, tree.pairs.len(), [0; 2], "gains of nodes");
        let histograms = parallel::map(self.promises.chunks_mut(CHUNK).enumerate(), |(chunk, promises)| {
            let mut histogram = vec![0u32; BUCKETS];
            for (pair, promises) in (chunk * CHUNK..).zip(promises) {
                *promises = tree.promises(pair, tried);
                promises.iter().for_each(|&bucket| histogram[bucket as usize] += 1);
            }
            histogram
        });
        let mut histogram = vec![0; BUCKETS];
        for one in &histograms {
            histogram.iter_mut().zip(one).for_each(|(all, count)| *all += count);
        }
        // Buckets above `last` are taken whole, of this one the first.
        let (mut last, mut above) = (BUCKETS - 1, 0);
        while last > 1 && above + (histogram[last] as usize) < wanted {
            above += histogram[last] as usize;
            last -= 1;
        }
        let found: Vec<Vec<u32>> =
            parallel::map(self.promises.chunks(CHUNK).enumerate(), |(chunk, promises)| {
                let indices = (2 * CHUNK * chunk) as u32..;
                let found =
                    indices.zip(promises.iter().flatten()).filter(|(_, bucket)| **bucket as usize >= last);
                found.map(|(index, _)| index).collect()
            });
        let mut room = wanted.saturating_sub(above);
        self.nodes.clear();
        let most = found.iter().map(Vec::len).sum();
        huge_pages::reserve(&mut self.nodes, most, "promising nodes");
        for index in found.into_iter().flatten() {
            let is_last = self.promises[index as usize / 2][index as usize % 2] as usize == last;
            if !is_last || room > 0 {
                room -= usize::from(is_last);
                self.nodes.push(index);
            }
        }
    }
}

impl Tree {
    /// The buckets of what moving the nodes of a pair could gain: at most the parent's area less their own, but for
    /// what ancestors shrink.
    #[inline]
    fn promises(&self, pair: usize, tried: &[bool]) -> [u16; 2] {
        let parent = self.parent(2 * pair as u32);
        // Pair 0 is the root's, whose parent is not asked for either.
        if parent == ROOT {
            return [0; 2];
        }
        let area = self.node(parent).half_area();
        [0, 1].map(|half| {
            let promise = (area - self.pairs[pair].0[half].half_area()).max(0.0);
            if tried[2 * pair + half] { 0 } else { (promise.to_bits() >> SHIFT) as u16 }
        })
    }
}
