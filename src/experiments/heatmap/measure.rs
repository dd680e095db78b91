//! Counts the steps of each pixel's primary ray through each builder's tree, all under our kernel, which has counters.

use super::records::{HeatmapRow, Panel};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::contender::{self, BuildRequest, Contender, TreeUnderKernel};
use crate::bench::environment::{Machine, Program};
use crate::bench::pools::Pools;
use crate::bench::statistics::{Summary, figures};
use crate::geometry::{Hit, Ray, Tracer};
use crate::scene::Scene;
use crate::trace::{self, Camera, verify};

/// What is counted.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Index of its view.
    pub view: usize,
    /// Builders with the width of their trees.
    pub cells: &'a [Cell],
    /// Pixels across and down.
    pub size: u32,
    /// Steps of the brightest colour; chosen from the counts if not given.
    pub scale: Option<u32>,
    /// The threads.
    pub pools: &'a Pools,
}

/// Builds every tree, times the builds, and counts the steps of a ray through the middle of each pixel. The hits are
/// compared with those of the reference tree.
///
/// # Errors
/// A builder that failed, a tree that our kernel cannot trace, wrong hits: one line.
pub fn measure(request: &Request<'_>) -> Result<Vec<Panel>, String> {
    let Request { scene, view, size, pools, .. } = *request;
    let camera = Camera::new(&scene.views[view], size, size);
    let rays: Vec<Ray> = (0..size * size).map(|i| camera.ray(i % size, i / size, [0.5; 2])).collect();
    let threads = pools.all.current_num_threads();
    let built = contender::reference(&scene.mesh, &pools.all)?;
    let tree = TreeUnderKernel::new(&built, contender::REFERENCE_KERNEL, threads)?;
    let reference = pools.all.install(|| Ok::<_, String>(hits(tree.tracer()?, &rays)))?;
    let mut panels = Vec::new();
    for cell in request.cells {
        panels.push(panel(request, cell, &rays, &reference)?);
    }
    let scale = request.scale.unwrap_or_else(|| scale_of(&panels));
    panels.iter_mut().for_each(|panel| panel.row.scale = scale);
    Ok(panels)
}

fn hits(tracer: &dyn Tracer, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit::MISS; rays.len()];
    trace::closest_in_parallel(tracer, rays, &mut hits);
    hits
}

fn panel(request: &Request<'_>, cell: &Cell, rays: &[Ray], reference: &[Hit]) -> Result<Panel, String> {
    let Request { scene, view, size, pools, .. } = *request;
    let (mesh, name) = (&scene.mesh, format!("{} / {}", cell.builder, cell.width));
    let build = BuildRequest { mesh, pools, kernels: &[Kernel::Phr], wants_facts: false, fresh_only: true };
    let built = Contender::of(cell)?.build(&build).map_err(|reason| format!("{name}: {reason}"))?;
    let tree = TreeUnderKernel::new(&built, Kernel::Phr, pools.all.current_num_threads())?;
    let tracer =
        tree.tracer().map_err(|reason| format!("{name}: our kernel cannot have its tree: {reason}"))?;
    let hits = pools.all.install(|| hits(tracer, rays));
    if let Some(wrong) = verify::compare_closest(mesh, rays, reference, &hits).mismatches.first() {
        return Err(format!("{name}: wrong hit of pixel {}; see `phr verify`", wrong.ray));
    }
    let counts = pools.all.install(|| tree.count_each(rays)).ok_or_else(|| format!("{name}: no counters"))?;
    let steps: Vec<u16> = counts
        .iter()
        .map(|count| (count.node_visits + count.block_tests).min(u64::from(u16::MAX)) as u16)
        .collect();
    let mut sorted = steps.clone();
    sorted.sort_unstable();
    let last = sorted.len() - 1;
    let build_ms = Summary::of(&built.times.fresh.ms).map_or(0.0, |builds| builds.median);
    let row = HeatmapRow {
        git_rev: Program::this().git_rev,
        cpu: Machine::this("").cpu,
        scene: scene.name.clone(),
        triangles: mesh.len() as u64,
        view: view as u32,
        size,
        builder: cell.builder.clone(),
        width: cell.width,
        threads: pools.all.current_num_threads() as u32,
        build_ms: figures(build_ms),
        steps_mean: figures(steps.iter().map(|&n| f64::from(n)).sum::<f64>() / steps.len() as f64),
        steps_p95: sorted[last * 95 / 100].into(),
        steps_p99: sorted[last * 99 / 100].into(),
        steps_max: sorted[last].into(),
        scale: 0,
    };
    Ok(Panel { row, steps })
}

/// Below which 99 of 100 pixels of every builder are, rounded up to a multiple of twenty: the few beyond would
/// darken all others.
fn scale_of(panels: &[Panel]) -> u32 {
    let most = panels.iter().map(|panel| panel.row.steps_p99).max().unwrap_or(0);
    most.max(1).div_ceil(20) * 20
}
