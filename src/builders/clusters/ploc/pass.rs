//! A task of a pass over the clusters: a run of them is searched and merged.

use super::nearest::{BoxPlanes, forced};
use crate::builders::binary::node::Node;
use crate::builders::lbvh::key::{MortonKey, reference};
use crate::builders::lbvh::prefetch;
use crate::builders::prims::geometry::Geometry;
use crate::builders::prims::refs::PrimRefs;
use crate::parallel::ordered_append::{Chunk, Offset};
use crate::simd::Isa;

/// Clusters of a task.
pub(super) const TASK: usize = 1 << 12;

/// A pass over the clusters.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    /// The clusters, two or more.
    pub clusters: &'a [Node],
    /// How far each looks for its nearest.
    pub radius: usize,
    /// Whether neighbours in order are merged without a search.
    pub is_forced: bool,
    /// Instructions of the search.
    pub isa: Isa,
}

/// The clusters that a task leaves, and the pairs that it makes.
#[derive(Default)]
pub(super) struct Merged {
    /// Room for one more than are kept, as of `pairs`: all are written, and what is not kept is written over.
    clusters: Vec<Node>,
    pairs: Vec<[Node; 2]>,
    /// How many clusters are kept, and how many pairs.
    kept: Offset,
    boxes: BoxPlanes,
    nearest: Vec<i16>,
}

impl Merged {
    /// Makes the clusters of a single reference each of a task.
    pub fn of_leaves<G: Geometry>(&mut self, refs: &PrimRefs<'_, G>, keys: &[MortonKey], task: usize) {
        let positions = task * TASK..keys.len().min((task + 1) * TASK);
        self.kept = [positions.len(), 0];
        self.clusters.clear();
        self.clusters.extend(positions.map(|i| {
            prefetch::ahead(refs.geometry, keys, i);
            Node::leaf(refs.bounds(reference(keys[i])), i, 1)
        }));
    }

    /// Searches and merges the clusters of a task.
    pub fn make(&mut self, pass: &Pass<'_>, task: usize) {
        let Pass { clusters, radius, .. } = *pass;
        let begin = task * TASK;
        let end = clusters.len().min(begin + TASK);
        // Whether two are each other's nearest is known if the nearest of both are.
        let first = begin as isize - radius as isize;
        if pass.is_forced {
            self.nearest.clear();
            self.nearest.extend((first..end as isize + radius as isize).map(|i| forced(i as usize)));
        } else {
            self.boxes.load(clusters, first - radius as isize, end - begin + 4 * radius);
            self.boxes.search(pass.isa, radius, &mut self.nearest);
        }
        if self.clusters.len().min(self.pairs.len()) <= end - begin {
            self.clusters.resize(end - begin + 1, Node::ZERO);
            self.pairs.resize(end - begin + 1, [Node::ZERO; 2]);
        }
        let (mut kept, mut made) = (0, 0);
        for i in begin..end {
            let at = i - begin + radius;
            let offset = self.nearest[at];
            let j = i.wrapping_add_signed(isize::from(offset));
            let is_mutual = self.nearest[at.wrapping_add_signed(isize::from(offset))] == -offset;
            // The last of an odd number has no neighbour.
            let is_merged = is_mutual & (j < clusters.len());
            let is_first = is_merged & (offset > 0);
            let [cluster, other] = [&clusters[i], &clusters[if is_merged { j } else { i }]];
            self.clusters[kept] = cluster.merged_if(is_merged, other, made);
            self.pairs[made] = [*cluster, *other];
            kept += usize::from(!is_merged | is_first);
            made += usize::from(is_first);
        }
        self.kept = [kept, made];
    }

    /// Appends the clusters and the pairs.
    pub fn append_to(&self, clusters: &mut Vec<Node>, pairs: &mut Vec<[Node; 2]>) {
        let first = pairs.len() as u32;
        let (merged, made) = self.elements();
        clusters.extend(merged.iter().map(|cluster| cluster.placed(first)));
        pairs.extend_from_slice(made);
    }
}

impl Chunk for Merged {
    type A = Node;
    type B = [Node; 2];

    fn elements(&self) -> (&[Node], &[[Node; 2]]) {
        (&self.clusters[..self.kept[0]], &self.pairs[..self.kept[1]])
    }

    #[inline]
    fn moved(cluster: &Node, [_, pairs]: Offset) -> Node {
        cluster.placed(pairs as u32)
    }

    fn clear(&mut self) {
        self.kept = [0; 2];
    }
}
