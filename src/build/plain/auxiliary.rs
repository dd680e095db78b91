//! The auxiliary BVH (paper 4.7), by bisection of sorted Morton codes.

use crate::build::lbvh::AuxiliaryConfig;
use crate::build::morton::Quantizer;
use crate::build::morton_order::MIDDLE_DEPTH;
use crate::build::presplit::presplit;
use crate::geometry::{Aabb, Mesh};
use std::rc::Rc;

/// A triangle, or a part of one, with its box.
#[derive(Clone, Copy)]
pub struct Reference {
    pub prim: u32,
    pub bounds: Aabb,
}

/// A code and its reference.
type Item = (u32, Reference);

/// A subtree.
pub struct Tree {
    pub bounds: Aabb,
    /// References below.
    pub count: u32,
    pub content: Content,
}

pub enum Content {
    Leaf(Vec<Reference>),
    Node([Rc<Tree>; 2]),
}

impl Tree {
    pub fn leaf(references: &[Reference]) -> Rc<Self> {
        let bounds = references.iter().map(|reference| reference.bounds).collect();
        let count = references.len() as u32;
        Rc::new(Self { bounds, count, content: Content::Leaf(references.to_vec()) })
    }

    fn node(left: Rc<Self>, right: Rc<Self>) -> Rc<Self> {
        let bounds = left.bounds.union(right.bounds);
        let count = left.count + right.count;
        Rc::new(Self { bounds, count, content: Content::Node([left, right]) })
    }
}

/// The tree over the triangles of `mesh`; `None` without triangles.
pub fn lbvh(mesh: &Mesh, config: &AuxiliaryConfig) -> Option<Rc<Tree>> {
    let triangles = (0..mesh.len() as u32).map(|prim| Reference { prim, bounds: mesh.bounds_of(prim) });
    let mut references: Vec<Reference> = triangles.collect();
    let mut centers: Aabb = references.iter().fold(Aabb::EMPTY, |all, r| all.grow(r.bounds.center2()));
    let pieces = config.presplit.map_or(Vec::new(), |config| presplit(mesh, mesh.bounds(), &config));
    let mut is_split = vec![false; mesh.len()];
    for piece in pieces {
        centers = centers.grow(piece.bounds.center2());
        let reference = Reference { prim: piece.prim, bounds: piece.bounds };
        // The first piece of a triangle takes its place, the others come at the end.
        if std::mem::replace(&mut is_split[piece.prim as usize], true) {
            references.push(reference);
        } else {
            references[piece.prim as usize] = reference;
        }
    }
    let quantizer = Quantizer::new(centers);
    let mut run: Vec<Item> = references.iter().map(|r| (quantizer.code(r.bounds.center2()), *r)).collect();
    run.sort_by_key(|(code, _)| *code);
    let scene = mesh.bounds().half_area();
    let is_leaf = |run: &[Item]| {
        let n = run.len() as u32;
        let bounds: Aabb = run.iter().map(|(_, reference)| reference.bounds).collect();
        n <= config.leaf
            || config.clusters.is_some_and(|c| n <= c.most && bounds.half_area() <= c.area * scene)
    };
    (!run.is_empty()).then(|| subtree(&run, 0, &is_leaf))
}

/// The subtree over a run of sorted codes that has been parted `depth` times by the middle.
fn subtree(run: &[Item], depth: u32, is_leaf: &dyn Fn(&[Item]) -> bool) -> Rc<Tree> {
    if is_leaf(run) {
        return Tree::leaf(&run.iter().map(|(_, reference)| *reference).collect::<Vec<_>>());
    }
    let different = run[0].0 ^ run[run.len() - 1].0;
    if different != 0 {
        let bit = 31 - different.leading_zeros();
        let (left, right): (Vec<_>, Vec<_>) = run.iter().partition(|(code, _)| code >> bit & 1 == 0);
        return Tree::node(subtree(&left, depth, is_leaf), subtree(&right, depth, is_leaf));
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
    let (left, right) = run.split_at(split);
    Tree::node(subtree(left, depth + 1, is_leaf), subtree(right, depth + 1, is_leaf))
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
