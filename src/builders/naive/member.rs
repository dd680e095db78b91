//! A subtree in a cut of the auxiliary BVH, and its clipping (paper 4.4).

use super::auxiliary::{Content, Tree};
use crate::geometry::Aabb;
use std::rc::Rc;

/// A subtree in a cut, with its box clipped.
#[derive(Clone)]
pub struct Member {
    pub tree: Rc<Tree>,
    pub bounds: Aabb,
}

impl Member {
    pub fn of(tree: &Rc<Tree>) -> Self {
        Self { tree: tree.clone(), bounds: tree.bounds }
    }

    pub fn is_leaf(&self) -> bool {
        !matches!(self.tree.content, Content::Node(_))
    }

    /// What a finished leaf becomes.
    pub fn finished(&self) -> Option<&Tree> {
        if let Content::Finished(tree) = &self.tree.content { Some(tree) } else { None }
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
            Content::Finished(_) => return vec![self.clone()],
            Content::Leaf(references) => references.iter().map(|r| Self::of(&Tree::leaf(&[*r]))).collect(),
        };
        let parent = self.tree.bounds;
        children.into_iter().filter_map(|child| child.clipped(parent, clip)).collect()
    }

    /// The part inside `clip`. A box that only touches a plane from one side is on that side alone. One that lies
    /// in it is on the left, unless its parent began at the plane, so that nothing of it came to the left. Finished
    /// leaves are not cut: they are where their centroid is.
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
            let center2 = b.min[axis] + b.max[axis];
            let is_out = b.min[axis] < left_plane && center2 <= 2.0 * left_plane
                || b.max[axis] > right_plane && center2 > 2.0 * right_plane;
            if self.finished().is_some() && is_out {
                return None;
            }
        }
        if self.finished().is_some() {
            return Some(self);
        }
        Some(Self { bounds: b.intersection(*clip), ..self })
    }

    /// What `clip` leaves of the single references below; finished leaves are not opened.
    pub fn references(&self, clip: &Aabb) -> Vec<Self> {
        if self.tree.count == 1 || self.finished().is_some() {
            return vec![self.clone()];
        }
        self.open(clip).iter().flat_map(|child| child.references(clip)).collect()
    }
}
