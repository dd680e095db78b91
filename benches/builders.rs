//! Build times of every builder at both widths on two built-in scenes: `cargo bench --bench builders`.
//! For comparisons with Embree see `cargo bench --bench table1`.

#![allow(missing_docs)] // criterion's macros make undocumented functions

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use phr::{builders, scene};

fn of_width<const N: usize>(criterion: &mut Criterion) {
    for name in ["rooms", "hair"] {
        let scene = scene::generator(name).expect("a built-in scene").generate();
        let mut group = criterion.benchmark_group(format!("build/{name}/{N}"));
        group.sample_size(10).throughput(Throughput::Elements(scene.mesh.len() as u64));
        for builder in builders::NAMES {
            let mut builder = builders::by_name::<N>(builder).expect("a name of the list");
            group.bench_function(BenchmarkId::from_parameter(builder.name()), |bencher| {
                // In the memory of the last tree, as in the regime `rebuild`.
                bencher.iter(|| {
                    let tree = builder.build(&scene.mesh).tree;
                    builder.recycle(tree);
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, of_width<4>, of_width<8>);
criterion_main!(benches);
