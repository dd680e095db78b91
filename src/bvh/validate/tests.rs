use super::*;
use crate::bvh::{Bvh4, TriangleBlock, WideNode};

/// Two triangles, each in a leaf of its own below one node.
fn whole() -> (Mesh, Bvh4) {
    let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [5., 0., 0.], [6., 0., 0.], [5., 1., 0.]];
    let (mesh, _) = Mesh::new(vertices, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let mut node = WideNode::EMPTY;
    let mut blocks = vec![TriangleBlock::EMPTY; 2];
    for (prim, block) in (0..).zip(&mut blocks) {
        block.set(0, mesh.corners(prim), prim);
        node.set(prim as usize, mesh.bounds_of(prim), Link::leaf(prim as usize, 1));
    }
    let tree = Bvh4 { root: Link::inner(0), bounds: mesh.bounds(), nodes: vec![node], blocks };
    (mesh, tree)
}

fn invalid(change: impl FnOnce(&mut Bvh4)) -> Invalid {
    let (mesh, mut tree) = whole();
    assert_eq!(tree.validate(&mesh), Ok(()));
    change(&mut tree);
    tree.validate(&mesh).unwrap_err()
}

#[test]
fn every_kind_of_damage_is_found() {
    assert_eq!(invalid(|t| t.root = Link::inner(7)), Invalid::Link { what: "node", index: 7 });
    assert_eq!(
        invalid(|t| t.nodes[0].links[1] = Link::leaf(0, 1)),
        Invalid::Link { what: "block", index: 0 }
    );
    assert_eq!(invalid(|t| t.nodes[0].links[1] = Link::inner(0)), Invalid::Link { what: "node", index: 0 });
    assert_eq!(invalid(|t| t.nodes.push(WideNode::EMPTY)), Invalid::Unreached { what: "node", index: 1 });
    assert_eq!(invalid(|t| t.blocks.push(t.blocks[0])), Invalid::Unreached { what: "block", index: 2 });
    assert_eq!(invalid(|t| t.nodes[0].links.swap(1, 2)), Invalid::Slots(0));
    // Nobody makes such a link, but a file may hold one.
    let a_block_more = Link::leaf(0, 2).bits() - Link::leaf(0, 1).bits();
    let long = Link::from_bits(Link::leaf(0, MAX_LEAF_BLOCKS).bits() + a_block_more);
    // An unused slot that rays enter; a node without children.
    assert_eq!(
        invalid(|t| t.nodes[0].set(3, Aabb::new(Vec3A::ZERO, Vec3A::ONE), Link::EMPTY)),
        Invalid::Slots(0)
    );
    assert_eq!(invalid(|t| t.nodes[0] = WideNode::EMPTY), Invalid::Slots(0));
    assert_eq!(invalid(|t| t.nodes[0].links[1] = long), Invalid::LongLeaf(0));
    assert_eq!(invalid(|t| t.nodes[0].upper[0][1] = 7.0), Invalid::Bounds { node: 0, slot: 1 });
    assert_eq!(invalid(|t| t.nodes[0].upper[0][1] = f32::NAN), Invalid::Bounds { node: 0, slot: 1 });
    assert_eq!(invalid(|t| t.blocks[1].v0[0][0] = 5.5), Invalid::Block(1));
    assert_eq!(invalid(|t| t.blocks[1].prims[0] = 9), Invalid::Block(1));
    assert_eq!(invalid(|t| t.blocks[1] = TriangleBlock::EMPTY), Invalid::Block(1));
    assert_eq!(invalid(|t| t.nodes[0].upper[0][0] = 0.5), Invalid::Uncovered(0));
}

#[test]
fn a_tree_that_is_too_deep_is_found() {
    let deep = |levels: usize| {
        let (mesh, mut tree) = whole();
        // Nodes of one child each above the one of both.
        for level in 1..levels {
            let mut above = WideNode::EMPTY;
            above.set(0, mesh.bounds(), Link::inner(level - 1));
            tree.nodes.push(above);
        }
        tree.root = Link::inner(tree.nodes.len() - 1);
        tree.validate(&mesh)
    };
    assert_eq!((deep(MAX_DEPTH), deep(MAX_DEPTH + 1)), (Ok(()), Err(Invalid::TooDeep)));
}

#[test]
fn lost_and_doubled_triangles_are_found() {
    let (mesh, mut tree) = whole();
    tree.nodes[0].links[1] = Link::EMPTY;
    tree.nodes[0].lower.iter_mut().for_each(|plane| plane[1] = f32::INFINITY);
    tree.blocks.pop();
    assert_eq!(tree.validate(&mesh), Err(Invalid::Missing(1)));
    let (mesh, mut tree) = whole();
    tree.blocks[0].set(1, mesh.corners(0), 0);
    assert_eq!(tree.validate(&mesh), Err(Invalid::Twice(0)));
}

#[test]
fn boxes_that_fall_short_by_rounding_cover_only_what_was_rounded() {
    // As wide as some units in the last place: a unit is a tenth of its area.
    let width = 10.0 * f32::EPSILON;
    let vertices = vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0 + width, 0.0]];
    let (mesh, _) = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap();
    let mut node = WideNode::EMPTY;
    let mut block = TriangleBlock::EMPTY;
    block.set(0, mesh.corners(0), 0);
    let bounds = mesh.bounds();
    let short = |by: f32| Aabb::new(bounds.min + Vec3A::Y * by * f32::EPSILON, bounds.max);
    let (mut left, mut right) = (short(1.0), short(1.0));
    (left.max.x, right.min.x) = (0.5, 0.5);
    node.set(0, left, Link::leaf(0, 1));
    node.set(1, right, Link::leaf(1, 1));
    let mut tree = Bvh4 { root: Link::inner(0), bounds, nodes: vec![node], blocks: vec![block; 2] };
    assert_eq!(tree.validate(&mesh), Err(Invalid::Uncovered(0)));
    assert_eq!(tree.validate_rounded(&mesh, 4.0), Ok(()));
    for slot in 0..2 {
        tree.nodes[0].lower[1][slot] = 1.0 + 6.0 * f32::EPSILON;
    }
    assert_eq!(tree.validate_rounded(&mesh, 4.0), Err(Invalid::Uncovered(0)));
}

#[test]
fn pieces_cover_a_triangle_only_together() {
    let (mesh, mut tree) = whole();
    // Triangle 0 in both leaves, cut at x = 0.3: whole; with a gap from 0.3 to 0.4: not.
    tree.blocks[1].set(1, mesh.corners(0), 0);
    tree.nodes[0].upper[0][0] = 0.3;
    tree.nodes[0].lower[0][1] = 0.3;
    assert_eq!(tree.validate(&mesh), Ok(()));
    tree.nodes[0].lower[0][1] = 0.4;
    assert_eq!(tree.validate(&mesh), Err(Invalid::Uncovered(0)));
    assert_eq!(tree.validate_rounded(&mesh, 4.0), Err(Invalid::Uncovered(0)));
    // Twice the same half and nothing of the other.
    tree.nodes[0].lower[0][1] = 0.3;
    tree.nodes[0].set(0, mesh.bounds_of(1), Link::leaf(0, 1));
    assert!(tree.validate(&mesh).is_err());
}
