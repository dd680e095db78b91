//! A wide tree as a nested value, to compare trees by.

use crate::bvh::{Child, Link, WideBvh};
use crate::geometry::Aabb;

/// A subtree with its box.
#[derive(Debug, PartialEq)]
pub enum Wide {
    /// Triangles in ascending order.
    Leaf(Aabb, Vec<u32>),
    /// Two children or more.
    Node(Aabb, Vec<Wide>),
}

impl Wide {
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Leaf(bounds, _) | Self::Node(bounds, _) => *bounds,
        }
    }

    /// The parent of some subtrees; a lone one takes its place.
    pub fn of(mut children: Vec<Self>) -> Option<Self> {
        if children.len() < 2 {
            return children.pop();
        }
        Some(Self::Node(children.iter().map(Self::bounds).collect(), children))
    }

    /// The tree of a builder; `None` if it is empty.
    pub fn of_tree<const N: usize>(tree: &WideBvh<N>) -> Option<Self> {
        Self::of_link(tree, tree.bounds, tree.root)
    }

    fn of_link<const N: usize>(tree: &WideBvh<N>, bounds: Aabb, link: Link) -> Option<Self> {
        match link.get() {
            Child::Empty => None,
            Child::Leaf { first, count } => {
                let mut prims: Vec<u32> = tree.leaf_ids(first, count).collect();
                prims.sort_unstable();
                Some(Self::Leaf(bounds, prims))
            }
            Child::Inner(index) => {
                let children =
                    tree.nodes[index].children().filter_map(|(b, link)| Self::of_link(tree, b, link));
                let node = Self::of(children.collect());
                assert_eq!(
                    node.as_ref().map(Self::bounds),
                    Some(bounds),
                    "node {index} is bounded by its children"
                );
                node
            }
        }
    }

    /// Where the two differ first, and how.
    pub fn difference(fast: Option<&Self>, plain: Option<&Self>) -> Option<String> {
        let (Some(fast), Some(plain)) = (fast, plain) else {
            return (fast != plain).then(|| "one of the trees is empty".to_owned());
        };
        if let (Self::Node(a, fast), Self::Node(b, plain)) = (fast, plain)
            && a == b
            && fast.len() == plain.len()
        {
            return fast.iter().zip(plain).enumerate().find_map(|(i, (fast, plain))| {
                Self::difference(Some(fast), Some(plain)).map(|what| format!("{i}.{what}"))
            });
        }
        (fast != plain).then(|| format!(" {}, expected {}", fast.summary(), plain.summary()))
    }

    fn summary(&self) -> String {
        match self {
            Self::Leaf(bounds, prims) => format!("leaf {prims:?} in {bounds:?}"),
            Self::Node(bounds, children) => {
                let children: Vec<Aabb> = children.iter().map(Self::bounds).collect();
                format!("node {bounds:?} of {children:?}")
            }
        }
    }
}
