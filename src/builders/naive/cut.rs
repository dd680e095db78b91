//! Cuts of the auxiliary BVH (paper 4.1) and their clipping (4.4).

use super::auxiliary::{Content, Tree};
use super::subtree::Swept;
use crate::geometry::Aabb;
use glam::Vec3A;
use std::rc::Rc;

/// A subtree in a cut, with its box clipped.
#[derive(Clone)]
pub struct Member {
    pub tree: Rc<Tree>,
    pub bounds: Aabb,
}

impl Member {
    fn of(tree: &Rc<Tree>) -> Self {
        Self { tree: tree.clone(), bounds: tree.bounds }
    }

    pub fn is_leaf(&self) -> bool {
        matches!(self.tree.content, Content::Leaf(_))
    }

    /// The triangle of a single reference.
    pub fn prim(&self) -> u32 {
        match &self.tree.content {
            Content::Leaf(references) if references.len() == 1 => references[0].prim,
            _ => unreachable!("not a single reference"),
        }
    }

    /// What `clip` leaves of the children: of an inner node two subtrees, of a leaf its references.
    pub fn open(&self, clip: &Aabb) -> Vec<Self> {
        let children = match &self.tree.content {
            Content::Node(children) => children.iter().map(Self::of).collect::<Vec<_>>(),
            Content::Leaf(references) => references.iter().map(|r| Self::of(&Tree::leaf(&[*r]))).collect(),
        };
        let parent = self.tree.bounds;
        children.into_iter().filter_map(|child| child.clipped(parent, clip)).collect()
    }

    /// The part inside `clip`. A box that only touches a plane from one side is on that side alone. One that lies
    /// in it is on the left, unless its parent began at the plane, so that nothing of it came to the left.
    fn clipped(self, parent: Aabb, clip: &Aabb) -> Option<Self> {
        let b = self.bounds;
        for axis in 0..3 {
            let (left_plane, right_plane) = (clip.min[axis], clip.max[axis]);
            if b.max[axis] <= left_plane && parent.min[axis] < left_plane {
                return None;
            }
            if b.min[axis] >= right_plane && b.max[axis] > right_plane {
                return None;
            }
        }
        Some(Self { bounds: b.intersection(*clip), ..self })
    }

    /// What `clip` leaves of the single references below.
    fn references(&self, clip: &Aabb) -> Vec<Self> {
        if self.tree.count == 1 {
            return vec![self.clone()];
        }
        self.open(clip).iter().flat_map(|child| child.references(clip)).collect()
    }
}

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
