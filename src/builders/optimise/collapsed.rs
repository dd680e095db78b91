//! The wide tree that was chosen, emitted top-down.

use super::tree::Tree;
use crate::builders::wide::optimal::{Choice, Choices, CollapseSource};
use crate::builders::wide::top_down::TopDown;
use crate::bvh::TriangleBlock;
use crate::geometry::Aabb;
use arrayvec::ArrayVec;
use std::marker::PhantomData;

/// A binary tree and the choices for it.
pub(super) struct CollapsedTree<'a, B = TriangleBlock> {
    /// The tree.
    pub tree: &'a Tree,
    /// The choices.
    pub choices: &'a Choices,
    block: PhantomData<fn() -> B>,
}

impl<'a, B> CollapsedTree<'a, B> {
    pub fn new(tree: &'a Tree, choices: &'a Choices) -> Self {
        Self { tree, choices, block: PhantomData }
    }
}

impl CollapseSource for Tree {
    type At = u32;

    fn half_area(&self, index: u32) -> f32 {
        self.node(index).half_area()
    }

    fn count(&self, index: u32) -> u32 {
        self.node(index).count()
    }

    fn pair(&self, index: u32) -> Option<(usize, [u32; 2])> {
        self.node(index).pair().map(|pair| (pair, [2 * pair as u32, 2 * pair as u32 + 1]))
    }
}

impl<B> CollapsedTree<'_, B> {
    fn choice(&self, index: u32) -> Option<Choice> {
        self.tree.node(index).pair().map(|pair| self.choices.of(pair))
    }

    /// Appends the triangles below node `index`: each once, though spatial splits may have brought one here twice.
    fn gather(&self, index: u32, prims: &mut Vec<u32>) {
        match self.tree.pair(index) {
            Some((_, children)) => children.into_iter().for_each(|child| self.gather(child, prims)),
            None => {
                for prim in &self.tree.prims[self.tree.node(index).run()] {
                    if !prims.contains(prim) {
                        prims.push(*prim);
                    }
                }
            }
        }
    }
}

impl<B> TopDown for CollapsedTree<'_, B> {
    type Task = u32;
    type Part = u32;
    type Scratch = ();
    type Block = B;

    fn import(&self, index: u32, (): &mut ()) -> u32 {
        index
    }

    fn export(&self, &index: &u32, (): &()) -> u32 {
        index
    }

    fn count(&self, &index: &u32) -> u32 {
        self.choice(index).map_or_else(|| self.tree.node(index).count(), Choice::count)
    }

    fn is_leaf(&self, &index: &u32) -> bool {
        self.choice(index).is_none_or(Choice::is_leaf)
    }

    fn children<const N: usize>(&self, &index: &u32, (): &mut (), children: &mut ArrayVec<u32, N>) {
        self.choices.open(self.tree, index, N, children);
    }

    fn leaf(&self, &index: &u32, prims: &mut Vec<u32>, (): &mut ()) -> Aabb {
        self.gather(index, prims);
        self.tree.node(index).bounds()
    }
}
