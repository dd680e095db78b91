//! Cuts of the auxiliary BVH (paper 4.1).

use super::auxiliary::{Content, Tree};
use super::member::Member;
use super::subtree::Swept;
use crate::geometry::Aabb;
use glam::Vec3A;
use std::rc::Rc;

/// What becomes of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Inner,
    /// A leaf of several blocks.
    SoftLeaf,
    /// A leaf of one block.
    Leaf,
}

/// A cut, in the order of the Morton codes.
#[derive(Clone)]
pub struct Cut {
    pub members: Vec<Member>,
    /// What spatial splits above have left of space.
    pub clip: Aabb,
    /// Most references below.
    pub capacity: u32,
    /// Binary splits above.
    pub depth: u32,
    /// The members are single references.
    pub is_near_leaves: bool,
    /// A leaf was found to be no dearer than a split.
    pub is_soft: bool,
    /// How it is split, where it is split down to leaves.
    pub swept: Option<Rc<Swept>>,
}

impl Cut {
    /// The whole scene.
    pub fn whole(members: Vec<Member>, max_references: f32, most: usize) -> Self {
        let clip = Aabb::new(Vec3A::NEG_INFINITY, Vec3A::INFINITY);
        let mut cut =
            Self { members, clip, capacity: 0, depth: 0, is_near_leaves: false, is_soft: false, swept: None };
        cut.capacity = ((cut.count() as f32 * max_references) as u32).min(most as u32).max(cut.count());
        cut
    }

    pub fn bounds(&self) -> Aabb {
        self.members.iter().map(|member| member.bounds).collect()
    }

    /// References below, those clipped away in the members included.
    pub fn count(&self) -> u32 {
        self.members.iter().map(|member| member.tree.count).sum()
    }

    pub fn kind(&self) -> Kind {
        match self.count() {
            ..=4 => Kind::Leaf,
            _ if self.is_soft => Kind::SoftLeaf,
            _ => Kind::Inner,
        }
    }

    /// What is left of the single references below.
    pub fn references(&self) -> Vec<Member> {
        self.members.iter().flat_map(|member| member.references(&self.clip)).collect()
    }
}

/// The initial cut: of the nodes larger than `threshold` (half area) the largest is opened, and of equal ones the
/// first, while there are fewer than `max_len`. A lone root is opened whatever its size.
pub fn initial(root: Rc<Tree>, threshold: f32, max_len: usize) -> Vec<Member> {
    // In depth-first order.
    let mut cut = vec![Member::of(&root)];
    while cut.len() < max_len {
        let is_lone = cut.len() == 1;
        let area = |i: usize| cut[i].bounds.half_area();
        let openable = (0..cut.len()).filter(|&i| !cut[i].is_leaf() && (area(i) > threshold || is_lone));
        let Some(next) = openable.reduce(|a, b| if area(b) > area(a) { b } else { a }) else { break };
        let Content::Node(children) = &cut[next].tree.clone().content else { unreachable!("an inner node") };
        cut.splice(next..=next, children.iter().map(Member::of));
    }
    cut
}
