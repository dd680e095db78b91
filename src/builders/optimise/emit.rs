//! The wide tree that was chosen, emitted.

use super::choices::{Choice, Choices};
use super::tree::{ROOT, Tree};
use crate::builders::prims::refs::References;
use crate::builders::wide::top_down::{self, Kind, Memory, TopDown, WIDTH};
use crate::bvh::Bvh4;
use crate::geometry::{Aabb, Mesh};
use arrayvec::ArrayVec;

/// A binary tree and what was chosen for it.
pub(crate) struct Collapse<'a> {
    /// The tree.
    pub tree: &'a Tree,
    /// The choices.
    pub choices: &'a Choices,
}

impl Collapse<'_> {
    /// The wide tree.
    pub fn emit(&self, mesh: &Mesh, memory: &mut Memory<()>) -> Bvh4 {
        top_down::build(self, Some(ROOT), &References { mesh, fragments: &[] }, memory)
    }

    fn choice(&self, index: u32) -> Option<(u32, Choice)> {
        self.tree.node(index).pair().map(|pair| (pair as u32, self.choices.of(pair)))
    }

    /// Opens node `index` into up to `slots` children.
    fn open(&self, index: u32, slots: usize, children: &mut ArrayVec<u32, WIDTH>) {
        match self.choice(index) {
            Some((pair, choice)) if slots > 1 => match choice.left(slots) {
                0 => self.open(index, slots - 1, children),
                left => {
                    self.open(2 * pair, left, children);
                    self.open(2 * pair + 1, slots - left, children);
                }
            },
            _ => children.push(index),
        }
    }

    /// Appends the triangles below node `index`: each once, though spatial splits may have brought one here twice.
    fn gather(&self, index: u32, ids: &mut Vec<u32>) {
        let node = self.tree.node(index);
        match node.pair() {
            Some(pair) => {
                self.gather(2 * pair as u32, ids);
                self.gather(2 * pair as u32 + 1, ids);
            }
            None => {
                for prim in &self.tree.prims[node.run()] {
                    if !ids.contains(prim) {
                        ids.push(*prim);
                    }
                }
            }
        }
    }
}

impl TopDown for Collapse<'_> {
    type Seed = u32;
    type Part = u32;
    type Scratch = ();
    type Mark = usize;

    fn plant(&self, index: u32, (): &mut ()) -> u32 {
        index
    }

    fn lift(&self, &index: &u32, (): &()) -> u32 {
        index
    }

    fn approach(&self, _: &u32, (): &()) {}

    fn count(&self, &index: &u32) -> u32 {
        self.choice(index).map_or_else(|| self.tree.node(index).count(), |(_, choice)| choice.count())
    }

    fn half_area(&self, &index: &u32) -> f32 {
        self.tree.node(index).half_area()
    }

    fn kind(&self, &index: &u32) -> Kind {
        if self.choice(index).is_none_or(|(_, choice)| choice.is_leaf()) { Kind::Leaf } else { Kind::Inner }
    }

    fn split(&self, _: &u32, (): &mut ()) -> [Option<u32>; 2] {
        unreachable!("parts are opened into all their children at once")
    }

    fn children(&self, &index: &u32, (): &mut ()) -> ArrayVec<u32, WIDTH> {
        let mut children = ArrayVec::new();
        self.open(index, WIDTH, &mut children);
        children
    }

    fn leaf(&self, &index: &u32, prims: &mut Vec<u32>, (): &mut ()) -> Aabb {
        self.gather(index, prims);
        self.tree.node(index).bounds()
    }

    fn mark(&self, (): &()) -> usize {
        0
    }

    fn release(&self, (): &mut (), _: usize) {}
}
