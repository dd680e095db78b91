//! The steps of a build on two built-in scenes, one thread: `cargo bench --bench steps [-- FILTER]`.
//!
//! Beside each step stands its floor, a `memcpy` that reads and writes as many bytes in all as the step must
//! (half of them read, half written). Elements are triangles, cut nodes, or what is emitted.

#![allow(missing_docs)] // criterion's macros make undocumented functions

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use phr::builders::steps::{Steps, Traffic, Way};
use phr::geometry::Mesh;
use phr::scene;
use rayon::ThreadPool;
use std::hint::black_box;
use std::time::Duration;

/// Lengths of cuts.
const LENGTHS: [usize; 8] = [2, 4, 8, 16, 32, 64, 256, 1024];
/// Nodes of all cuts of one length: half a mebibyte, as caches hold it.
const NODES: usize = 1 << 14;

fn steps(criterion: &mut Criterion) {
    // Steps run on one thread, like their floors.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one more thread");
    for name in ["rooms", "hair"] {
        let scene = scene::generator(name).expect("a built-in scene").generate();
        auxiliary(criterion, name, &scene.mesh, &pool);
        let mut steps = Steps::new(&scene.mesh, 1);
        sweeps(criterion, name, &steps);
        cuts(criterion, name, &mut steps);
    }
}

/// Codes, sort, and the tree with leaves of one triangle and of up to four.
fn auxiliary(criterion: &mut Criterion, scene: &str, mesh: &Mesh, pool: &ThreadPool) {
    for leaf in [1, 4] {
        let mut steps = Steps::new(mesh, leaf);
        let phases: &[&str] =
            if leaf == 1 { &["codes", "sort", "auxiliary tree"] } else { &["auxiliary tree"] };
        for phase in phases {
            let what = match *phase {
                "auxiliary tree" => format!("lbvh-{leaf}"),
                other => other.into(),
            };
            let mut group = group(criterion, &format!("{what}/{scene}"), mesh.len());
            group.bench_function("step", |bencher| {
                bencher.iter_custom(|times| {
                    let mut one = || {
                        let phases = pool.install(|| steps.auxiliary(leaf));
                        let of_name = phases.iter().filter(|of_build| of_build.name == *phase);
                        of_name.map(|phase| phase.duration).sum::<Duration>()
                    };
                    (0..times).map(|_| one()).sum()
                });
            });
            floor(&mut group, steps.auxiliary_traffic(phase).expect("a phase of the list"));
            group.finish();
        }
    }
}

/// Object splits by length of the cut and by each way to find them; spatial splits.
fn sweeps(criterion: &mut Criterion, scene: &str, steps: &Steps<'_>) {
    for len in LENGTHS {
        let cuts = steps.cuts(len, NODES);
        let mut object = group(criterion, &format!("object-sweep/{scene}/{len}"), cuts.nodes());
        for way in Way::ALL.into_iter().filter(|way| way.splits(len)) {
            let id = BenchmarkId::from_parameter(format!("{way:?}").to_lowercase());
            object.bench_function(id, |bencher| bencher.iter(|| cuts.object_splits(way)));
        }
        floor(&mut object, cuts.traffic());
        object.finish();
        let mut spatial = group(criterion, &format!("spatial-sweep/{scene}/{len}"), cuts.nodes());
        for (id, bounded) in [("as-in-builds", true), ("unbounded", false)] {
            spatial.bench_function(id, |bencher| bencher.iter(|| cuts.spatial_splits(bounded)));
        }
        floor(&mut spatial, cuts.traffic());
        spatial.finish();
    }
}

/// Refining, subtrees swept in one go, leaf blocks, wide nodes.
fn cuts(criterion: &mut Criterion, scene: &str, steps: &mut Steps<'_>) {
    let refined = steps.refine();
    let mut refine = group(criterion, &format!("refine/{scene}"), refined);
    refine.bench_function("step", |bencher| bencher.iter(|| steps.refine()));
    // A node is 32 bytes and goes from one array to another.
    floor(&mut refine, Traffic { read: 32 * refined, written: 32 * refined });
    refine.finish();

    for len in [16, 32, 64, 256] {
        steps.subtrees(len);
        let mut subtrees = group(criterion, &format!("subtree-sweep/{scene}/{len}"), steps.triangles());
        subtrees.bench_function("step", |bencher| bencher.iter(|| steps.subtrees(len)));
        floor(&mut subtrees, steps.subtree_traffic());
        subtrees.finish();
    }

    let blocks = steps.leaf_blocks();
    let mut emit = group(criterion, &format!("leaf-blocks/{scene}"), blocks);
    emit.bench_function("step", |bencher| bencher.iter(|| steps.leaf_blocks()));
    floor(&mut emit, steps.leaf_block_traffic());
    emit.finish();

    let nodes = steps.wide_nodes();
    let mut emit = group(criterion, &format!("wide-nodes/{scene}"), nodes);
    emit.bench_function("step", |bencher| bencher.iter(|| steps.wide_nodes()));
    floor(&mut emit, steps.wide_node_traffic());
    emit.finish();
}

fn group<'a>(criterion: &'a mut Criterion, name: &str, elements: usize) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(format!("steps/{name}"));
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(500))
        .throughput(Throughput::Elements(elements as u64));
    group
}

/// Copies as many bytes as read and written make in all, with the throughput of the step's elements.
fn floor(group: &mut BenchmarkGroup<'_, WallTime>, Traffic { read, written }: Traffic) {
    let from = vec![1u8; (read + written) / 2];
    let mut to = vec![0u8; from.len()];
    group.bench_function("memcpy", |bencher| {
        bencher.iter(|| black_box(&mut to[..]).copy_from_slice(black_box(&from)));
    });
}

criterion_group!(benches, steps);
criterion_main!(benches);
