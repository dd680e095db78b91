//! The cheapest wide tree over the binary splits of a part, as simple as it can be.

use super::member::Member;
use super::subtree::{Side, SplitDown};
use super::wide::Wide;
use crate::builders::wide::optimal::CollapseCosts;
use crate::geometry::Aabb;

/// A binary tree, with what it costs as at most one, two, ... children of a wide node, but not all.
pub struct Binary {
    bounds: Aabb,
    count: u32,
    costs: Vec<f32>,
    content: Content,
}

enum Content {
    /// Triangles, some of which may be here twice.
    Leaf(Vec<u32>),
    /// Two subtrees, and whether they are better together in a leaf.
    Pair(Box<[Binary; 2]>, bool),
}

impl Binary {
    /// Up to four triangles.
    pub fn leaf(bounds: Aabb, prims: Vec<u32>, costs: &CollapseCosts, width: usize) -> Self {
        let cost = bounds.half_area() * (costs.leaf + costs.block * 1.0);
        Self {
            bounds,
            count: prims.len() as u32,
            costs: vec![cost; width - 1],
            content: Content::Leaf(prims),
        }
    }

    /// A subtree made by sweeps.
    pub fn split_down(side: &Side, costs: &CollapseCosts, width: usize) -> Self {
        match &side.below {
            Some(below) => Self::pair_split_down(below, costs, width),
            None => {
                let bounds = side.members.iter().map(|member| member.bounds).collect();
                Self::leaf(bounds, side.members.iter().map(Member::prim).collect(), costs, width)
            }
        }
    }

    /// Two subtrees made by a sweep.
    pub fn pair_split_down(below: &SplitDown, costs: &CollapseCosts, width: usize) -> Self {
        Self::pair(below.sides.each_ref().map(|side| Self::split_down(side, costs, width)), costs, width)
    }

    /// The parent of two subtrees.
    pub fn pair(pair: [Self; 2], costs: &CollapseCosts, width: usize) -> Self {
        let bounds: Aabb = pair.iter().map(|side| side.bounds).collect();
        let count = pair[0].count + pair[1].count;
        let area = bounds.half_area();
        let blocks = count.div_ceil(4) as f32;
        let leaf = area * (costs.leaf + costs.block * blocks);
        let inner = area * costs.node + opened(&pair, width).0;
        let is_leaf = count <= costs.max_leaf && leaf <= inner && leaf < f32::INFINITY;
        let mut fewer = vec![if is_leaf { leaf } else { inner }];
        for slots in 2..width {
            fewer.push(fewer[slots - 2].min(opened(&pair, slots).0));
        }
        Self { bounds, count, costs: fewer, content: Content::Pair(Box::new(pair), is_leaf) }
    }

    /// As a wide tree.
    pub fn widened(&self, width: usize) -> Wide {
        match &self.content {
            Content::Pair(pair, false) => {
                let mut children = Vec::new();
                let left = opened(pair, width).1;
                pair[0].children(left, width, &mut children);
                pair[1].children(width - left, width, &mut children);
                Wide::of(children).expect("there are two at least")
            }
            _ => {
                let mut prims = Vec::new();
                self.gather(&mut prims);
                prims.sort_unstable();
                prims.dedup();
                Wide::Leaf(self.bounds, prims)
            }
        }
    }

    /// Appends what is to be at most `slots` children of a wide node.
    fn children(&self, slots: usize, width: usize, children: &mut Vec<Wide>) {
        match &self.content {
            Content::Pair(..) if slots > 1 && self.costs[slots - 1] >= self.costs[slots - 2] => {
                self.children(slots - 1, width, children);
            }
            Content::Pair(pair, _) if slots > 1 => {
                let left = opened(pair, slots).1;
                pair[0].children(left, width, children);
                pair[1].children(slots - left, width, children);
            }
            _ => children.push(self.widened(width)),
        }
    }

    fn gather(&self, prims: &mut Vec<u32>) {
        match &self.content {
            Content::Leaf(own) => prims.extend(own),
            Content::Pair(pair, _) => pair.iter().for_each(|side| side.gather(prims)),
        }
    }
}

/// The least cost of two subtrees as `slots` children, and how many of these are on the left: the fewest, of equal
/// ones.
fn opened([left, right]: &[Binary; 2], slots: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for on_left in 1..slots {
        let cost = left.costs[on_left - 1] + right.costs[slots - on_left - 1];
        if cost < best.0 {
            best = (cost, on_left);
        }
    }
    best
}
