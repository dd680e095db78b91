//! Advice from a quick measurement of the scene itself.

use super::model::Model;
use super::model::facts::SceneFacts;
use super::{Advice, Known, rays_in_words};
use crate::bench::cell::{Cell, Kernel};
use crate::bench::quick::quickly;
use crate::bench::quick::survey::{BUDGETS, Candidate, survey};
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// A tree that a model has nowhere within this factor of the best is measured late.
const PROSPECT: f64 = 1.15;

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
        let surveyed = quickly(scene, (threads, kernel, 1), |quick| {
            let facts = SceneFacts::of(&scene.mesh, &model.needs());
            let candidates = self.candidates(model, &facts);
            survey(quick, &candidates, (start, self.limit), &mut |round, cell| {
                progress(&format!("round {}: {}/{}", round + 1, cell.builder, cell.width));
            })
        })?;
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
            trees: Known::of_survey(&surveyed),
        })
    }

    /// The trees in the order of their prospects by the model: how near to the best they come for some number of rays.
    /// Of trees that it does not know, changed ones among them, nothing is expected, and they come first.
    fn candidates(&self, model: &Model, facts: &SceneFacts) -> Vec<Candidate> {
        let lines = model.lines(facts);
        let best = |rays: f64| lines.iter().map(|line| line.at(rays)).fold(f64::INFINITY, f64::min);
        let best = BUDGETS.map(best);
        let mut found: Vec<(f64, Candidate)> = Vec::new();
        for cell in &self.cells {
            let is_of =
                |tree: &super::model::TreeModel| tree.builder == cell.builder && tree.width == cell.width;
            let line = model.trees.iter().position(is_of).map(|i| lines[i]);
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
                Candidate { cell: cell.clone(), expected_ms, has_prospect: prospect <= PROSPECT },
            ));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, candidate)| candidate).collect()
    }
}
