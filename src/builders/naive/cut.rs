//! Cuts of the auxiliary BVH (paper 4.1).

use super::auxiliary::{Content, Tree};
use super::member::Member;
use super::subtree::SplitDown;
use crate::builders::binary::kind::Kind;
use crate::builders::phr::initial_cut::by_definition;
use crate::geometry::Aabb;
use glam::Vec3A;
use std::rc::Rc;

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
    pub split_down: Option<Rc<SplitDown>>,
}

impl Cut {
    /// The whole scene.
    pub fn whole(members: Vec<Member>, max_references: f32, most: usize) -> Self {
        let clip = Aabb::new(Vec3A::NEG_INFINITY, Vec3A::INFINITY);
        let mut cut = Self {
            members,
            clip,
            capacity: 0,
            depth: 0,
            is_near_leaves: false,
            is_soft: false,
            split_down: None,
        };
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
        match &self.members[..] {
            [lone] if lone.finished().is_some() => return Kind::Leaf,
            members if members.iter().any(|member| member.finished().is_some()) => return Kind::Inner,
            _ => {}
        }
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

/// The initial cut, by half areas.
pub fn initial(root: &Rc<Tree>, threshold: f32, max_len: usize) -> Vec<Member> {
    let area = |member: &Member| member.bounds.half_area();
    by_definition(Member::of(root), threshold, max_len, area, |member| match &member.tree.content {
        Content::Node(children) => Some(children.each_ref().map(Member::of)),
        Content::Leaf(_) | Content::Finished(_) => None,
    })
}
