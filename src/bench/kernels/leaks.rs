//! Rays from within a closed mesh, aimed at its vertices and edges: how many get out, by kernel. The records are
//! `leaks.csv`, one row per kernel x width x target; `results/README.md` describes the columns for readers of the file.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use super::contestants::{Contestant, Trees};
use super::row::{ROBUST, SINGLE, WATERTIGHT};
use crate::bench::cell::Cell;
use crate::bench::environment::moment::utc_now;
use crate::bench::environment::{Machine, Program};
use crate::bench::files::{self, RecordsError};
use crate::geometry::{Hit, Mesh, Ray, Tracer};
use crate::random::SplitMix64;
use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the columns; a reader refuses any other.
pub const SCHEMA: u32 = 1;
/// The file in a results folder.
pub const LEAKS: &str = "leaks.csv";
/// Whose trees are traced.
const BUILDER: &str = if cfg!(feature = "graft") { "embree-sah" } else { "phr-quality" };
/// Kernels that are asked, by name.
const KERNELS: [&str; 4] = [SINGLE, ROBUST, "phr", WATERTIGHT];
/// Other kernels than the watertight one get so many times fewer rays.
const FEWER: u64 = 10;
/// Quads of the sphere along each angle.
const QUADS: usize = 320;
/// Rays that are made and traced at once.
const CHUNK: u64 = 1 << 14;

/// One line of `leaks.csv`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeakRow {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Start of the run, ISO 8601.
    pub utc: String,
    /// Revision of this program, `-dirty` if the sources differed from it.
    pub git_rev: String,
    /// Processor model.
    pub cpu: String,
    /// The mesh.
    pub scene: String,
    /// Triangles.
    pub triangles: u64,
    /// Who built the tree.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Who traced the rays.
    pub kernel: String,
    /// The kernel's instruction set.
    pub isa: String,
    /// "vertices" or "edges".
    pub target: String,
    /// Rays.
    pub rays: u64,
    /// Rays that hit nothing.
    pub leaks: u64,
}

impl LeakRow {
    /// True of our watertight kernel.
    pub fn is_watertight(&self) -> bool {
        self.kernel == WATERTIGHT
    }
}

/// What is traced.
#[derive(Clone, Copy, Debug)]
pub struct LeakSettings {
    /// Rays by the watertight kernel over each tree, at vertices and edges together.
    pub rays: u64,
    /// Threads.
    pub threads: usize,
}

/// What rays are aimed at.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Vertices,
    Edges,
}

/// Traces the rays by all kernels over trees of both widths.
///
/// # Errors
/// Threads or a tree that cannot be had, in one line.
pub fn measure(settings: &LeakSettings) -> Result<Vec<LeakRow>, String> {
    measure_in(&sphere(QUADS).map_err(|error| error.to_string())?, settings)
}

fn measure_in(mesh: &Mesh, settings: &LeakSettings) -> Result<Vec<LeakRow>, String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build();
    let pool = pool.map_err(|error| format!("--threads {}: {error}; give fewer", settings.threads))?;
    let trees = Trees::build(mesh, &[4, 8].map(|width| Cell::new(BUILDER, width, &[])), &pool)?;
    let about = LeakRow {
        schema: SCHEMA,
        utc: utc_now(),
        git_rev: Program::this().git_rev,
        cpu: Machine::this("").cpu,
        scene: "sphere".into(),
        triangles: mesh.len() as u64,
        ..LeakRow::default()
    };
    let row = |contestant: &Contestant<'_>, target: Target| {
        let all = if contestant.kernel == WATERTIGHT { settings.rays } else { settings.rays / FEWER };
        let rays = all / 2;
        LeakRow {
            builder: contestant.builder.into(),
            width: contestant.width,
            kernel: contestant.kernel.into(),
            isa: contestant.isa.clone(),
            target: if target == Target::Vertices { "vertices" } else { "edges" }.into(),
            rays,
            leaks: pool.install(|| leaks(&*contestant.tracer, mesh, target, rays)),
            ..about.clone()
        }
    };
    let contestants = trees.contestants();
    let asked = contestants.iter().filter(|contestant| KERNELS.contains(&contestant.kernel));
    Ok(asked.flat_map(|asked| [Target::Vertices, Target::Edges].map(|target| row(asked, target))).collect())
}

/// How many of `rays` rays hit nothing, on the threads of the current pool. They depend on their number alone.
fn leaks(tracer: &dyn Tracer, mesh: &Mesh, target: Target, rays: u64) -> u64 {
    let chunk = |first: u64| {
        let rays: Vec<Ray> = (first * CHUNK..rays.min((first + 1) * CHUNK))
            .map(|index| ray(mesh, target, &mut SplitMix64::new(index)))
            .collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        tracer.closest(&rays, &mut hits);
        hits.iter().filter(|hit| !hit.is_hit()).count() as u64
    };
    (0..rays.div_ceil(CHUNK)).into_par_iter().map(chunk).sum()
}

/// From within half of the sphere's radius at a vertex or at a point of an edge.
fn ray(mesh: &Mesh, target: Target, random: &mut SplitMix64) -> Ray {
    let org = random.point(-0.25, 0.25);
    let corners = mesh.corners(random.below(mesh.len()) as u32).map(Vec3::from);
    let side = random.below(3);
    let [a, b] = [0, 1].map(|next| corners.get((side + next) % 3).copied().unwrap_or_default());
    let at = if target == Target::Vertices { a } else { a + random.unit() * (b - a) };
    Ray { org, tnear: 0.0, dir: at - org, tfar: f32::INFINITY }
}

/// A unit sphere of `2 * quads * quads` triangles that share their vertices; those at the poles are slivers.
fn sphere(quads: usize) -> Result<Mesh, crate::geometry::MeshError> {
    let mut vertices = Vec::new();
    for i in 0..=quads {
        let polar = std::f32::consts::PI * i as f32 / quads as f32;
        for j in 0..quads {
            let around = std::f32::consts::TAU * j as f32 / quads as f32;
            let (s, c) = if i == 0 || i == quads { (0.0, polar.cos()) } else { polar.sin_cos() };
            vertices.push([s * around.cos(), s * around.sin(), c]);
        }
    }
    let at = |i: usize, j: usize| (i * quads + j % quads) as u32;
    let triangles = (0..quads).flat_map(|i| (0..quads).map(move |j| (i, j))).flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    Mesh::new(vertices, triangles.collect()).map(|(mesh, _)| mesh)
}

/// Writes the rows, whole.
///
/// # Errors
/// An unwritable place.
pub fn write(path: &Path, rows: &[LeakRow]) -> Result<(), RecordsError> {
    files::write_csv(path, rows)
}

/// Reads the rows of a results folder or of a file.
///
/// # Errors
/// No such file, other columns, no rows.
pub fn read(results: &Path) -> Result<Vec<LeakRow>, RecordsError> {
    files::read_csv(results, LEAKS, (|row: &LeakRow| row.schema, SCHEMA), "run `phr leaks` first")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_watertight_kernel_is() {
        let mesh = sphere(40).unwrap();
        let rows = measure_in(&mesh, &LeakSettings { rays: 40_000, threads: 2 }).unwrap();
        let of = |kernel: &str| rows.iter().filter(move |row| row.kernel == kernel).collect::<Vec<_>>();
        assert_eq!(of(WATERTIGHT).len(), 4, "{rows:?}");
        assert!(of(WATERTIGHT).iter().all(|row| row.rays == 20_000 && row.leaks == 0), "{rows:?}");
        assert!(of("phr").iter().all(|row| row.rays == 2000), "{rows:?}");
        assert!(of("phr").iter().map(|row| row.leaks).sum::<u64>() > 0, "the rays are not hard: {rows:?}");
        let folder = tempfile::tempdir().unwrap();
        write(&folder.path().join(LEAKS), &rows).unwrap();
        assert_eq!(read(folder.path()).unwrap(), rows);
    }
}
