//! The cheap half of validation: links alone, without boxes and corners.

use super::validate::{Invalid, mark};
use super::{Child, LeafBlock, MAX_DEPTH, WideBvh};

impl<const N: usize, B: LeafBlock> WideBvh<N, B> {
    /// Proves that the links form a tree of bounded depth that uses every node and block once, and that the leaves name
    /// every one of so many primitives and no other. A fraction of [`WideBvh::validate`]: for trees of which boxes and
    /// leaf data are trusted, as of a saved one whose checksum agrees.
    ///
    /// # Errors
    /// The first violation found.
    pub fn validate_links(&self, primitives: usize) -> Result<(), Invalid> {
        let (mut nodes, mut blocks) = (vec![false; self.nodes.len()], vec![false; self.blocks.len()]);
        let mut is_there = vec![false; primitives];
        let mut pending = vec![(self.root, 0)];
        while let Some((link, depth)) = pending.pop() {
            match link.get() {
                Child::Empty => {}
                Child::Inner(_) if depth >= MAX_DEPTH => return Err(Invalid::TooDeep),
                Child::Inner(index) => {
                    mark(&mut nodes, "node", index)?;
                    pending.extend(self.nodes[index].links.iter().map(|&child| (child, depth + 1)));
                }
                Child::Leaf { first, count } => {
                    for index in first..first + count {
                        mark(&mut blocks, "block", index)?;
                        for prim in self.blocks[index].ids() {
                            *is_there.get_mut(prim as usize).ok_or(Invalid::Block(index))? = true;
                        }
                    }
                }
            }
        }
        for (what, seen) in [("node", &nodes), ("block", &blocks)] {
            if let Some(index) = seen.iter().position(|seen| !seen) {
                return Err(Invalid::Unreached { what, index });
            }
        }
        match is_there.iter().position(|is_there| !is_there) {
            Some(prim) => Err(Invalid::Missing(prim as u32)),
            None => Ok(()),
        }
    }
}
