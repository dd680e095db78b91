//! Binary trees that were made elsewhere, widened by our collapse (paper 4.5): subtrees of at most four triangles
//! become a leaf of one block, larger leaves stay as they are, in several blocks.

use super::binary_source::{BinarySource, Leaves};
use super::treelet::WideTreelet;
use crate::builders::binary::kind::Kind;
use crate::builders::binary::node::{Node, NodeRun};
use crate::builders::binary::subtrees::Subtrees;
use crate::bvh::limits::{BLOCK, MAX_LEAF, MAX_WIDTH};
use crate::bvh::{MAX_DEPTH, WideBvh};
use crate::geometry::{Aabb, Mesh};

/// Levels after which a binary tree is given up: a node of eight children takes the place of at most seven levels, so
/// that the wide tree would be too deep too.
const MOST_LEVELS: u32 = (MAX_DEPTH * (MAX_WIDTH - 1)) as u32;

/// A binary tree over the triangles of a mesh.
pub trait ForeignTree {
    /// Tells a node.
    type At: Copy;

    /// The root; `None` without triangles.
    fn root(&self) -> Option<Self::At>;

    /// The children of an inner node, in order, or the triangles of a leaf, which are appended to `prims`, with
    /// their box.
    fn open(&self, at: Self::At, prims: &mut Vec<u32>) -> Opened<Self::At>;

    /// Whether a triangle may be in several leaves.
    fn may_repeat(&self) -> bool;
}

/// A node of a [`ForeignTree`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Opened<At> {
    /// An inner node over two children.
    Children([At; 2]),
    /// A leaf with its box.
    Leaf(Aabb),
}

/// The wide tree of a binary one over `mesh`; a box is that around the leaves below.
///
/// # Errors
/// A leaf that is too large or of triangles that the mesh lacks, a tree that is too deep or does not hold every
/// triangle, in one line.
pub fn widened<const N: usize>(tree: &impl ForeignTree, mesh: &Mesh) -> Result<WideBvh<N>, String> {
    let mut subtrees = Subtrees::default();
    let Some(root) = tree.root() else { return Ok(WideBvh::default()) };
    let Some(root) = copied((tree, mesh), root, 0, &mut subtrees)? else { return Ok(WideBvh::default()) };
    let mut treelet = WideTreelet::<N>::default();
    let leaves = Leaves { geometry: mesh, max_leaf: MAX_LEAF, may_repeat: tree.may_repeat() };
    let (source, run) = (Foreign(&subtrees), NodeRun { node: root, first: 0 });
    let kind = source.kind(&run, MAX_LEAF);
    let subtree = source.emit((&run, kind), MOST_LEVELS, &leaves, &mut treelet, &mut 0);
    let (bounds, root) = subtree.flatten().ok_or("the tree is empty or too deep to be widened")?;
    let wide = WideBvh { root, bounds, nodes: treelet.nodes, blocks: treelet.blocks };
    // Where triangles are clipped, few crates round outwards.
    let ulps = if tree.may_repeat() { 4.0 } else { 0.0 };
    wide.validate_rounded(mesh, ulps)
        .map_err(|invalid| format!("its tree, widened, is not whole: {invalid}"))?;
    Ok(wide)
}

/// Appends the subtree below a node of a tree over a mesh.
fn copied<T: ForeignTree>(
    (tree, mesh): (&T, &Mesh),
    at: T::At,
    level: u32,
    subtrees: &mut Subtrees,
) -> Result<Option<Node>, String> {
    let first = subtrees.prims.len();
    match tree.open(at, &mut subtrees.prims) {
        Opened::Children(_) if level == MOST_LEVELS => Err(format!("its tree has more than {level} levels")),
        Opened::Children([left, right]) => {
            // What it may have told of triangles is none of a leaf's.
            subtrees.prims.truncate(first);
            let left = copied((tree, mesh), left, level + 1, subtrees)?;
            let right = copied((tree, mesh), right, level + 1, subtrees)?;
            Ok(subtrees.merge([left, right]))
        }
        Opened::Leaf(bounds) => match subtrees.prims.get(first..).unwrap_or_default() {
            [] => Ok(None),
            prims if prims.len() > MAX_LEAF as usize => {
                Err(format!("a leaf of its tree has {} triangles, ours at most {MAX_LEAF}", prims.len()))
            }
            prims => match prims.iter().find(|&&prim| prim as usize >= mesh.len()) {
                Some(prim) => {
                    Err(format!("a leaf of its tree has triangle {prim}, the mesh only {}", mesh.len()))
                }
                None => Ok(Some(Node::leaf(bounds, first, prims.len() as u32))),
            },
        },
    }
}

/// A tree whose leaves stay whole.
struct Foreign<'a>(&'a Subtrees);

impl BinarySource for Foreign<'_> {
    fn children(&self, run: &NodeRun) -> [NodeRun; 2] {
        BinarySource::children(self.0, run)
    }

    fn prim(&self, position: usize) -> u32 {
        self.0.prims[position]
    }

    fn kind(&self, run: &NodeRun, _: u32) -> Kind {
        if run.node.is_leaf() || run.node.count() <= BLOCK { Kind::Leaf } else { Kind::Inner }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::testing::soup;
    use crate::bvh::{Child, sah_cost};

    /// Halves of runs down to leaves of some triangles; the depth is endless for leaves of none.
    struct Halves<'a>(&'a Mesh, usize);

    impl ForeignTree for Halves<'_> {
        type At = (usize, usize);

        fn root(&self) -> Option<(usize, usize)> {
            (!self.0.is_empty()).then_some((0, self.0.len()))
        }

        fn open(&self, (first, len): (usize, usize), prims: &mut Vec<u32>) -> Opened<(usize, usize)> {
            if len > self.1 {
                let half = len / 2;
                return Opened::Children([(first, half), (first + half, len - half)]);
            }
            prims.extend(first as u32..(first + len) as u32);
            Opened::Leaf((first..first + len).map(|prim| self.0.bounds_of(prim as u32)).collect())
        }

        fn may_repeat(&self) -> bool {
            false
        }
    }

    #[test]
    fn leaves_become_blocks_and_large_ones_stay_whole() {
        let mesh = soup(1000, 0.1, 1);
        for leaf in [1, 4, 8, 28] {
            let tree = widened::<8>(&Halves(&mesh, leaf), &mesh).unwrap();
            assert!(sah_cost(&tree) > 1.0);
            // Halved, a thousand is 125 or fewer at each level below.
            let blocks = tree.nodes.iter().flat_map(|node| node.children()).filter_map(|(_, link)| {
                if let Child::Leaf { count, .. } = link.get() { Some(count) } else { None }
            });
            let largest = [1, 1, 2, 4][[1, 4, 8, 28].iter().position(|&of| of == leaf).unwrap()];
            assert_eq!(blocks.max(), Some(largest), "{leaf}");
        }
        assert_eq!(widened::<4>(&Halves(&soup(0, 0.1, 1), 1), &soup(0, 0.1, 1)), Ok(WideBvh::default()));
    }

    #[test]
    fn what_cannot_be_widened_is_refused() {
        let mesh = soup(100, 0.1, 1);
        let error = widened::<4>(&Halves(&mesh, 100), &mesh).unwrap_err();
        assert_eq!(error, "a leaf of its tree has 100 triangles, ours at most 28");
        let error = widened::<4>(&Halves(&mesh, 0), &mesh).unwrap_err();
        assert_eq!(error, "its tree has more than 560 levels");
        let error = widened::<4>(&Halves(&mesh, 4), &soup(99, 0.1, 1)).unwrap_err();
        assert_eq!(error, "a leaf of its tree has triangle 99, the mesh only 99");
        let larger = soup(101, 0.1, 1);
        let error = widened::<4>(&Halves(&mesh, 4), &larger).unwrap_err();
        assert!(
            error.starts_with("its tree, widened, is not whole: ") && error.lines().count() == 1,
            "{error}"
        );
    }
}
