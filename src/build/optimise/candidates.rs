//! Which nodes may look for better places: those that promise most.

use super::tree::{ROOT, Tree};
use rayon::prelude::*;

/// Pairs per task.
const CHUNK: usize = 1 << 13;
/// Low bits of an area's pattern that are not told apart.
const SHIFT: u32 = 19;
const BUCKETS: usize = 1 << (31 - SHIFT);

impl Tree {
    /// The `wanted` nodes of the highest promise, in order of index within two classes.
    pub fn candidates(&self, wanted: usize) -> Vec<u32> {
        let mut histogram = (0..self.pairs.len())
            .into_par_iter()
            .step_by(CHUNK)
            .map(|begin| {
                let mut histogram = vec![0u32; BUCKETS];
                self.each_promise(begin, |_, bucket| histogram[bucket] += 1);
                histogram
            })
            .reduce(
                Vec::new,
                |a, b| if a.is_empty() { b } else { a.iter().zip(&b).map(|(a, b)| a + b).collect() },
            );
        histogram.resize(BUCKETS, 0);
        // Buckets above `last` are taken whole, of this one the first.
        let (mut last, mut above) = (BUCKETS - 1, 0);
        while last > 1 && above + (histogram[last] as usize) < wanted {
            above += histogram[last] as usize;
            last -= 1;
        }
        let of = |wanted: &(dyn Fn(usize) -> bool + Sync)| -> Vec<u32> {
            (0..self.pairs.len())
                .into_par_iter()
                .step_by(CHUNK)
                .flat_map_iter(|begin| {
                    let mut found = Vec::new();
                    self.each_promise(begin, |index, bucket| {
                        if wanted(bucket) {
                            found.push(index)
                        }
                    });
                    found
                })
                .collect()
        };
        let mut candidates = of(&|bucket| bucket > last);
        let mut more = of(&|bucket| bucket == last);
        more.truncate(wanted.saturating_sub(above));
        candidates.append(&mut more);
        candidates
    }

    /// Gives `take` the nodes of a chunk of pairs with the bucket of what moving them could gain: at most the
    /// parent's area less their own, but for what ancestors shrink.
    fn each_promise(&self, begin: usize, mut take: impl FnMut(u32, usize)) {
        let end = (begin + CHUNK).min(self.pairs.len());
        for (index, pair) in (begin..end).zip(&self.pairs[begin..end]) {
            let first = 2 * index as u32;
            if index == 0 || !pair.is_used() {
                continue;
            }
            let parent = self.parent(first);
            let node = self.node(parent);
            if parent == ROOT || node.open_pair().is_none() {
                continue;
            }
            let area = node.half_area();
            for (half, child) in pair.0.iter().enumerate() {
                let promise = (area - child.half_area()).max(0.0);
                if promise > 0.0 {
                    take(first + half as u32, (promise.to_bits() >> SHIFT) as usize);
                }
            }
        }
    }
}
