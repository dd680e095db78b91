//! The auxiliary BVH (paper 4.7), by bisection of sorted Morton codes.

use super::wide::Wide;
use crate::builders::lbvh::area_scale::{PART, PARTS, STRIDE};
use crate::builders::lbvh::config::{AuxiliaryConfig, Clusters};
use crate::builders::lbvh::morton::MortonEncoder;
use crate::builders::prims::presplit::Presplit;
use crate::bvh::limits::{FINISHED_LEVELS, MIDDLE_DEPTH};
use crate::geometry::{Aabb, Mesh};
use std::rc::Rc;

/// A triangle, or a part of one, with its box.
#[derive(Clone, Copy)]
pub struct Reference {
    pub prim: u32,
    pub bounds: Aabb,
}

/// A code and its reference.
pub type Item = (u32, Reference);

/// A subtree.
pub struct Tree {
    pub bounds: Aabb,
    /// References below.
    pub count: u32,
    pub content: Content,
}

pub enum Content {
    Leaf(Vec<Reference>),
    /// A leaf that becomes this tree, widened.
    Finished(Rc<Tree>),
    Node([Rc<Tree>; 2]),
}

impl Tree {
    pub fn leaf(references: &[Reference]) -> Rc<Self> {
        let bounds = references.iter().map(|reference| reference.bounds).collect();
        let count = references.len() as u32;
        Rc::new(Self { bounds, count, content: Content::Leaf(references.to_vec()) })
    }

    /// The same with wide nodes: children of largest area are opened first (paper 4.5).
    pub fn widened(&self, width: usize) -> Wide {
        let mut children = match &self.content {
            Content::Node(pair) => pair.to_vec(),
            Content::Leaf(references) => {
                let mut prims: Vec<u32> = references.iter().map(|reference| reference.prim).collect();
                prims.sort_unstable();
                prims.dedup();
                return Wide::Leaf(self.bounds, prims);
            }
            Content::Finished(tree) => return tree.packed(width),
        };
        while children.len() < width {
            let mut largest = None;
            for (i, child) in children.iter().enumerate() {
                let area = child.bounds.half_area();
                if let Content::Node(pair) = &child.content
                    && largest.as_ref().is_none_or(|(_, most, _)| area > *most)
                {
                    largest = Some((i, area, pair.clone()));
                }
            }
            let Some((i, _, pair)) = largest else { break };
            children.splice(i..=i, pair);
        }
        Wide::Node(self.bounds, children.iter().map(|child| child.widened(width)).collect())
    }

    /// The same, but children with no more leaves than a node holds are opened only if all their leaves fit beside the
    /// others. Areas are compared without their last four bits, and where they are alike by the leaves.
    pub fn packed(&self, width: usize) -> Wide {
        let Content::Node(pair) = &self.content else { return self.widened(width) };
        let mut children = pair.to_vec();
        while children.len() < width {
            let order = |child: &Rc<Self>| {
                let leaves = child.leaves();
                (child.bounds.half_area().to_bits() >> 4, if leaves <= width { leaves } else { 0 })
            };
            let mut largest: Option<(usize, &[Rc<Self>; 2])> = None;
            for (i, child) in children.iter().enumerate() {
                let leaves = child.leaves();
                let is_open = leaves > width || children.len() + leaves - 1 <= width;
                if let Content::Node(pair) = &child.content
                    && is_open
                    && largest.is_none_or(|(most, _)| order(child) > order(&children[most]))
                {
                    largest = Some((i, pair));
                }
            }
            let Some((i, pair)) = largest else { break };
            let pair = pair.clone();
            children.splice(i..=i, pair);
        }
        Wide::Node(self.bounds, children.iter().map(|child| child.packed(width)).collect())
    }

    fn leaves(&self) -> usize {
        match &self.content {
            Content::Node(children) => children.iter().map(|child| child.leaves()).sum(),
            _ => 1,
        }
    }

    /// The tree whose subtrees of at most `most` references and half `area` are leaves.
    pub fn clustered(self: Rc<Self>, most: u32, area: f32) -> Rc<Self> {
        let Content::Node([left, right]) = &self.content else { return self };
        if self.count <= most && self.bounds.half_area() <= area {
            return Self::leaf(&self.references());
        }
        Self::node(left.clone().clustered(most, area), right.clone().clustered(most, area))
    }

    /// The tree whose largest subtrees of at most `most` references and so many levels, in a cube of half `area`, are
    /// finished.
    pub fn finished(self: Rc<Self>, most: u32, area: f32) -> Rc<Self> {
        let edge = self.bounds.extent().max_element();
        if self.count <= most && 3.0 * edge * edge <= area && self.levels() <= FINISHED_LEVELS {
            return Rc::new(Self { content: Content::Finished(self.clone()), ..*self });
        }
        match &self.content {
            Content::Node([left, right]) => {
                Self::node(left.clone().finished(most, area), right.clone().finished(most, area))
            }
            _ => self,
        }
    }

    fn levels(&self) -> u32 {
        match &self.content {
            Content::Node(children) => 1 + children.iter().map(|child| child.levels()).max().unwrap_or(0),
            _ => 0,
        }
    }

    fn references(&self) -> Vec<Reference> {
        match &self.content {
            Content::Leaf(references) => references.clone(),
            Content::Finished(tree) => tree.references(),
            Content::Node(children) => children.iter().flat_map(|child| child.references()).collect(),
        }
    }

    /// The parent of two subtrees.
    pub fn node(left: Rc<Self>, right: Rc<Self>) -> Rc<Self> {
        let bounds = left.bounds.union(right.bounds);
        let count = left.count + right.count;
        Rc::new(Self { bounds, count, content: Content::Node([left, right]) })
    }
}

/// The tree over the triangles of `mesh`, and the half area that thresholds are relative to; `None` without triangles.
pub fn lbvh(mesh: &Mesh, config: &AuxiliaryConfig) -> Option<(Rc<Tree>, f32)> {
    lbvh_of(mesh, config, |run, depth| subtree(run, depth, config.auxiliary_leaf.unwrap_or(1)))
}

/// The same, of the given trees over a run of sorted codes that has been partitioned so many times by the middle.
pub fn lbvh_of(
    mesh: &Mesh,
    config: &AuxiliaryConfig,
    subtree: impl Fn(&[Item], u32) -> Rc<Tree>,
) -> Option<(Rc<Tree>, f32)> {
    let triangles = (0..mesh.len() as u32).map(|prim| Reference { prim, bounds: mesh.bounds_of(prim) });
    let mut references: Vec<Reference> = triangles.collect();
    let mut centers: Aabb = references.iter().fold(Aabb::EMPTY, |all, r| all.grow(r.bounds.center2()));
    let mut presplit = Presplit::default();
    if let Some(config) = &config.presplit {
        let info = presplit.find(mesh, config);
        presplit.split(mesh, info.bounds, config);
    }
    let mut is_split = vec![false; mesh.len()];
    for piece in presplit.fragments {
        centers = centers.grow(piece.bounds.center2());
        let reference = Reference { prim: piece.prim, bounds: piece.bounds };
        // The first piece of a triangle takes its place, the others come at the end.
        if std::mem::replace(&mut is_split[piece.prim as usize], true) {
            references.push(reference);
        } else {
            references[piece.prim as usize] = reference;
        }
    }
    let encoder = MortonEncoder::new(centers);
    let (bits, depth) = config.sort();
    let code = |reference: &Reference| encoder.code(reference.bounds.center2()) & bits.mask();
    let mut run: Vec<Item> = references.iter().map(|reference| (code(reference), *reference)).collect();
    run.sort_by_key(|(code, _)| *code);
    if run.is_empty() {
        return None;
    }
    let scene = mesh.bounds().half_area();
    let reference = config.calibration.map_or(scene, |parts| scene.min(parts * area_of_parts(&run)));
    let root = subtree(&run, depth);
    let root = match &config.clusters {
        None => root,
        Some(Clusters { most, area }) => root.clustered(*most, area * reference),
    };
    Some((root, reference))
}

/// The median half area of some references each of parts of equal length, infinite if there are not enough for one.
fn area_of_parts(run: &[Item]) -> f32 {
    let parts = PARTS.min(run.len() / PART);
    let area = |part: usize| {
        let first = part * run.len() / parts;
        let some = (first..first + PART).step_by(STRIDE);
        some.map(|i| run[i].1.bounds).collect::<Aabb>().half_area()
    };
    let mut areas: Vec<f32> = (0..parts).map(area).collect();
    areas.sort_by(f32::total_cmp);
    if parts == 0 { f32::INFINITY } else { areas[parts / 2] }
}

/// The subtree over a run of sorted codes that has been partitioned `depth` times by the middle.
fn subtree(run: &[Item], depth: u32, leaf: u32) -> Rc<Tree> {
    if run.len() <= leaf as usize {
        return Tree::leaf(&run.iter().map(|(_, reference)| *reference).collect::<Vec<_>>());
    }
    let ([left, right], depth) = partitioned(run, depth);
    Tree::node(subtree(&left, depth, leaf), subtree(&right, depth, leaf))
}

/// The two parts of a run of two or more, and how often it has been partitioned by the middle then.
pub fn partitioned(run: &[Item], depth: u32) -> ([Vec<Item>; 2], u32) {
    let different = run[0].0 ^ run[run.len() - 1].0;
    if different != 0 {
        let bit = 31 - different.leading_zeros();
        let (left, right) = run.iter().partition(|(code, _)| code >> bit & 1 == 0);
        return ([left, right], depth);
    }
    // Of one code: at the middle of the centroids' bounds.
    let mut run = run.to_vec();
    let half = run.len() / 2;
    let mut split = half;
    if run.len() > 2 && depth < MIDDLE_DEPTH {
        split = to_front(&mut run);
    }
    if split == 0 || split == run.len() {
        split = half;
    }
    let right = run.split_off(split);
    ([run, right], depth + 1)
}

/// Swaps to the front what lies before the middle of the longest edge of the centroids' bounds; returns how many.
fn to_front(run: &mut [Item]) -> usize {
    let center = |item: &Item| item.1.bounds.center2();
    let centers = run.iter().fold(Aabb::EMPTY, |all, item| all.grow(center(item)));
    let axis = centers.extent().max_position();
    let middle = centers.center()[axis];
    let mut split = 0;
    for i in 0..run.len() {
        if center(&run[i])[axis] < middle {
            run.swap(split, i);
            split += 1;
        }
    }
    split
}
