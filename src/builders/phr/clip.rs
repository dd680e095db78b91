//! Clipping of cuts by the planes of spatial splits (paper 4.4): the pieces of a node of the cut, and which child of an
//! opened node belongs to which side of a plane. Finished leaves are never cut: they are on the side of their centroid.

use crate::builders::binary::node::Node;
use crate::builders::binary::tree::BinaryTree;
use crate::builders::split::spatial::split::SpatialSplit;
use crate::geometry::Aabb;

/// The pieces of a node of the cut on both sides of a spatial split; `of_primitive` clips the primitive in it by the
/// plane, where that is wanted, instead of its box.
#[inline]
pub(super) fn pieces(
    node: &Node,
    split: &SpatialSplit,
    of_primitive: Option<impl FnOnce() -> [Aabb; 2]>,
) -> [Option<Node>; 2] {
    let bounds = node.bounds();
    if node.is_finished() {
        return split.sides_of_whole(bounds).map(|is_there| is_there.then_some(*node));
    }
    let sides = [split.on_left(bounds), split.on_right(bounds)];
    let pieces = match of_primitive {
        Some(of_primitive) if sides == [true; 2] => of_primitive(),
        _ => [split.left_of(bounds), split.right_of(bounds)],
    };
    // The primitive may be on one side only of a plane through its box.
    [0, 1].map(|side| (sides[side] && !pieces[side].is_empty()).then(|| node.with_bounds(pieces[side])))
}

/// Which boxes of a node's children reach into a clip box.
///
/// A box that merely touches a split plane from one side belongs to that side alone. A box in the plane is left; it is
/// right only if its parent starts at the plane. Else an axis-aligned wall in the plane would be on both sides, or on
/// neither.
pub(super) struct Clipper<'a> {
    pub clip: &'a Aabb,
    pub parent: Aabb,
}

impl Clipper<'_> {
    /// The part of a box that reaches into the clip box.
    #[inline]
    pub fn clip(&self, b: Aabb) -> Option<Aabb> {
        let clip = self.clip;
        // Right of a split plane (clip.min): a box that ends there is on the left, if the parent was there at all.
        let left_of = b.max.cmple(clip.min) & self.parent.min.cmplt(clip.min);
        // Left of a split plane (clip.max): a box that begins there and goes on is on the right.
        let right_of = b.min.cmpge(clip.max) & b.max.cmpgt(clip.max);
        (!(left_of | right_of).any()).then(|| b.intersection(*clip))
    }

    /// Whether a box that is not cut belongs into the clip box: its centroid tells on which side of a plane it is.
    fn keeps_whole(&self, b: Aabb) -> bool {
        let Self { clip, .. } = self;
        let left_of = b.min.cmplt(clip.min) & b.center2().cmple(2.0 * clip.min);
        let right_of = b.max.cmpgt(clip.max) & b.center2().cmpgt(2.0 * clip.max);
        !(left_of | right_of).any() && self.clip(b).is_some()
    }
}

/// Whether a node of a cut lies wholly within the clip box, so that nothing below it is clipped: strictly, as
/// a box cut by a face ends there.
#[inline]
pub(crate) fn is_whole(node: &Node, clip: &Aabb) -> bool {
    is_inside(node.bounds(), clip)
}

/// Whether a box lies strictly within the clip box.
#[inline]
pub(crate) fn is_inside(bounds: Aabb, clip: &Aabb) -> bool {
    (bounds.min.cmpgt(clip.min) & bounds.max.cmplt(clip.max)).all()
}

/// Opens an inner node: gives `take` the children that reach into `clip`, their boxes clipped.
#[inline]
pub(crate) fn open(tree: &BinaryTree, node: &Node, clip: &Aabb, mut take: impl FnMut(Node)) {
    let children = tree.children(node);
    if is_whole(node, clip) {
        take(children[0]);
        take(children[1]);
        return;
    }
    let clipper = Clipper { clip, parent: children[0].bounds().union(children[1].bounds()) };
    for child in children {
        if child.is_finished() {
            if clipper.keeps_whole(child.bounds()) {
                take(*child);
            }
        } else if let Some(bounds) = clipper.clip(child.bounds()) {
            take(child.with_bounds(bounds));
        }
    }
}
