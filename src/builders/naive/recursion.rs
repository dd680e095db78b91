//! The recursion over cuts: find a split, partition, refine both sides.

use super::auxiliary::Content;
use super::cheapest::Binary;
use super::cut::Cut;
use super::member::Member;
use super::splits::{self, Plane};
use super::subtree;
use super::wide::Wide;
use crate::builders::binary::kind::Kind;
use crate::builders::phr::config::{Extensions, PhrConfig};
use crate::builders::split::cost::Weight;
use crate::builders::wide::optimal::CollapseCosts;
use crate::geometry::triangle_split::split_triangle;
use crate::geometry::{Aabb, Mesh};

/// Opens members of a side of a split, clipped to a box, at a depth.
pub type Refine<'a> = dyn Fn(Vec<Member>, &Aabb, u32) -> Vec<Member> + 'a;

/// The recursion over cuts (paper 3.2, Figure 3).
pub struct Naive<'a> {
    pub mesh: &'a Mesh,
    /// Most children of a node.
    pub width: usize,
    pub config: &'a PhrConfig,
    pub spatial_above: f32,
    pub part: u32,
    /// From this depth on, cuts are halved.
    pub cut_depth: u32,
    pub refine: &'a Refine<'a>,
}

impl Naive<'_> {
    fn extensions(&self) -> &Extensions {
        &self.config.extensions
    }

    /// Whether a cut is small, and to be split down to its leaves in one go.
    fn is_small(&self, cut: &Cut) -> bool {
        cut.count() <= self.extensions().subtree_sweep.unwrap_or(0)
            && cut.depth < self.cut_depth
            && cut.bounds().half_area() <= self.spatial_above
    }

    /// The wide tree over a cut; `None` if clipping left nothing of it.
    pub fn subtree(&self, cut: &Cut) -> Option<Wide> {
        if let [lone] = &cut.members[..]
            && let Some(finished) = lone.finished()
        {
            return Some(finished.packed(self.width));
        }
        if let Some(costs) = &self.extensions().collapse
            && cut.count() < self.part
        {
            return self.binary(cut, costs).map(|root| root.widened(self.width));
        }
        if cut.kind() != Kind::Inner {
            return leaf(cut);
        }
        Wide::of(self.children(cut).iter().filter_map(|child| self.subtree(child)).collect())
    }

    /// The binary tree over a cut; `None` if clipping left nothing of it.
    fn binary(&self, cut: &Cut, costs: &CollapseCosts) -> Option<Binary> {
        if let Some(split_down) = &cut.split_down {
            return Some(Binary::pair_split_down(split_down, costs, self.width));
        }
        if cut.kind() != Kind::Inner {
            let Wide::Leaf(bounds, prims) = leaf(cut)? else { unreachable!("a leaf") };
            return Some(Binary::leaf(bounds, prims, costs, self.width));
        }
        if self.is_small(cut) {
            let references = cut.references();
            return (!references.is_empty())
                .then(|| Binary::split_down(&subtree::sweep(references), costs, self.width));
        }
        let mut sides: Vec<Binary> =
            self.split(cut).iter().filter_map(|side| self.binary(side, costs)).collect();
        let last = sides.pop()?;
        Some(match sides.pop() {
            Some(first) => Binary::pair([first, last], costs, self.width),
            None => last,
        })
    }

    /// Up to `width` children: the largest is split first (paper 4.5). Once no inner one is left, a leaf that was
    /// made only because it is no dearer than a node is split too, as that costs no node here.
    fn children(&self, cut: &Cut) -> Vec<Cut> {
        let mut children = vec![cut.clone()];
        while children.len() < self.width {
            let largest = |kind: Kind| {
                let mut found: Option<usize> = None;
                for (i, child) in children.iter().enumerate() {
                    let area = child.bounds().half_area();
                    if child.kind() == kind && found.is_none_or(|f| area > children[f].bounds().half_area()) {
                        found = Some(i);
                    }
                }
                found
            };
            let soft = || if children.len() > 1 { largest(Kind::SoftLeaf) } else { None };
            let Some(next) = largest(Kind::Inner).or_else(soft) else { break };
            let sides = self.split(&children[next]);
            children.splice(next..=next, sides);
        }
        children
    }

    /// Splits a cut in two (paper 3.2, Figure 3): find the split, reorder, refine both sides. One of them may be
    /// clipped away, and an inner cut may be found to be a leaf.
    fn split(&self, part: &Cut) -> Vec<Cut> {
        if part.split_down.is_none() && self.is_small(part) {
            return self.split_down(part);
        }
        if let Some(split_down) = &part.split_down {
            return split_down.sides.iter().map(|side| self.side_split_down(part, side)).collect();
        }
        let cut = self.open_for_split(part.clone());
        match cut.kind() {
            _ if cut.members.is_empty() => return vec![],
            Kind::Leaf => return vec![cut],
            Kind::SoftLeaf | Kind::Inner => {}
        }
        let mut clips = [cut.clip; 2];
        let sides = match self.find(&cut) {
            Split::Spatial(plane) => {
                clips = plane.sides(cut.clip);
                let mut sides = [vec![], vec![]];
                for member in &cut.members {
                    let parts = self.parts(member, plane);
                    for (side, bounds) in sides.iter_mut().zip(parts) {
                        side.extend(bounds.map(|bounds| Member { bounds, ..member.clone() }));
                    }
                }
                sides
            }
            Split::Object(is_left) => [true, false].map(|side| {
                let members = cut.members.iter().zip(&is_left);
                members.filter(|(_, is_left)| **is_left == side).map(|(member, _)| member.clone()).collect()
            }),
            Split::Halves => {
                let (left, right) = cut.members.split_at(cut.members.len() / 2);
                [left.to_vec(), right.to_vec()]
            }
        };
        let has_finished = cut.members.iter().any(|member| member.finished().is_some());
        if part.kind() != Kind::SoftLeaf && !has_finished && self.leaf_is_cheaper(&cut, &sides) {
            return vec![Cut { is_soft: true, ..cut }];
        }
        let references: u32 = sides.iter().flatten().map(|member| member.tree.count).sum();
        let mut cuts = Vec::new();
        for (side, clip) in sides.into_iter().zip(clips) {
            let own: u32 = side.iter().map(|member| member.tree.count).sum();
            // Room for references is shared in proportion.
            let share = f64::from(cut.capacity) * f64::from(own) / f64::from(references);
            let depth = cut.depth + 1;
            let members = if cut.is_near_leaves { side } else { (self.refine)(side, &clip, depth) };
            if !members.is_empty() {
                let capacity = (share as u32).max(own);
                let is_near_leaves = cut.is_near_leaves;
                cuts.push(Cut {
                    members,
                    clip,
                    capacity,
                    depth,
                    is_near_leaves,
                    is_soft: false,
                    split_down: None,
                });
            }
        }
        cuts
    }

    /// Splits a cut of few references, none of which is to be split spatially, down to its leaves.
    fn split_down(&self, cut: &Cut) -> Vec<Cut> {
        let references = cut.references();
        if references.is_empty() {
            return vec![];
        }
        let whole = self.side_split_down(cut, &subtree::sweep(references));
        if whole.kind() == Kind::Inner { self.split(&whole) } else { vec![whole] }
    }

    /// One side of a split of such a cut.
    fn side_split_down(&self, like: &Cut, side: &subtree::Side) -> Cut {
        let subtree::Side { members, below } = side.clone();
        let mut cut = Cut { members, split_down: below, is_soft: false, clip: like.clip, ..*like };
        if let Some(below) = &cut.split_down {
            let sides = below.sides.each_ref().map(|side| side.members.clone());
            cut.is_soft = self.leaf_is_cheaper(&cut, &sides);
        }
        cut
    }

    /// Opens what has to be for a split: a lone member, and all near the leaves or in too deep a tree.
    fn open_for_split(&self, mut cut: Cut) -> Cut {
        while let [lone] = &cut.members[..]
            && !lone.is_leaf()
        {
            cut.members = lone.open(&cut.clip);
        }
        let is_lone_leaf = cut.members.len() == 1 && cut.members[0].is_leaf();
        if !cut.is_near_leaves && (is_lone_leaf || cut.depth >= self.cut_depth) {
            cut.members = cut.references();
            cut.is_near_leaves = true;
        }
        cut
    }

    fn find(&self, cut: &Cut) -> Split {
        if cut.depth >= self.cut_depth {
            return Split::Halves;
        }
        let boxes: Vec<Aabb> = cut.members.iter().map(|member| member.bounds).collect();
        let weight = if cut.is_near_leaves { Weight::Blocks } else { Weight::Nodes };
        let counts: Vec<usize> = cut
            .members
            .iter()
            .map(|member| match self.extensions().triangle_counts && !cut.is_near_leaves {
                true => member.tree.count as usize,
                false => 1,
            })
            .collect();
        let object = splits::object(&boxes, &counts, weight);
        let area = cut.bounds().half_area();
        if area > self.spatial_above
            && let Some((cost, plane)) = splits::spatial(&boxes, &counts, weight)
            && cost < area * weight.of(counts.iter().sum())
        {
            let is_preferred = object.as_ref().is_none_or(|object| cost < object.cost);
            let counted = |member: &Member| {
                let sides = plane.cut(member.bounds).iter().flatten().count();
                sides as u64 * u64::from(member.tree.count)
            };
            let references = cut.members.iter().map(counted).sum::<u64>();
            let both =
                |side: usize| cut.members.iter().any(|member| self.parts(member, plane)[side].is_some());
            // Finished leaves, which are not cut, may all be on one side.
            let splits = both(0) && both(1) || cut.members.iter().all(|member| member.finished().is_none());
            if is_preferred && splits && references <= u64::from(cut.capacity) {
                return Split::Spatial(plane);
            }
        }
        object.map_or(Split::Halves, |object| Split::Object(object.is_left))
    }

    /// What of a member's box is on both sides of a plane; of a single triangle perhaps the boxes of its parts.
    fn parts(&self, member: &Member, plane: Plane) -> [Option<Aabb>; 2] {
        let parts = plane.cut(member.bounds);
        if member.finished().is_some() && parts.iter().all(Option::is_some) {
            let is_right = member.bounds.center2()[plane.axis] > 2.0 * plane.at;
            return [(!is_right).then_some(member.bounds), is_right.then_some(member.bounds)];
        }
        if let ([Some(_), Some(_)], true, Content::Leaf(references)) =
            (parts, self.extensions().clip_triangles, &member.tree.content)
            && let [reference] = references[..]
        {
            let corners = self.mesh.corners(reference.prim);
            let halves = split_triangle(&corners, member.bounds, plane.axis, plane.at);
            return halves.map(|half| (!half.is_empty()).then_some(half));
        }
        parts
    }

    /// Whether a leaf costs no more than a node over two leaves: a leaf costs its blocks, a node one.
    fn leaf_is_cheaper(&self, cut: &Cut, sides: &[Vec<Member>; 2]) -> bool {
        let leaf = |members: &[Member]| {
            let bounds: Aabb = members.iter().map(|member| member.bounds).collect();
            let count: u32 = members.iter().map(|member| member.tree.count).sum();
            bounds.half_area() * count.div_ceil(4) as f32
        };
        let node = cut.bounds().half_area() + (leaf(&sides[0]) + leaf(&sides[1]));
        cut.count() <= self.config.leaf_size() && leaf(&cut.members) <= node
    }
}

/// How a cut is split.
enum Split {
    /// At a plane.
    Spatial(Plane),
    /// By membership in the left side.
    Object(Vec<bool>),
    /// In the middle of the order of the Morton codes.
    Halves,
}

/// A leaf of what is left of the references of a cut.
fn leaf(cut: &Cut) -> Option<Wide> {
    let references = cut.references();
    let bounds = references.iter().map(|member| member.bounds).collect();
    let mut prims: Vec<u32> = references.iter().map(Member::prim).collect();
    prims.sort_unstable();
    prims.dedup();
    (!prims.is_empty()).then_some(Wide::Leaf(bounds, prims))
}
