//! LBVH (Lauterbach et al. 2009) as the paper builds it in 4.7: Morton codes, a parallel sort, and a tree that
//! parts each run of codes where their highest bit changes. Three changes: the sort is a radix sort; boxes are
//! united on the way up instead of by atomic counters; and references that share a code are parted by the
//! middle of their own centroids' bounds, so that 32 bits suffice for any scene.
//!
//! The upper part of the tree is found by bisection down to runs that fit the cache. Within such a run the tree
//! needs no search: it is the Cartesian tree of the bits in which neighbouring codes differ, made in one pass
//! with a stack (cf. Apetrei 2014).

use super::binary::{BinaryTree, Node};
use super::in_order::{self, Batch, Place, Spare};
use super::morton_order::{Key, MortonOrder, code, part, part_boxed, reference};
use super::presplit::PresplitConfig;
use super::references::References;
use super::{Phase, Stopwatch, pages};
use crate::geometry::{Aabb, Mesh};

/// References of a run that is built by one task, at most.
const RUN: usize = 1 << 12;

/// The auxiliary BVH with all it is made from; its memory is reused from build to build.
#[derive(Default)]
pub(super) struct Auxiliary {
    /// The references in order.
    pub order: MortonOrder,
    /// The tree.
    pub tree: BinaryTree,
    spare: Spare<Run>,
}

impl Auxiliary {
    /// Builds the LBVH of `mesh`, presplit or not; subtrees of at most `leaf` references become leaves.
    pub fn build(&mut self, mesh: &Mesh, presplit: Option<&PresplitConfig>, leaf: u32) -> Vec<Phase> {
        let mut watch = Stopwatch::start();
        self.order.sort(mesh, presplit, &mut watch);
        // Parting equal codes reorders keys.
        let mut all_keys = std::mem::take(&mut self.order.keys);
        let keys = &mut all_keys[..];
        let references = &self.order.references(mesh);
        self.tree.pairs.clear();
        self.tree.root = None;
        if !keys.is_empty() {
            let pairs = keys.len().div_ceil(leaf as usize) * if leaf == 1 { 1 } else { 2 };
            pages::reserve(&mut self.tree.pairs, pairs + keys.len() / RUN * 4);
            let mut upper = Upper { runs: Vec::new(), pairs: Vec::new() };
            let top = upper.part(references, keys, 0, 0);
            self.tree.root = Some(upper.finish(references, keys, leaf, top, &mut self.tree, &self.spare));
        }
        self.order.keys = all_keys;
        watch.lap("auxiliary tree");
        watch.phases
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let mut runs = 0;
        self.spare.for_each(|run| runs += run.bytes());
        self.order.bytes() + self.tree.bytes() + runs
    }
}

/// A subtree of the upper part.
#[derive(Clone, Copy)]
enum Top {
    /// Index of a run.
    Run(usize),
    /// Index of a pair of the upper part.
    Pair(usize),
}

/// The upper part of the tree.
struct Upper {
    /// First position, length, and splits by the middle so far.
    runs: Vec<(usize, usize, u32)>,
    /// Children before parents.
    pairs: Vec<[Top; 2]>,
}

impl Upper {
    /// Parts a run that begins at `first` down to runs of at most [`RUN`].
    fn part(&mut self, references: &References<'_>, keys: &mut [Key], first: usize, depth: u32) -> Top {
        if keys.len() <= RUN {
            self.runs.push((first, keys.len(), depth));
            return Top::Run(self.runs.len() - 1);
        }
        let mut below = depth;
        let split = part(keys, references, &mut below);
        let (left, right) = keys.split_at_mut(split);
        let pair = [self.part(references, left, first, below), self.part(references, right, first + split, below)];
        self.pairs.push(pair);
        Top::Pair(self.pairs.len() - 1)
    }

    /// Builds the runs in parallel, then the upper part over them.
    fn finish(
        &self,
        references: &References<'_>,
        keys: &mut [Key],
        leaf: u32,
        top: Top,
        tree: &mut BinaryTree,
        spare: &Spare<Run>,
    ) -> Node {
        let roots: Vec<std::sync::OnceLock<(Node, usize)>> = self.runs.iter().map(|_| Default::default()).collect();
        let slices = split_runs(keys, &self.runs);
        in_order::append(self.runs.len(), spare, &mut tree.pairs, &mut Vec::new(), |task, run: &mut Run| {
            let (first, _, depth) = self.runs[task];
            let keys = &mut *slices[task].lock().expect("no task panics");
            let root = run.build(references, keys, first, depth, leaf);
            roots[task].set((root, run.pairs.len())).expect("each task runs once");
        });
        let mut begin = 0;
        let runs: Vec<Node> = roots
            .into_iter()
            .map(|root| {
                let (root, pairs) = root.into_inner().expect("all tasks have run");
                begin += pairs;
                root.moved((begin - pairs) as u32)
            })
            .collect();
        let mut uppers: Vec<Node> = Vec::with_capacity(self.pairs.len());
        let node = |top: Top, uppers: &[Node]| match top {
            Top::Run(run) => runs[run],
            Top::Pair(pair) => uppers[pair],
        };
        for pair in &self.pairs {
            let children = pair.map(|child| node(child, &uppers));
            uppers.push(Node::inner(&children, tree.pairs.len()));
            tree.pairs.push(children);
        }
        node(top, &uppers)
    }
}

/// The keys of each run.
fn split_runs<'a>(mut keys: &'a mut [Key], runs: &[(usize, usize, u32)]) -> Vec<std::sync::Mutex<&'a mut [Key]>> {
    runs.iter()
        .map(|&(_, len, _)| {
            let (run, rest) = std::mem::take(&mut keys).split_at_mut(len);
            keys = rest;
            std::sync::Mutex::new(run)
        })
        .collect()
}

/// A subtree on the stack, and in which bits its first code differs from the one before.
#[derive(Clone, Copy)]
struct Pending {
    node: Node,
    difference: u64,
}

/// The subtree over one run, built by one task; links are relative to its own pairs.
#[derive(Default)]
struct Run {
    items: Vec<(Key, Aabb)>,
    pairs: Vec<[Node; 2]>,
    stack: Vec<Pending>,
}

impl Run {
    fn bytes(&self) -> usize {
        self.items.capacity() * size_of::<(Key, Aabb)>() + self.pairs.capacity() * size_of::<[Node; 2]>()
    }

    /// Builds the subtree over `keys`, which begin at position `first`.
    fn build(&mut self, references: &References<'_>, keys: &mut [Key], first: usize, depth: u32, leaf: u32) -> Node {
        // All boxes first: a plain loop has many loads from memory on their way at once.
        self.items.clear();
        self.items.extend(keys.iter().map(|&key| (key, references.bounds(reference(key)))));
        self.stack.clear();
        let mut items = std::mem::take(&mut self.items);
        let mut at = 0;
        let mut before = 0;
        while at < items.len() {
            let own = code(items[at].0);
            let equal = 1 + items[at + 1..].iter().take_while(|(key, _)| code(*key) == own).count();
            let node = if equal == 1 {
                Node::leaf(items[at].1, first + at, 1)
            } else {
                self.same_code(&mut items[at..at + equal], first + at, depth, leaf)
            };
            let difference = if at == 0 { u64::MAX } else { u64::from(own ^ before) };
            self.unite_below(difference, leaf);
            self.stack.push(Pending { node, difference });
            before = own;
            at += equal;
        }
        self.unite_below(u64::MAX, leaf);
        for (key, item) in keys.iter_mut().zip(&items) {
            *key = item.0;
        }
        self.items = items;
        debug_assert_eq!(self.stack.len(), 1);
        self.stack[0].node
    }

    /// Unites the subtrees on the stack that differ in lower bits than `difference`.
    #[inline]
    fn unite_below(&mut self, difference: u64, leaf: u32) {
        while let [.., left, right] = &self.stack[..]
            && right.difference < difference
        {
            let (left, right) = (*left, right.node);
            self.stack.pop();
            let node = self.unite(left.node, right, leaf);
            *self.stack.last_mut().expect("the left one") = Pending { node, difference: left.difference };
        }
    }

    /// The parent of two subtrees, a leaf if they hold few references.
    #[inline]
    fn unite(&mut self, left: Node, right: Node, leaf: u32) -> Node {
        let count = left.count + right.count;
        if count <= leaf {
            return Node::leaf(left.bounds().union(right.bounds()), left.run().start, count);
        }
        let children = [left, right];
        self.pairs.push(children);
        Node::inner(&children, self.pairs.len() - 1)
    }

    /// The subtree over references of one code.
    fn same_code(&mut self, items: &mut [(Key, Aabb)], first: usize, depth: u32, leaf: u32) -> Node {
        if items.len() <= leaf as usize {
            let bounds = items.iter().map(|(_, bounds)| *bounds).collect();
            return Node::leaf(bounds, first, items.len() as u32);
        }
        let split = part_boxed(items, depth + 1);
        let (left, right) = items.split_at_mut(split);
        let left = self.same_code(left, first, depth + 1, leaf);
        let right = self.same_code(right, first + split, depth + 1, leaf);
        self.unite(left, right, leaf)
    }
}

impl Batch for Run {
    type A = [Node; 2];
    type B = ();

    fn elements(&self) -> (&[[Node; 2]], &[()]) {
        (&self.pairs, &[])
    }

    fn moved(pair: &[Node; 2], at: Place) -> [Node; 2] {
        pair.map(|node| node.moved(at[0] as u32))
    }

    fn clear(&mut self) {
        self.pairs.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(n: usize, place: impl Fn(usize) -> [f32; 3]) -> Mesh {
        let vertices = (0..n).flat_map(|i| {
            let [x, y, z] = place(i);
            [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z]]
        });
        Mesh::new(vertices.collect(), (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
            .unwrap()
            .0
    }

    fn walk(auxiliary: &Auxiliary, references: &References<'_>, node: &Node, seen: &mut Vec<u32>, leaf: u32) -> u32 {
        if node.is_leaf() {
            assert!((1..=leaf).contains(&node.count));
            let ids: Vec<u32> = auxiliary.order.keys[node.run()].iter().map(|&key| reference(key)).collect();
            let bounds: Aabb = ids.iter().map(|&id| references.bounds(id)).collect();
            assert_eq!(bounds, node.bounds());
            seen.extend(ids);
            return 0;
        }
        let children = auxiliary.tree.children(node);
        assert_eq!(node.count, children[0].count + children[1].count);
        assert!(node.count > leaf);
        assert_eq!(children[0].bounds().union(children[1].bounds()), node.bounds());
        1 + children.iter().map(|child| walk(auxiliary, references, child, seen, leaf)).max().unwrap()
    }

    #[test]
    fn every_triangle_is_in_a_leaf_and_depth_is_bounded() {
        type Placement = fn(usize) -> [f32; 3];
        let placements: [(&str, Placement); 4] = [
            ("spread", |i| [(i * 7919 % 1000) as f32, (i * 104_729 % 991) as f32, (i % 13) as f32]),
            ("identical", |_| [1.0, 2.0, 3.0]),
            ("geometric", |i| [2.0f32.powi(i as i32 % 120 - 60), 0.0, 0.0]),
            ("two clusters", |i| if i % 2 == 0 { [0.0, 0.0, i as f32 * 1e-6] } else { [1e15, 0.0, 0.0] }),
        ];
        for (name, place) in placements {
            for (n, leaf) in [(1, 1), (2, 1), (3, 1), (100, 1), (5000, 1), (20_000, 1), (20_000, 4), (9, 4), (3, 4)] {
                let mesh = triangles(n, place);
                let mut auxiliary = Auxiliary::default();
                auxiliary.build(&mesh, None, leaf);
                let references = auxiliary.order.references(&mesh);
                let root = auxiliary.tree.root.unwrap();
                let mut seen = Vec::new();
                let depth = walk(&auxiliary, &references, &root, &mut seen, leaf);
                seen.sort_unstable();
                assert_eq!(seen, (0..n as u32).collect::<Vec<_>>(), "{name}");
                assert!(depth <= 44 + 28, "{name}: {depth}");
                if leaf == 1 {
                    assert_eq!(auxiliary.tree.pairs.len(), n - 1);
                }
            }
        }
    }

    #[test]
    fn runs_part_where_bisection_parts_them() {
        // Few distinct codes per axis: many equal ones, and neighbours that differ in any bit.
        let mesh = triangles(3000, |i| [(i * i % 61) as f32, (i * 13 % 17) as f32, (i % 5) as f32 * 0.1]);
        let mut auxiliary = Auxiliary::default();
        auxiliary.build(&mesh, None, 1);
        let references = auxiliary.order.references(&mesh);
        let mut checked = 0;
        let mut stack = vec![(auxiliary.tree.root.unwrap(), 0)];
        while let Some((node, first)) = stack.pop() {
            if node.is_leaf() {
                assert_eq!(node.run().start, first);
                continue;
            }
            let keys = &mut auxiliary.order.keys.clone()[first..first + node.count as usize];
            let [left, right] = *auxiliary.tree.children(&node);
            if code(keys[0]) != code(keys[keys.len() - 1]) {
                assert_eq!(left.count as usize, part(keys, &references, &mut 0));
                checked += 1;
            }
            stack.extend([(left, first), (right, first + left.count as usize)]);
        }
        assert!(checked > 500);
    }

    #[test]
    fn memory_is_reused_for_a_smaller_mesh() {
        let mut auxiliary = Auxiliary::default();
        for n in [1000, 10, 0] {
            let mesh = triangles(n, |i| [i as f32, 0.0, 0.0]);
            auxiliary.build(&mesh, None, 1);
            assert_eq!(auxiliary.tree.root.map_or(0, |root| root.count), n as u32);
        }
    }
}
