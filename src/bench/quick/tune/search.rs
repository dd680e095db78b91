//! The search itself: the builders of the space, proposals, a race of the best, and a last measurement with other rays.

use super::proposals::Proposals;
use super::space::{Point, Space, width_of};
use super::{Pair, Trial, Tuned, mean_ratios};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::quick::{Quick, quickly};
use crate::builders::Recipe;
use crate::random::SplitMix64;
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// Configurations in the race, at least and at most: as many as there is time for.
const RACERS: [usize; 2] = [2, 5];
/// Shares of the time: until the race begins, and until it ends.
const RACE: [f64; 2] = [0.6, 0.8];
/// Rounds of the race, and of the last measurement, at least.
const ROUNDS: usize = 3;

/// What is searched, and how long.
#[derive(Clone, Debug)]
pub struct Search {
    /// The parameters, and what all is relative to.
    pub space: Space,
    /// The number of rays that a tree is for.
    pub rays: f64,
    /// Children per node, where they are given.
    pub width: Option<u32>,
    /// What traces.
    pub kernel: Kernel,
    /// Threads of builds and traces.
    pub threads: usize,
    /// Time for everything, from the loaded scene on. A trial, the least race and the least last measurement, some
    /// twenty visits, are made whatever the time.
    pub limit: Duration,
    /// Determines the proposals and the rays.
    pub seed: u64,
}

impl Search {
    /// Searches for `scene`; tells `progress` what is done.
    ///
    /// # Errors
    /// No threads, no reference tree, no time for a trial, or an anchor that fails, in one line.
    pub fn run(&self, scene: &Scene, progress: &mut dyn FnMut(&str)) -> Result<Tuned, String> {
        let start = Instant::now();
        let until = |share: f64| start + self.limit.mul_f64(share);
        // 8-wide trees are the faster ones: the harder anchor.
        let anchor = self.cell(&recipe(self.space.anchor), self.width.unwrap_or(8));
        let under = |seed| (self.threads, self.kernel, seed);
        let searched = quickly(scene, under(self.seed), |quick| {
            let (trials, mut failures) = self.trials(quick, &anchor, until(RACE[0]), progress)?;
            let race = self.race(quick, &anchor, (&trials, &mut failures), until(RACE[1]), progress)?;
            Ok::<_, String>((trials, failures, race))
        })??;
        let (trials, mut failures, race) = searched;
        let best = race.first().ok_or_else(|| nothing(scene, self.limit, &failures))?;
        let mut fresh = vec![Trial { pairs: Vec::new(), ..best.clone() }];
        quickly(scene, under(self.seed + 1), |quick| {
            self.rounds(quick, &anchor, (&mut fresh, &mut failures), until(1.0), &mut |round| {
                progress(&format!("the best again with other rays, round {}", round + 1));
            })
        })??;
        let fresh = fresh.pop().ok_or_else(|| nothing(scene, self.limit, &failures))?;
        Ok(Tuned { anchor, trials, failures, race, fresh })
    }

    fn cell(&self, recipe: &Recipe, width: u32) -> Cell {
        Cell::new(&recipe.name(), width, &[self.kernel])
    }

    /// The builders of the space, then proposals until the time is over; those that failed apart.
    #[allow(clippy::type_complexity)]
    fn trials(
        &self,
        quick: &mut Quick<'_>,
        anchor: &Cell,
        until: Instant,
        progress: &mut dyn FnMut(&str),
    ) -> Result<(Vec<Trial>, Vec<(String, String)>), String> {
        let widths: Vec<u32> = self.width.map_or_else(|| vec![8, 4], |width| vec![width]);
        let builders =
            widths.iter().flat_map(|&width| self.space.builders.iter().map(move |builder| (*builder, width)));
        let mut queue: Vec<(Recipe, Point)> =
            builders.map(|(builder, width)| (recipe(builder), self.space.point_of(builder, width))).collect();
        queue.reverse();
        let fixed = self.width.map(|_| (0, self.space.point_of(self.space.anchor, widths[0])[0]));
        let mut proposals = Proposals::new(self.space, self.seed, fixed.into_iter().collect());
        let (mut trials, mut failures): (Vec<Trial>, Vec<(String, String)>) = (Vec::new(), Vec::new());
        // Memory, threads and code are warm after one visit.
        quick.visit(anchor)?;
        while Instant::now() < until {
            let (recipe, point) = queue.pop().unwrap_or_else(|| {
                let point = proposals.propose();
                (self.space.recipe_of(&point), point)
            });
            let cell = self.cell(&recipe, width_of(&point));
            let best = trials.iter().map(|trial| self.total(trial)).fold(f64::INFINITY, f64::min);
            progress(&format!("trial {}, the best so far {best:.3}", trials.len() + failures.len() + 1));
            let before = quick.visit(anchor)?;
            match quick.visit(&cell) {
                Ok(tried) => {
                    let trial = Trial { cell, recipe, pairs: vec![Pair { tried, anchor: before }] };
                    proposals.tell(&point, self.total(&trial).ln());
                    trials.push(trial);
                }
                Err(reason) => {
                    proposals.tell(&point, f64::INFINITY);
                    failures.push((name(&cell), reason));
                }
            }
        }
        Ok((trials, failures))
    }

    fn total(&self, trial: &Trial) -> f64 {
        mean_ratios(&trial.pairs, self.rays)[2].value
    }

    /// The best of the trials by turns; the best of the race first. Those that fail go to the failures.
    fn race(
        &self,
        quick: &mut Quick<'_>,
        anchor: &Cell,
        (trials, failures): (&[Trial], &mut Vec<(String, String)>),
        until: Instant,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Vec<Trial>, String> {
        // As long as the trials took.
        let pair = self.limit.mul_f64(RACE[0]) / trials.len().max(1) as u32;
        let pairs = until.saturating_duration_since(Instant::now()).div_duration_f64(pair) as usize;
        let count = (pairs / ROUNDS).clamp(RACERS[0], RACERS[1]);
        let mut sorted: Vec<&Trial> = trials.iter().collect();
        sorted.sort_by(|a, b| self.total(a).total_cmp(&self.total(b)));
        let mut racers: Vec<Trial> = Vec::new();
        for trial in sorted {
            if racers.len() < count && !racers.iter().any(|racer| racer.cell == trial.cell) {
                racers.push(Trial { pairs: Vec::new(), ..trial.clone() });
            }
        }
        self.rounds(quick, anchor, (&mut racers, failures), until, &mut |round| {
            progress(&format!("race of the best, round {}", round + 1));
        })?;
        racers.sort_by(|a, b| self.total(a).total_cmp(&self.total(b)));
        Ok(racers)
    }

    /// Measures each of `racers` after the anchor, in random order within a round, until the time is over. Who
    /// fails has lost.
    fn rounds(
        &self,
        quick: &mut Quick<'_>,
        anchor: &Cell,
        (racers, failures): (&mut Vec<Trial>, &mut Vec<(String, String)>),
        until: Instant,
        progress: &mut dyn FnMut(usize),
    ) -> Result<(), String> {
        let mut random = SplitMix64::new(self.seed);
        // Memory, threads and code of a new reference tree are warm after one visit.
        quick.visit(anchor)?;
        for round in 0.. {
            if racers.is_empty() || round >= ROUNDS && Instant::now() >= until {
                break;
            }
            progress(round);
            let mut order: Vec<usize> = (0..racers.len()).collect();
            random.shuffle(&mut order);
            for i in order {
                let before = quick.visit(anchor)?;
                match quick.visit(&racers[i].cell) {
                    Ok(tried) => racers[i].pairs.push(Pair { tried, anchor: before }),
                    Err(reason) => failures.push((name(&racers[i].cell), reason)),
                }
            }
            racers.retain(|racer| racer.pairs.len() > round);
        }
        Ok(())
    }
}

fn name(cell: &Cell) -> String {
    format!("{} / {}", cell.builder, cell.width)
}

fn nothing(scene: &Scene, limit: Duration, failures: &[(String, String)]) -> String {
    match failures.first() {
        Some((name, reason)) => format!("{}: every configuration failed, first {name}: {reason}", scene.name),
        None => format!(
            "{}: no configuration was tried in {} s; give more --seconds",
            scene.name,
            limit.as_secs()
        ),
    }
}

fn recipe(name: &str) -> Recipe {
    Recipe::of(name).expect("a name of the list")
}
