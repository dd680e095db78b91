//! PLOC (Meister and Bittner 2018), by comparing each cluster with all within the radius.

use super::auxiliary::{Reference, Tree};
use super::wide::Wide;
use crate::builders::clusters::ploc::config::PlocConfig;
use crate::builders::lbvh::morton::MortonEncoder;
use crate::geometry::{Aabb, Mesh};
use std::rc::Rc;

/// The tree over the triangles of `mesh`, with leaves of at most four; `None` without triangles.
pub fn ploc(mesh: &Mesh, config: &PlocConfig, width: usize) -> Option<Wide> {
    clusters(mesh, config).map(|root| root.clustered(4, f32::INFINITY).widened(width))
}

/// The tree over single triangles of `mesh`; `None` without triangles.
pub fn clusters(mesh: &Mesh, config: &PlocConfig) -> Option<Rc<Tree>> {
    let all = (0..mesh.len() as u32).map(|prim| Reference { prim, bounds: mesh.bounds_of(prim) });
    let mut references: Vec<Reference> = all.collect();
    let centers = references.iter().fold(Aabb::EMPTY, |all, r| all.grow(r.bounds.center2()));
    let encoder = MortonEncoder::new(centers);
    references.sort_by_key(|reference| encoder.code(reference.bounds.center2()));
    let mut clusters: Vec<Rc<Tree>> = references.iter().map(|r| Tree::leaf(&[*r])).collect();
    let mut is_forced = false;
    while clusters.len() > 1 {
        let len = clusters.len();
        let nearest = |i: usize| if is_forced { i ^ 1 } else { nearest(&clusters, i, config.radius) };
        let nearest: Vec<usize> = (0..len).map(nearest).collect();
        let is_pair = |i: usize| nearest.get(nearest[i]) == Some(&i);
        let merged = (0..len).filter(|&i| !is_pair(i) || i < nearest[i]).map(|i| {
            if is_pair(i) {
                Tree::node(clusters[i].clone(), clusters[nearest[i]].clone())
            } else {
                clusters[i].clone()
            }
        });
        clusters = merged.collect();
        is_forced = (len - clusters.len()) * 32 < len;
    }
    clusters.pop()
}

/// The nearest of the clusters within the radius around cluster `i`: that of the least area of the common box but
/// for the lowest bits of it, then the nearest in order, then the other of a pair that begins at an even position,
/// then the later.
fn nearest(clusters: &[Rc<Tree>], i: usize, radius: usize) -> usize {
    let low = (2 * radius).next_power_of_two() as u32 - 1;
    let others = (i.saturating_sub(radius)..clusters.len().min(i + radius + 1)).filter(|&j| j != i);
    let distance = |j: usize| {
        let area = clusters[i].bounds.union(clusters[j].bounds).half_area().abs();
        let is_second = if i.abs_diff(j) == 1 { i.min(j) % 2 == 1 } else { j < i };
        (area.to_bits() & !low, i.abs_diff(j), is_second)
    };
    others.min_by_key(|&j| distance(j)).expect("there are two clusters or more")
}
