//! The rounds: every kernel traces all rays of a kind once per round, in an order that turns from round to round.

use super::contestants::{Contestant, Trees};
use super::row::{KernelRow, SCHEMA, SINGLE, rounds_otherwise};
use crate::bench::cell::Cell;
use crate::bench::environment::moment::utc_now;
use crate::bench::environment::{Machine, Program};
use crate::bench::rays::Answers;
use crate::bench::statistics::{Ratio, Summary, figures};
use crate::geometry::{Ray, Tracer};
use crate::scene::Scene;
use crate::trace::{PathSettings, RayBatches, RayKind, record, verify};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// Most rays that a thread hands to a kernel at once.
const CHUNK: usize = 1 << 14;
/// Chunks for each thread, at least: with fewer, threads wait for the one that got the last.
const CHUNKS: usize = 8;

/// Rays that each of `threads` threads hands to a kernel at once: a multiple of 1024, or of 64 where they are few.
fn chunk(rays: usize, threads: usize) -> usize {
    let most = rays / (CHUNKS * threads.max(1));
    let step = if most >= 1024 { 1024 } else { 64 };
    (most / step * step).clamp(step, CHUNK)
}

/// What is measured.
#[derive(Clone, Debug)]
pub struct KernelSettings {
    /// The trees: builders and widths; Embree's first single-ray kernel over them is the reference.
    pub cells: Vec<Cell>,
    /// How rays are recorded.
    pub path: PathSettings,
    /// Views per scene, at most.
    pub views: usize,
    /// Rounds, at least.
    pub rounds: usize,
    /// Rounds are added until those of a kind of rays have taken this long.
    pub time: Duration,
    /// Numbers of threads.
    pub threads: Vec<usize>,
}

/// Measures all kernels over the trees of one scene.
///
/// # Errors
/// A tree or threads that cannot be had, in one line.
pub fn measure(scene: &Scene, settings: &KernelSettings) -> Result<Vec<KernelRow>, String> {
    let most = settings.threads.iter().copied().max().unwrap_or(1);
    let trees = Trees::build(&scene.mesh, &settings.cells, &pool(most)?)?;
    let contestants = trees.contestants();
    let reference = contestants.first().ok_or("no kernel traces any of these trees")?;
    let batches = pool(most)?.install(|| rays(scene, &*reference.tracer, settings));
    let about = KernelRow {
        schema: SCHEMA,
        utc: utc_now(),
        git_rev: Program::this().git_rev,
        cpu: Machine::this("").cpu,
        scene: scene.name.clone(),
        triangles: scene.mesh.len() as u64,
        ..KernelRow::default()
    };
    let mut rows = Vec::new();
    for &threads in &settings.threads {
        let pool = pool(threads)?;
        for kind in RayKind::ALL {
            let rays = batches.get(kind);
            if rays.is_empty() {
                continue;
            }
            let (times, answers) = pool.install(|| rounds(&contestants, kind, rays, settings));
            let verdict = |index: usize| {
                let tracers = [&*reference.tracer, &*contestants[index].tracer];
                answers[index].compare(&scene.mesh, rays, &answers[0], tracers)
            };
            for (index, contestant) in contestants.iter().enumerate() {
                let same_tree = |other: &Contestant<'_>| {
                    (other.builder, other.width) == (contestant.builder, contestant.width)
                };
                let single = contestants.iter().position(|other| other.kernel == SINGLE && same_tree(other));
                let ratio = single.and_then(|single| ratio(&times[single], &times[index]));
                let verdict = verdict(index);
                let (edges, near_misses) = (verdict.edge as u64, verdict.near_misses as u64);
                let excused =
                    if rounds_otherwise(contestant.kernel) { verify::OTHER_TEST } else { verify::SAME_TEST };
                let excess = verify::excess(rays.len() as u64, edges, near_misses, excused);
                let summary = Summary::of(&times[index]).ok_or("no rounds; give --rounds 1 or more")?;
                rows.push(KernelRow {
                    builder: contestant.builder.into(),
                    width: contestant.width,
                    kernel: contestant.kernel.into(),
                    isa: contestant.isa.clone(),
                    ray_kind: kind.name().into(),
                    rays: rays.len() as u64,
                    threads: threads as u32,
                    rounds: times[index].len() as u32,
                    mrays_s: figures(rays.len() as f64 / summary.median / 1e6),
                    ratio: ratio.map(|ratio| figures(ratio.value)),
                    ratio_low: ratio.map(|ratio| figures(ratio.low)),
                    ratio_high: ratio.map(|ratio| figures(ratio.high)),
                    verified: verdict.is_ok() && excess.is_none(),
                    edges: Some(edges),
                    near_misses: Some(near_misses),
                    pass_ms: milliseconds(&times[index]),
                    ..about.clone()
                });
            }
        }
    }
    Ok(rows)
}

fn pool(threads: usize) -> Result<ThreadPool, String> {
    let build = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    build.map_err(|error| format!("--threads {threads}: {error}; give fewer"))
}

/// The rays of the first views, by kind.
fn rays(scene: &Scene, tracer: &dyn Tracer, settings: &KernelSettings) -> RayBatches {
    let mut all = RayBatches::default();
    for view in scene.views.iter().take(settings.views) {
        let recorded = record(tracer, &scene.mesh, view, &settings.path).batches;
        for kind in RayKind::ALL {
            all.get_mut(kind).extend_from_slice(recorded.get(kind));
        }
    }
    all
}

/// Seconds of each contestant in each round, and its answers, on the current pool. The pass before the timed one
/// fills the caches with its tree: else who follows another over the same tree finds it there, and who follows one
/// over another does not.
fn rounds(
    contestants: &[Contestant<'_>],
    kind: RayKind,
    rays: &[Ray],
    settings: &KernelSettings,
) -> (Vec<Vec<f64>>, Vec<Answers>) {
    let mut answers: Vec<Answers> = contestants.iter().map(|_| Answers::room(kind, rays.len())).collect();
    let mut times = vec![Vec::new(); contestants.len()];
    let begin = Instant::now();
    for round in 0.. {
        if round >= settings.rounds && begin.elapsed() >= settings.time {
            break;
        }
        for turn in 0..contestants.len() {
            let index = (turn + round) % contestants.len();
            let (tracer, answers) = (&*contestants[index].tracer, &mut answers[index]);
            fill(answers, tracer, rays);
            answers.reset();
            let start = Instant::now();
            fill(answers, tracer, rays);
            times[index].push(start.elapsed().as_secs_f64());
        }
    }
    (times, answers)
}

/// On the threads of the current pool.
fn fill(answers: &mut Answers, tracer: &dyn Tracer, rays: &[Ray]) {
    let chunk = chunk(rays.len(), rayon::current_num_threads());
    let rays = rays.par_chunks(chunk);
    match answers {
        Answers::Closest(hits) => {
            rays.zip(hits.par_chunks_mut(chunk)).for_each(|(rays, hits)| tracer.closest(rays, hits));
        }
        Answers::Any(occluded) => {
            rays.zip(occluded.par_chunks_mut(chunk)).for_each(|(rays, occluded)| tracer.any(rays, occluded));
        }
    }
}

/// As [`KernelRow::pass_ms`] has them: four digits, for they are many.
fn milliseconds(seconds: &[f64]) -> String {
    let text = |seconds: &f64| {
        let ms = 1e3 * seconds;
        format!("{ms:.3e}").parse().unwrap_or(ms).to_string()
    };
    seconds.iter().map(text).collect::<Vec<_>>().join(" ")
}

/// How much faster the second is than the first.
fn ratio(single: &[f64], times: &[f64]) -> Option<Ratio> {
    let (a, b) = (Summary::of(single)?, Summary::of(times)?);
    Some(Ratio::cautious((&a, single), (&b, times), 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::scalable;

    #[test]
    fn rounds_are_added_until_the_time_is_over() {
        let settings = |milliseconds| KernelSettings {
            cells: vec![Cell::new("lbvh", 8, &[])],
            path: PathSettings { width: 8, height: 8, ..PathSettings::default() },
            views: 1,
            rounds: 2,
            time: Duration::from_millis(milliseconds),
            threads: vec![1],
        };
        let [least, more] = [0, 200].map(|time| measure(&scalable(500, 1), &settings(time)).unwrap());
        assert!(!least.is_empty() && least.iter().all(|row| row.rounds == 2));
        assert!(more.iter().all(|row| row.rounds > 2 && row.passes().len() == row.rounds as usize));
        assert_eq!(milliseconds(&[0.001_234_56, 12.0]), "1.235 12000");
    }

    #[test]
    fn every_thread_gets_several_chunks() {
        let rays = 128 * 128;
        assert_eq!([1, 2, 64].map(|threads| chunk(rays, threads)), [2048, 1024, 64]);
        assert_eq!([0, 63, 64, 4000, 10_000_000].map(|rays| chunk(rays, 2)), [64, 64, 64, 192, CHUNK]);
        for (rays, threads) in [(16_384, 2), (40_000, 3), (1 << 22, 16)] {
            assert!(rays / chunk(rays, threads) >= CHUNKS * threads, "{rays} rays, {threads} threads");
        }
    }
}
