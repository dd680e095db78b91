//! Trees are bit for bit those on record, for every builder of the tables and the paper's presets with one extension
//! each, on every built-in scene; with `PHR_THOROUGH` at any number of threads and with every instruction set of this
//! processor, which without it are compared beside the naive builders alone. A change
//! that is meant to change trees records them again: `PHR_RECORD_TREES=1 cargo test --test library tree_hashes::`, and
//! says so in the changelog.

use crate::thorough;
use phr::builders;
use phr::bvh::{Child, Link, WideBvh};
use phr::geometry::Mesh;
use phr::scene;
use phr::trace::Isa;
use rayon::ThreadPool;
use std::fmt::Write as _;
use std::process::Command;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/library/tree_hashes.csv");

/// A hash of words.
struct Hash(u64);

impl Hash {
    const NEW: Self = Self(0xcbf2_9ce4_8422_2325);

    fn add(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 29;
    }

    /// Adds all bits of nodes and blocks below a link, depth first: not where they lie in memory.
    fn add_below<const N: usize>(&mut self, tree: &WideBvh<N>, link: Link) {
        match link.get() {
            Child::Empty => self.add(0),
            Child::Inner(index) => {
                self.add(1);
                let node = &tree.nodes[index];
                node.lower.iter().chain(&node.upper).flatten().for_each(|plane| self.add(plane.to_bits()));
                node.links.iter().for_each(|&link| self.add_below(tree, link));
            }
            Child::Leaf { first, count } => {
                self.add(1 + count as u32);
                for block in &tree.blocks[first..first + count] {
                    let corners = block.v0.iter().chain(&block.e1).chain(&block.e2);
                    corners.flatten().for_each(|x| self.add(x.to_bits()));
                    block.prims.iter().for_each(|&prim| self.add(prim));
                }
            }
        }
    }
}

/// A hash of all bits of a tree, wherever its nodes and blocks lie.
fn hash<const N: usize>(tree: &WideBvh<N>) -> u64 {
    let mut hash = Hash::NEW;
    let corners = [tree.bounds.min, tree.bounds.max].map(|corner| corner.to_array());
    corners.as_flattened().iter().for_each(|x| hash.add(x.to_bits()));
    hash.add(tree.nodes.len() as u32);
    hash.add(tree.blocks.len() as u32);
    hash.add_below(tree, tree.root);
    hash.0
}

/// A hash of where everything lies.
fn layout<const N: usize>(tree: &WideBvh<N>) -> u64 {
    let mut hash = Hash::NEW;
    let links = tree.nodes.iter().flat_map(|node| node.links);
    links.chain([tree.root]).for_each(|link| hash.add(link.bits()));
    hash.0
}

/// A line for each scene, builder and width: `scene,builder,width,hash`.
fn hashes(threads: &[usize]) -> String {
    let pool = |&n: &usize| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let pools: Vec<_> = threads.iter().map(pool).collect();
    let mut lines = String::new();
    for scene in scene::builtin() {
        let mesh = scene.generate().mesh;
        for name in builders::NAMES.iter().chain(builders::ABLATION) {
            let four = hash_of::<4>(name, &mesh, &pools);
            writeln!(lines, "{},{name},4,{four:016x}", scene.name).unwrap();
            let eight = hash_of::<8>(name, &mesh, &pools);
            writeln!(lines, "{},{name},8,{eight:016x}", scene.name).unwrap();
        }
    }
    lines
}

/// The hash of a builder's tree, which is the same in all pools, as is its place in memory.
fn hash_of<const N: usize>(name: &str, mesh: &Mesh, pools: &[ThreadPool]) -> u64 {
    let mut builder = builders::by_name::<N>(name).unwrap();
    let mut of_pools = pools.iter().map(|pool| {
        let tree = pool.install(|| builder.build(mesh)).tree;
        let hashes = (hash(&tree), layout(&tree));
        builder.recycle(tree);
        hashes
    });
    let first = of_pools.next().unwrap();
    assert!(of_pools.all(|hashes| hashes == first), "{name}, width {N}: threads differ");
    first.0
}

/// The first line that differs.
fn difference<'a>(new: &'a str, recorded: &'a str) -> Option<(&'a str, &'a str)> {
    let recorded = recorded.lines().chain(std::iter::repeat("nothing"));
    new.lines().zip(recorded).find(|(new, recorded)| new != recorded)
}

#[test]
fn trees_are_those_on_record() {
    // Processes of lower instruction sets come here, too.
    let is_lower = std::env::var_os("PHR_ISA").is_some();
    let new = hashes(if is_lower {
        &[2]
    } else if thorough() {
        &[1, 2, 8]
    } else {
        &[8]
    });
    if std::env::var_os("PHR_RECORD_TREES").is_some() {
        std::fs::write(FILE, &new).unwrap();
    }
    let recorded = std::fs::read_to_string(FILE).unwrap();
    assert_eq!(new.lines().count(), recorded.lines().count());
    assert_eq!(difference(&new, &recorded), None, "instruction set {}", Isa::best());
}

/// The instruction set is detected once per process: each lower one has a process of its own.
#[test]
fn trees_are_the_same_with_lower_instruction_sets() {
    // What is being written cannot be compared with.
    if std::env::var_os("PHR_RECORD_TREES").is_some() || !thorough() {
        println!("skipped: trees are recorded, or PHR_THOROUGH is not set");
        return;
    }
    for isa in Isa::available().filter(|&isa| isa != Isa::best()) {
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "tree_hashes::trees_are_those_on_record"])
            .env("PHR_ISA", isa.name())
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && text.contains("1 passed"), "{isa}: {text}");
    }
}

#[test]
fn one_bit_is_a_difference() {
    let mut tree = builders::by_name::<4>("lbvh").unwrap().build(&scene::scalable(100, 1).mesh).tree;
    let before = hash(&tree);
    tree.nodes[0].lower[0][0] = f32::from_bits(tree.nodes[0].lower[0][0].to_bits() ^ 1);
    assert_ne!(hash(&tree), before);
    assert_eq!(difference("a\nb", "a\nc"), Some(("b", "c")));
}
