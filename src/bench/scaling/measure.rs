//! Builds by one thread, recorded, for each number of workers by turns; and beside them builds by as many threads,
//! where the machine has them.

use super::row::{ALL, SCHEMA, ScalingRow};
use super::simulate::{schedule, span, work};
use crate::bench::cell::Cell;
use crate::bench::environment::moment::utc_now;
use crate::bench::environment::{Machine, Program};
use crate::bench::statistics::{figures, median};
use crate::builders::{self, Builder};
use crate::parallel::timeline::{self, Step};
use crate::scene::Scene;
use rayon::ThreadPool;
use std::time::Instant;

/// What is measured.
#[derive(Clone, Debug)]
pub struct ScalingSettings {
    /// Builders of ours with the width of their trees.
    pub cells: Vec<Cell>,
    /// Numbers of workers.
    pub workers: Vec<usize>,
    /// Builds of each number of workers.
    pub rounds: usize,
    /// Threads of the machine: builds by more are not measured.
    pub most: usize,
}

/// Milliseconds of one phase in one round.
#[derive(Clone, Copy)]
struct Times {
    work: f64,
    span: f64,
    scheduled: f64,
}

/// All rounds of one number of workers.
#[derive(Default)]
struct Rounds {
    /// By phase, each round's.
    phases: Vec<(&'static str, Vec<Times>)>,
    measured: Vec<f64>,
}

/// Measures the builders on one scene, with new builders and new memory for each build.
///
/// # Errors
/// A builder that is not ours, threads that cannot be had, in one line.
pub fn measure(scene: &Scene, settings: &ScalingSettings) -> Result<Vec<ScalingRow>, String> {
    let about = ScalingRow {
        schema: SCHEMA,
        utc: utc_now(),
        git_rev: Program::this().git_rev,
        cpu: Machine::this("").cpu,
        scene: scene.name.clone(),
        triangles: scene.mesh.len() as u64,
        rounds: settings.rounds as u32,
        ..ScalingRow::default()
    };
    let mut rows = Vec::new();
    for cell in &settings.cells {
        let rounds = match cell.width {
            8 => rounds::<8>(scene, cell.made_by(), settings)?,
            _ => rounds::<4>(scene, cell.made_by(), settings)?,
        };
        for (rounds, &workers) in rounds.iter().zip(&settings.workers) {
            let about = ScalingRow {
                builder: cell.builder.clone(),
                width: cell.width,
                workers: workers as u32,
                ..about.clone()
            };
            rows.extend(rows_of(rounds, &about));
        }
    }
    Ok(rows)
}

fn rounds<const N: usize>(
    scene: &Scene,
    name: &str,
    settings: &ScalingSettings,
) -> Result<Vec<Rounds>, String> {
    let new = || {
        builders::by_name::<N>(name)
            .ok_or_else(|| format!("no builder of ours is called {name}; Embree's cannot be recorded"))
    };
    new()?;
    let alone = pool(1)?;
    let measured =
        settings.workers.iter().map(|&workers| (workers <= settings.most).then(|| pool(workers)).transpose());
    let measured: Vec<Option<ThreadPool>> = measured.collect::<Result<_, _>>()?;
    let mut all: Vec<Rounds> = settings.workers.iter().map(|_| Rounds::default()).collect();
    for round in 0..settings.rounds {
        for turn in 0..settings.workers.len() {
            let index = (turn + round) % settings.workers.len();
            let (workers, rounds) = (settings.workers[index], &mut all[index]);
            let mut builder = new()?;
            rounds
                .add(&alone.install(|| timeline::record(workers, || builder.build(&scene.mesh)).1), workers);
            if let Some(pool) = &measured[index] {
                rounds.measured.push(timed(pool, &mut *new()?, scene));
            }
        }
    }
    Ok(all)
}

fn pool(threads: usize) -> Result<ThreadPool, String> {
    let build = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    build.map_err(|error| format!("{threads} threads: {error}; give fewer --workers"))
}

/// Milliseconds of a build; the tree is freed after that.
fn timed<const N: usize>(pool: &ThreadPool, builder: &mut dyn Builder<N>, scene: &Scene) -> f64 {
    pool.install(|| {
        let start = Instant::now();
        let build = builder.build(&scene.mesh);
        let seconds = start.elapsed().as_secs_f64();
        drop(build);
        1e3 * seconds
    })
}

impl Rounds {
    fn add(&mut self, steps: &[Step], workers: usize) {
        let mut first = 0;
        for (end, step) in steps.iter().enumerate() {
            if let Step::Phase(name) = step {
                let phase = &steps[first..end];
                let [work, span, scheduled] =
                    [work(phase), span(phase), schedule(phase, workers)].map(|s| 1e3 * s);
                let times = Times { work, span, scheduled };
                match self.phases.iter_mut().find(|(known, _)| known == name) {
                    Some((_, rounds)) => rounds.push(times),
                    None => self.phases.push((name, vec![times])),
                }
                first = end;
            }
        }
    }
}

/// A row for the whole build and one for each phase.
fn rows_of<'a>(rounds: &'a Rounds, about: &'a ScalingRow) -> impl Iterator<Item = ScalingRow> + 'a {
    let count = rounds.phases.first().map_or(0, |(_, times)| times.len());
    let sum = |round: usize| {
        let of_round = rounds.phases.iter().filter_map(move |(_, times)| times.get(round));
        of_round.fold(Times { work: 0.0, span: 0.0, scheduled: 0.0 }, |all, one| Times {
            work: all.work + one.work,
            span: all.span + one.span,
            scheduled: all.scheduled + one.scheduled,
        })
    };
    let whole = (ALL, (0..count).map(sum).collect::<Vec<_>>());
    std::iter::once(whole).chain(rounds.phases.iter().cloned()).map(|(phase, times)| {
        let of = |part: fn(&Times) -> f64| {
            median(&times.iter().map(part).collect::<Vec<_>>()).map_or(0.0, figures)
        };
        let measured = (phase == ALL).then(|| median(&rounds.measured).map(figures)).flatten();
        ScalingRow {
            phase: phase.into(),
            work_ms: of(|times| times.work),
            span_ms: of(|times| times.span),
            scheduled_ms: of(|times| times.scheduled),
            measured_ms: measured,
            ..about.clone()
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{generator, scalable};

    #[test]
    fn every_builder_of_ours_is_scheduled() {
        let scene = scalable(20_000, 1);
        let names = ["lbvh", "phr-fast", "phr-best", "aac", "hunt-50"];
        let settings = ScalingSettings {
            cells: names.iter().flat_map(|name| [4, 8].map(|width| Cell::new(name, width, &[]))).collect(),
            workers: vec![1, 2, 64],
            rounds: 1,
            most: 2,
        };
        let rows = measure(&scene, &settings).unwrap();
        let whole: Vec<&ScalingRow> = rows.iter().filter(|row| row.phase == ALL).collect();
        assert_eq!(whole.len(), names.len() * 2 * 3);
        for row in whole {
            let slack = 1.0 + 1e-5;
            assert!(
                row.span_ms <= row.scheduled_ms * slack && row.scheduled_ms <= row.work_ms * slack,
                "{row:?}"
            );
            assert_eq!(row.measured_ms.is_some(), row.workers <= 2);
        }
        assert!(rows.iter().any(|row| row.phase == "sort" && row.scheduled_ms > 0.0));
    }

    #[test]
    fn others_builders_are_refused() {
        let scene = generator("rooms").unwrap().generate();
        let cells = vec![Cell::new("embree-sah", 4, &[])];
        let settings = ScalingSettings { cells, workers: vec![1], rounds: 1, most: 1 };
        assert!(measure(&scene, &settings).unwrap_err().contains("embree-sah"));
    }
}
