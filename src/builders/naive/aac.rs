//! AAC (Gu, He, Fatahalian, Blelloch 2013, Figure 3), by comparing all clusters with all others for each that is
//! merged.

use super::auxiliary::{Item, Reference, Tree, partitioned};
use super::wide::Wide;
use crate::builders::clusters::aac::config::AacConfig;
use crate::builders::lbvh::morton::MortonEncoder;
use crate::geometry::{Aabb, Mesh};
use std::rc::Rc;

/// The tree over the triangles of `mesh`, with leaves of at most four; `None` without triangles.
pub fn aac(mesh: &Mesh, config: &AacConfig, width: usize) -> Option<Wide> {
    let all = (0..mesh.len() as u32).map(|prim| Reference { prim, bounds: mesh.bounds_of(prim) });
    let references: Vec<Reference> = all.collect();
    let centers = references.iter().fold(Aabb::EMPTY, |all, r| all.grow(r.bounds.center2()));
    let encoder = MortonEncoder::new(centers);
    let mut run: Vec<Item> = references.iter().map(|r| (encoder.code(r.bounds.center2()), *r)).collect();
    run.sort_by_key(|(code, _)| *code);
    if run.is_empty() {
        return None;
    }
    let root = merged(clusters(&run, 0, config), 1).pop()?;
    Some(root.clustered(4, f32::INFINITY).widened(width))
}

/// The clusters of a run of sorted codes that has been partitioned `depth` times by the middle.
fn clusters(run: &[Item], depth: u32, config: &AacConfig) -> Vec<Rc<Tree>> {
    let (delta, epsilon) = (config.delta as f64, config.epsilon);
    let f = |n: f64| delta.powf(0.5 + epsilon) / 2.0 * n.powf(0.5 - epsilon);
    // One triangle cannot be partitioned, even where delta is 1.
    let (all, left) = if run.len() == 1 || run.len() < config.delta {
        (run.iter().map(|(_, reference)| Tree::leaf(&[*reference])).collect(), f(delta))
    } else {
        let (parts, depth) = partitioned(run, depth);
        (parts.map(|part| clusters(&part, depth, config)).concat(), f(run.len() as f64))
    };
    // f(delta) is delta / 2, but for rounding.
    merged(all, (left - 1e-6).ceil() as usize)
}

/// The clusters, of which the nearest two are merged until `left` are left: those whose common box is smallest.
fn merged(mut clusters: Vec<Rc<Tree>>, left: usize) -> Vec<Rc<Tree>> {
    while clusters.len() > left.max(1) {
        let pairs = (0..clusters.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        let area = |[a, b]: &[usize; 2]| clusters[*a].bounds.union(clusters[*b].bounds).half_area();
        let nearest = pairs.min_by(|one, other| area(one).total_cmp(&area(other)));
        let [a, b] = nearest.expect("there are two clusters or more");
        clusters[a] = Tree::node(clusters[a].clone(), clusters[b].clone());
        clusters.swap_remove(b);
    }
    clusters
}

/// Of random triangles, no two pairs of which are equally near: the builder keeps what it found first of those.
#[test]
fn trees_of_aac_are_the_naive_ones_node_for_node() {
    use super::compare::assert_same;
    use super::meshes::{needles, soup};
    use crate::builders::{Aac, Builder as _};
    fn compare<const N: usize>(mesh: &Mesh, config: AacConfig, what: &str) {
        let tree = Aac::<N>::new(config).unwrap().build(mesh).tree;
        assert_same(&tree, mesh, aac(mesh, &config, N).as_ref(), &format!("{what}, {config:?}, width {N}"));
    }
    let configs = [
        AacConfig::FAST,
        // AAC-HQ, and the ends of the range.
        AacConfig { delta: 20, epsilon: 0.1 },
        AacConfig { delta: 1, epsilon: 0.0 },
        AacConfig { delta: 64, epsilon: 0.5 },
    ];
    for n in [0, 1, 2, 3, 4, 5, 7, 8, 17, 64, 65, 300, 5000] {
        let meshes = [("soup", soup(n, 0.1, 1)), ("needles", needles(n, 2))];
        for (what, mesh) in meshes {
            for config in configs {
                compare::<4>(&mesh, config, &format!("{n} {what}"));
                compare::<8>(&mesh, config, &format!("{n} {what}"));
            }
        }
    }
}
