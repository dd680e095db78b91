//! Trace times of our kernels over a 4-wide and an 8-wide tree, by ray kind and instruction set, one thread:
//! `cargo bench --bench kernels`.

#![allow(missing_docs)] // criterion's macros make undocumented functions

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use phr::geometry::{Hit, Tracer};
use phr::trace::{BvhTracer, Isa, PathSettings, RayKind, record};
use phr::{builders, scene};

fn over_width<const N: usize>(criterion: &mut Criterion) {
    for name in ["rooms", "hair"] {
        let scene = scene::generator(name).expect("a built-in scene").generate();
        let tree = builders::by_name::<N>("phr-hq").expect("a name of the list").build(&scene.mesh).tree;
        let settings = PathSettings { width: 128, height: 128, ..PathSettings::default() };
        let batches = record(&BvhTracer::new(&tree), &scene.mesh, &scene.views[0], &settings).batches;
        for kind in RayKind::ALL {
            let rays = batches.get(kind);
            let mut group = criterion.benchmark_group(format!("trace/{name}/{N}/{}", kind.name()));
            group.sample_size(10).throughput(Throughput::Elements(rays.len() as u64));
            for isa in [Isa::Scalar, Isa::best()] {
                let tracer = BvhTracer::with_isa(&tree, isa);
                let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
                group.bench_function(BenchmarkId::from_parameter(isa.name()), |bencher| {
                    bencher.iter(|| {
                        if kind.is_any_hit() {
                            tracer.any(rays, &mut occluded);
                        } else {
                            tracer.closest(rays, &mut hits);
                        }
                    });
                });
            }
            group.finish();
        }
    }
}

criterion_group!(benches, over_width<4>, over_width<8>);
criterion_main!(benches);
