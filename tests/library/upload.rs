//! Trees as bytes, walked as `examples/gpu/traverse.wgsl` walks them: the shader's steps in Rust give our kernel's
//! hits.

use phr::bvh::{TriangleBlock, WideNode};
use phr::geometry::Ray;
use phr::random::SplitMix64;
use phr::{Bvh, BvhConfig, scene};

/// No test runs the shader; it is one, at least, and its records are as long as ours.
#[test]
fn the_shader_is_valid_and_lies_over_the_trees_bytes() {
    let source = include_str!("../../examples/gpu/traverse.wgsl");
    let shader = naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
    let all = naga::valid::ValidationFlags::all();
    naga::valid::Validator::new(all, naga::valid::Capabilities::empty()).validate(&shader).unwrap();
    let bytes = |name: &str| {
        let of_name = |ty: &naga::Type| ty.name.as_deref() == Some(name);
        let (_, ty) = shader.types.iter().find(|(_, ty)| of_name(ty)).unwrap();
        let naga::TypeInner::Struct { span, .. } = ty.inner else { panic!("{name} is no struct") };
        span as usize
    };
    assert_eq!([bytes("Node"), bytes("Block")], [size_of::<WideNode<4>>(), size_of::<TriangleBlock>()]);
}

const NONE: u32 = u32::MAX;

struct Words(Vec<u32>);

impl Words {
    fn of(bytes: &[u8]) -> Self {
        Self(bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect())
    }

    fn float(&self, at: usize) -> f32 {
        f32::from_bits(self.0[at])
    }

    /// Component `lane` of three vectors of four that follow one another from word `at` on.
    fn vector(&self, at: usize, lane: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.float(at + 4 * axis + lane))
    }
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn test_block(blocks: &Words, ray: &Ray, index: usize, hit: &mut (f32, u32)) {
    let (org, dir) = (ray.org.to_array(), ray.dir.to_array());
    for lane in 0..4 {
        let at = |vectors: usize| blocks.vector(40 * index + vectors, lane);
        let (v0, e1, e2) = (at(0), at(12), at(24));
        let c = [0, 1, 2].map(|axis| v0[axis] - org[axis]);
        let (r, normal) = (cross(c, dir), cross(e2, e1));
        let den = dot(normal, dir);
        let (u, v, t) = (dot(r, e2) / den, dot(r, e1) / den, dot(normal, c) / den);
        let inside = den != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        if inside && ray.tnear < t && t <= hit.0 {
            *hit = (t, blocks.0[40 * index + 36 + lane]);
        }
    }
}

fn trace(nodes: &Words, blocks: &Words, root: u32, ray: &Ray) -> (f32, u32) {
    let rdir = ray.dir.to_array().map(|x| 1.0 / if x.abs() < 1e-18 { 1e-18 } else { x });
    let (mut hit, mut waiting, mut link) = ((ray.tfar, NONE), Vec::<(f32, u32)>::new(), root);
    loop {
        if link >> 31 == 0 {
            let node = 32 * link as usize;
            let base = waiting.len();
            for slot in 0..4 {
                let (mut near, mut far) = (ray.tnear, hit.0);
                let (lower, upper) = (nodes.vector(node, slot), nodes.vector(node + 12, slot));
                for axis in 0..3 {
                    let [a, b] = [lower[axis], upper[axis]].map(|plane| (plane - ray.org[axis]) * rdir[axis]);
                    near = near.max(a.min(b));
                    far = far.min(a.max(b) * 1.000_000_5);
                }
                let child = nodes.0[node + 24 + slot];
                if child != NONE && near <= far {
                    let place = base + waiting[base..].partition_point(|&(entry, _)| entry >= near);
                    waiting.insert(place, (near, child));
                }
            }
        } else if link != NONE {
            let (first, count) = (link & 0x0fff_ffff, (link >> 28 & 7) + 1);
            (first..first + count).for_each(|block| test_block(blocks, ray, block as usize, &mut hit));
        }
        link = loop {
            match waiting.pop() {
                None => return hit,
                Some((entry, link)) if entry <= hit.0 => break link,
                Some(_) => {}
            }
        };
    }
}

#[test]
fn uploaded_trees_are_traversed_as_the_note_says() {
    let mesh = scene::scalable(20_000, 3).mesh;
    let bvh = Bvh::build(&mesh, &BvhConfig { builder: "phr-quality", width: 4 }).unwrap();
    let tree = bvh.as_bvh4().unwrap();
    let (nodes, blocks) = (Words::of(&tree.node_bytes()), Words::of(&tree.block_bytes()));
    let (bounds, mut random) = (mesh.bounds(), SplitMix64::new(4));
    let mut point =
        || glam::Vec3::from(bounds.min) + random.point(0.0, 1.0) * glam::Vec3::from(bounds.extent());
    let (mut hits, mut differ) = (0, 0);
    for _ in 0..3000 {
        let (org, at) = (point(), point());
        let ray = Ray { org, tnear: 0.0, dir: at - org, tfar: f32::INFINITY };
        let (t, prim) = trace(&nodes, &blocks, tree.root.bits(), &ray);
        let expected = bvh.intersect(&ray);
        hits += usize::from(expected.is_some());
        differ += usize::from(match expected {
            None => prim != NONE,
            Some(hit) => prim == NONE || (hit.t - t).abs() > 1e-4 * hit.t,
        });
    }
    assert!(hits > 500 && differ <= 3, "{differ} of {hits} hits differ");
}
