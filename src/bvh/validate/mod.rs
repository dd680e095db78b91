//! Validation of a tree: every triangle is reachable, inside its boxes, and covered.

use super::{Child, Link, MAX_DEPTH, MAX_LEAF_BLOCKS, WideBvh};
use crate::geometry::{Aabb, Mesh, Polygon};
use crate::memory::{OutOfMemory, huge_pages};
use glam::Vec3A;

/// Why a tree is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Invalid {
    /// A link leads outside the arrays, or a place is reached twice.
    #[error("{what} {index} is out of range or reached twice")]
    Link {
        /// "node" or "block".
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// A node or block is reached from nowhere.
    #[error("{what} {index} is never reached")]
    Unreached {
        /// "node" or "block".
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// More levels than traversal stacks hold.
    #[error("deeper than {MAX_DEPTH} levels")]
    TooDeep,
    /// A leaf of more blocks than any may have.
    #[error("the leaf from block {0} on has more than {MAX_LEAF_BLOCKS}")]
    LongLeaf(usize),
    /// A used slot follows an unused one, or an unused slot has a box that rays enter.
    #[error("node {0}: unused slots must come last and hold an inverted box")]
    Slots(usize),
    /// A child's box is empty, NaN, or not inside its parent's.
    #[error("node {node}, slot {slot}: box not inside its parent's")]
    Bounds {
        /// The node.
        node: usize,
        /// Its slot.
        slot: usize,
    },
    /// A block's data are not the mesh's triangle.
    #[error("block {0}: data differ from the mesh's triangle, or used lanes do not come first")]
    Block(usize),
    /// A triangle is twice in one leaf.
    #[error("triangle {0} is twice in one leaf")]
    Twice(u32),
    /// A triangle is in no leaf.
    #[error("triangle {0} is in no leaf")]
    Missing(u32),
    /// A triangle sticks out of the boxes of all leaves that hold it.
    #[error("triangle {0} is not covered by the boxes of its leaves")]
    Uncovered(u32),
    /// No memory to look at it.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

/// What memory is asked for.
pub(super) const ARRAYS: &str = "the check of a tree";

/// As many places that were not seen yet.
fn seen(len: usize) -> Result<Vec<bool>, OutOfMemory> {
    let mut seen = Vec::new();
    huge_pages::try_reserve(&mut seen, len, ARRAYS)?;
    seen.resize(len, false);
    Ok(seen)
}

impl<const N: usize> WideBvh<N> {
    /// Proves that the tree is whole over `mesh`: links form a tree that uses every node and block, boxes
    /// nest, leaf data equal the mesh, every triangle is in some leaf, at most once in each, and wherever a
    /// triangle is not wholly inside one leaf's box, its leaves' boxes cover it together.
    ///
    /// # Errors
    /// The first violation found.
    pub fn validate(&self, mesh: &Mesh) -> Result<(), Invalid> {
        self.validate_rounded(mesh, 0.0)
    }

    /// As [`WideBvh::validate`], but the boxes of a triangle's leaves may leave out as much of it as rounding its
    /// corners by `ulps` units in the last place of their largest coordinate would: for trees of others, who clip
    /// triangles without rounding outwards. Whether rays pass there is told by their hits.
    ///
    /// # Errors
    /// The first violation found.
    pub(crate) fn validate_rounded(&self, mesh: &Mesh, ulps: f32) -> Result<(), Invalid> {
        let mut walk = Walk {
            tree: self,
            mesh,
            node_seen: seen(self.nodes.len())?,
            block_seen: seen(self.blocks.len())?,
            references: Vec::new(),
        };
        huge_pages::try_reserve(&mut walk.references, mesh.len(), ARRAYS)?;
        walk.visit(self.root, self.bounds, 0)?;
        for (what, seen) in [("node", &walk.node_seen), ("block", &walk.block_seen)] {
            if let Some(index) = seen.iter().position(|seen| !seen) {
                return Err(Invalid::Unreached { what, index });
            }
        }
        covered(mesh, walk.references, ulps)
    }
}

struct Walk<'a, const N: usize> {
    tree: &'a WideBvh<N>,
    mesh: &'a Mesh,
    node_seen: Vec<bool>,
    block_seen: Vec<bool>,
    /// Every reference with its leaf's box.
    references: Vec<(u32, Aabb)>,
}

impl<const N: usize> Walk<'_, N> {
    fn visit(&mut self, link: Link, bounds: Aabb, depth: usize) -> Result<(), Invalid> {
        match link.get() {
            Child::Empty => Ok(()),
            Child::Inner(_) if depth >= MAX_DEPTH => Err(Invalid::TooDeep),
            Child::Inner(index) => {
                mark(&mut self.node_seen, "node", index)?;
                let node = &self.tree.nodes[index];
                let used = node.links.iter().take_while(|link| !link.is_empty()).count();
                if used == 0
                    || (used..N).any(|slot| !node.links[slot].is_empty() || !node.bounds(slot).is_empty())
                {
                    return Err(Invalid::Slots(index));
                }
                for slot in 0..used {
                    let child = node.bounds(slot);
                    if child.is_empty() || !bounds.contains(child) {
                        return Err(Invalid::Bounds { node: index, slot });
                    }
                    self.visit(node.links[slot], child, depth + 1)?;
                }
                Ok(())
            }
            Child::Leaf { first, count } if count > MAX_LEAF_BLOCKS => Err(Invalid::LongLeaf(first)),
            Child::Leaf { first, count } => {
                let begin = self.references.len();
                for index in first..first + count {
                    mark(&mut self.block_seen, "block", index)?;
                    if !self.tree.blocks[index].is_of(self.mesh) {
                        return Err(Invalid::Block(index));
                    }
                    if self.references.len() + 4 > self.references.capacity() {
                        let len = 2 * self.references.len() + 4;
                        huge_pages::try_reserve(&mut self.references, len, ARRAYS)?;
                    }
                    self.references.extend(self.tree.blocks[index].ids().map(|prim| (prim, bounds)));
                }
                let mut ids: Vec<u32> = self.references[begin..].iter().map(|&(prim, _)| prim).collect();
                ids.sort_unstable();
                match ids.windows(2).find(|pair| pair[0] == pair[1]) {
                    Some(pair) => Err(Invalid::Twice(pair[0])),
                    None => Ok(()),
                }
            }
        }
    }
}

/// Notes that a place is reached, the first time.
fn mark(seen: &mut [bool], what: &'static str, index: usize) -> Result<(), Invalid> {
    match seen.get_mut(index) {
        Some(seen) if !*seen => {
            *seen = true;
            Ok(())
        }
        _ => Err(Invalid::Link { what, index }),
    }
}

/// Every triangle is in some leaf and covered by the boxes of its leaves.
fn covered(mesh: &Mesh, mut references: Vec<(u32, Aabb)>, ulps: f32) -> Result<(), Invalid> {
    use rayon::slice::ParallelSliceMut;
    // A stable sort would take as much memory again.
    references.par_sort_unstable_by_key(|&(prim, _)| prim);
    let mut expected = 0;
    for group in references.chunk_by(|a, b| a.0 == b.0) {
        let prim = group[0].0;
        if prim != expected {
            return Err(Invalid::Missing(expected));
        }
        expected += 1;
        let whole = mesh.bounds_of(prim);
        let is_within_one = group.iter().any(|(_, bounds)| bounds.contains(whole));
        if !is_within_one && !covers(group, mesh.corners(prim), ulps) {
            return Err(Invalid::Uncovered(prim));
        }
    }
    if (expected as usize) < mesh.len() { Err(Invalid::Missing(expected)) } else { Ok(()) }
}

/// Whether the leaf boxes of one triangle cover it: by area, and at points spread over it (area alone could
/// count one part twice and miss another).
fn covers(group: &[(u32, Aabb)], corners: [Vec3A; 3], ulps: f32) -> bool {
    const STEPS: u32 = 9;
    let triangle = Polygon::triangle(corners);
    let ulp = f32::EPSILON * corners.iter().map(|c| c.abs().max_element()).fold(0.0, f32::max);
    let grown = |bounds: &Aabb, by: f32| Aabb::new(bounds.min - by * ulp, bounds.max + by * ulp);
    let held: f64 = group.iter().map(|(_, bounds)| triangle.clipped(grown(bounds, ulps)).area()).sum();
    // The area of the thinnest triangles is a difference of products far larger than itself, that of each part too.
    let longest = f64::from(Aabb::of_triangle(corners).extent().max_element());
    let rounding = 8.0 * f64::EPSILON * longest * longest * group.len() as f64;
    if held < triangle.area() * (1.0 - 1e-4) - rounding {
        return false;
    }
    (0..=STEPS).all(|i| {
        (0..=STEPS - i).all(|j| {
            let (u, v) = (i as f32 / STEPS as f32, j as f32 / STEPS as f32);
            let point = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
            // Points are rounded as well.
            group.iter().any(|(_, bounds)| grown(bounds, 4.0 + ulps).contains(Aabb::new(point, point)))
        })
    })
}

#[cfg(test)]
mod tests;
