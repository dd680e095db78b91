//! Advice from a quick measurement of the scene itself.

use super::model::Model;
use super::model::facts::SceneFacts;
use super::{Advice, Known, NEAR, rays_in_words};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::cpu_time::CpuClock;
use crate::bench::quick::line::TotalTime;
use crate::bench::quick::survey::{BUDGETS, Candidate, Contest, Surveyed, Visitor, survey};
use crate::bench::quick::{Quick, QuickVisit, quickly};
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// How a scene is measured.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The trees.
    pub cells: Vec<Cell>,
    /// The number of rays asked for.
    pub rays: f64,
    /// What traces them.
    pub kernel: Kernel,
    /// Threads of builds and traces.
    pub threads: usize,
    /// When to stop, counted from the loaded scene.
    pub limit: Duration,
}

/// The total times by which trees compete: those of the advice.
pub(super) fn lines(found: &[Surveyed]) -> Vec<Option<TotalTime>> {
    Known::of_survey(found).into_iter().map(|known| known.line).collect()
}

/// Real visits, told to `progress` beforehand.
struct Timed<'a, 'b> {
    quick: &'a mut Quick<'b>,
    start: Instant,
    progress: &'a mut dyn FnMut(&str),
}

impl Visitor for Timed<'_, '_> {
    fn visit(
        &mut self,
        round: usize,
        cell: &Cell,
        counts: bool,
    ) -> Result<(QuickVisit, Option<f64>), String> {
        (self.progress)(&format!("round {}: {}/{}", round + 1, cell.builder, cell.width));
        if counts {
            self.quick.visit_and_count(cell)
        } else {
            self.quick.visit(cell).map(|visit| (visit, None))
        }
    }

    fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }
}

impl Measurement {
    /// Measures `scene`, the trees that `model` takes for the best first; tells `progress` what is done.
    ///
    /// # Errors
    /// No threads, or no reference tree, in one line.
    pub fn advise(
        &self,
        scene: &Scene,
        model: &Model,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Advice, String> {
        let start = Instant::now();
        progress("reference tree and rays");
        let (threads, kernel) = (self.threads, self.kernel);
        let (surveyed, time) = quickly(scene, (threads, kernel, 1), |quick| {
            let facts = SceneFacts::of(&scene.mesh, &model.needs());
            let candidates = self.candidates(model, &facts);
            let budgets = BUDGETS.into_iter().chain([self.rays]).collect();
            let contest = Contest { limit: self.limit, budgets, estimate: &lines };
            let clock = CpuClock::read();
            let surveyed =
                survey(&mut Timed { quick, start, progress: &mut *progress }, &candidates, &contest);
            (surveyed, clock.since())
        })?;
        // More threads than processors wait for one another.
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let busy = if threads > processors { 0.0 } else { time.waiting() };
        let rounds = surveyed.iter().map(|one| one.visits.len()).max().unwrap_or_default();
        let seconds = start.elapsed().as_secs_f64();
        Ok(Advice {
            scene: scene.name.clone(),
            triangles: scene.mesh.len(),
            rays: self.rays,
            origin: format!(
                "measured in {seconds:.0} s, up to {rounds} rounds, {threads} threads, {}; asked for {} rays",
                kernel.name(),
                rays_in_words(self.rays)
            ),
            kernel: kernel.name().into(),
            busy,
            trees: Known::of_survey(&surveyed),
        })
    }

    /// The trees in the order of their prospects by the model: how near to the best they come for some number of rays.
    /// Those that are nowhere within [`NEAR`] are measured late: time is short, and most trees never win.
    /// Of trees that it does not know, changed ones among them, nothing is expected, and they come first.
    fn candidates(&self, model: &Model, facts: &SceneFacts) -> Vec<Candidate> {
        let lines = model.lines(facts);
        let line_of = |cell: &Cell| {
            let is_of =
                |tree: &super::model::TreeModel| tree.builder == cell.builder && tree.width == cell.width;
            model.trees.iter().position(is_of).map(|i| lines[i])
        };
        // The best of those asked for, not of all that the model knows.
        let asked: Vec<_> = self.cells.iter().filter_map(line_of).collect();
        let best = |rays: f64| asked.iter().map(|line| line.at(rays)).fold(f64::INFINITY, f64::min);
        let best = BUDGETS.map(best);
        let mut found: Vec<(f64, Candidate)> = Vec::new();
        for cell in &self.cells {
            let line = line_of(cell);
            let prospect = line.map_or(0.0, |line| {
                BUDGETS
                    .iter()
                    .zip(best)
                    .map(|(&rays, best)| line.at(rays) / best)
                    .fold(f64::INFINITY, f64::min)
            });
            let expected_ms = line.map_or(0.0, |line| line.build_ms.value);
            found.push((
                prospect,
                Candidate { cell: cell.clone(), expected_ms, has_prospect: prospect <= NEAR },
            ));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, candidate)| candidate).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::advice::model::choose::{Choice, choose};
    use crate::report::advice::model::fit::weights;
    use crate::report::advice::model::observed::{Observed, observed};

    /// In scenes that the model has not seen: METHODOLOGY has the figures.
    #[test]
    fn among_the_trees_measured_first_one_is_near_the_best() {
        let rows = crate::bench::row::read(std::path::Path::new("results/advice")).unwrap();
        let scenes = observed(&rows);
        let Choice { facts, ridge } = choose(&scenes);
        let (mut pairs, mut most, mut missed) = (0, 0, Vec::new());
        for (out, scene) in scenes.iter().enumerate() {
            let others = scenes.iter().enumerate().filter(|(i, _)| *i != out).map(|(_, scene)| scene);
            let model = weights(&others.collect::<Vec<&Observed>>(), &facts, ridge);
            let cell = |(builder, width): &(String, u32)| Cell::new(builder, *width, &[]);
            let cells: Vec<Cell> = scene.trees.iter().map(cell).collect();
            let measurement = Measurement {
                cells: cells.clone(),
                rays: 1e8,
                kernel: Kernel::Phr,
                threads: 1,
                limit: Duration::ZERO,
            };
            let mut first = measurement.candidates(&model, &scene.facts);
            first.retain(|candidate| candidate.has_prospect);
            most = most.max(first.len());
            for rays in BUDGETS {
                let is_first = |tree: &usize| first.iter().any(|candidate| candidate.cell == cells[*tree]);
                let mut firsts = (0..cells.len()).filter(is_first);
                pairs += 1;
                if !firsts.any(|tree| scene.ratio(tree, rays) <= NEAR) {
                    missed.push((scene.scene.as_str(), rays));
                }
            }
        }
        // Were all trees among them, they would be no choice.
        assert!(most <= 8 && missed.len() <= pairs / 50, "{most} of {pairs}: {missed:?}");
    }
}
