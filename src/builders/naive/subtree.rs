//! The binary tree over few references by sweeps down to blocks, as simple as it can be.

use super::member::Member;
use super::splits::unions;
use crate::builders::split::cell_order::CELLS;
use crate::builders::split::cost::Weight;
use crate::bvh::limits::SUBTREE_DEPTH;
use crate::geometry::Aabb;
use glam::Vec3A;
use std::rc::Rc;

/// A split and those below it.
pub struct SplitDown {
    pub sides: [Side; 2],
}

/// A subtree.
#[derive(Clone)]
pub struct Side {
    pub members: Vec<Member>,
    /// `None` for a block or less.
    pub below: Option<Rc<SplitDown>>,
}

/// The tree over single references.
pub fn sweep(references: Vec<Member>) -> Side {
    let centers = references.iter().fold(Aabb::EMPTY, |all, member| all.grow(member.bounds.center2()));
    let order = [0, 1, 2].map(|axis| {
        let mut order: Vec<usize> = (0..references.len()).collect();
        order.sort_by_key(|&i| step(references[i].bounds.center2(), centers, axis));
        order
    });
    side(&references, order, 0)
}

/// In which step along an axis of the centroids' bounds a centroid lies.
fn step(center: Vec3A, centers: Aabb, axis: usize) -> usize {
    let scale = CELLS as f32 * 0.999 / (centers.max[axis] - centers.min[axis]);
    if scale < f32::MAX { ((center[axis] - centers.min[axis]) * scale) as usize } else { 0 }
}

/// The subtree over references in order along each axis, below `depth` splits.
fn side(all: &[Member], order: [Vec<usize>; 3], depth: u32) -> Side {
    let members = order[0].iter().map(|&i| all[i].clone()).collect();
    if order[0].len() <= 4 {
        return Side { members, below: None };
    }
    let (axis, n) = if depth < SUBTREE_DEPTH { best(all, &order) } else { (0, order[0].len() / 2) };
    let mut on_left = vec![false; all.len()];
    order[axis][..n].iter().for_each(|&i| on_left[i] = true);
    let below = |is_left: bool| {
        let of_side = |order: &Vec<usize>| order.iter().copied().filter(|&i| on_left[i] == is_left).collect();
        side(all, order.each_ref().map(of_side), depth + 1)
    };
    Side { members, below: Some(Rc::new(SplitDown { sides: [below(true), below(false)] })) }
}

/// Axis and number of references on the left of the split of least cost.
fn best(all: &[Member], order: &[Vec<usize>; 3]) -> (usize, usize) {
    let (mut least, mut best) = (f32::INFINITY, (0, 1));
    for (axis, order) in order.iter().enumerate() {
        let sorted: Vec<Aabb> = order.iter().map(|&i| all[i].bounds).collect();
        let (left, right) = (unions(sorted.iter()), unions(sorted.iter().rev()));
        let cost = |side: &[Aabb], n: usize| side[n].half_area() * Weight::Blocks.of(n);
        for n in 1..order.len() {
            let both = cost(&left, n) + cost(&right, order.len() - n);
            if both < least {
                least = both;
                best = (axis, n);
            }
        }
    }
    best
}
