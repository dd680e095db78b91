//! A model of total times from facts of the mesh, without tracing a ray: for each tree the logarithms of its build
//! time per triangle and of its time per ray are linear in the logarithms of a few facts, by ridge regression over
//! the scenes of a run ([`fit`], [`choose`]). Few scenes bear few parameters: which facts, and how strongly weights
//! are held down, is chosen by leaving one scene out at a time ([`judge`], [`judged`]); [`judged_files`] judges
//! advice that was measured likewise, beside what could be reached ([`perfect`]).
//! The times are those of the machine of that run.

pub mod choose;
pub mod facts;
pub mod fit;
pub mod judge;
pub mod judged;
pub mod judged_files;
pub mod observed;
pub mod perfect;

use super::{Advice, Known};
use crate::bench::files::{RecordsError, read_json};
use crate::bench::quick::line::{Estimate, TotalTime};
use facts::{Fact, SceneFacts};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the file.
pub const SCHEMA: u32 = 1;

/// The model that this program carries, made by `phr advise --fit`.
const COMMITTED: &str = include_str!("model.json");

/// How many deviations of a fact a scene may be from the mean of the model's scenes before that is told: they
/// themselves are up to 2.6.
const FAR: f64 = 2.7;

/// A fitted model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The run that it was fitted to.
    pub run_id: String,
    /// Kernel of the traces.
    pub kernel: String,
    /// Threads of builds and traces.
    pub threads: u32,
    /// Scenes of the run.
    pub scenes: usize,
    /// How strongly weights are held down: as much as so many times the scenes' own say.
    pub ridge: f64,
    /// The facts in use, with mean and deviation of their logarithms over the scenes.
    pub facts: Vec<Scale>,
    /// The number of triangles likewise, in use or not: a scene of another size is unlike the model's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Scale>,
    /// The trees.
    pub trees: Vec<TreeModel>,
}

/// A fact in use.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scale {
    /// The fact.
    pub fact: Fact,
    /// Mean of its logarithm.
    pub mean: f64,
    /// Deviation of its logarithm.
    pub deviation: f64,
}

impl Scale {
    /// How many deviations of the model's scenes lie between their mean and a scene.
    fn of(&self, facts: &SceneFacts) -> f64 {
        (facts.log(self.fact) - self.mean) / self.deviation
    }
}

/// The model of one tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeModel {
    /// The builder.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Build time, ns per triangle.
    pub build: Fitted,
    /// Time per ray, ns.
    pub ray: Fitted,
}

/// The logarithm of a figure as a linear function of scaled facts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fitted {
    /// The constant, then one weight per fact.
    pub weights: Vec<f64>,
    /// Half the 95 % interval of the logarithm in a scene that the model was not fitted to.
    pub error: f64,
}

impl Fitted {
    fn at(&self, scaled: &[f64]) -> Estimate {
        let log: f64 = self.weights.iter().zip(scaled).map(|(weight, x)| weight * x).sum();
        Estimate { value: log.exp(), low: (log - self.error).exp(), high: (log + self.error).exp() }
    }
}

impl Model {
    /// The committed model.
    pub fn committed() -> Self {
        serde_json::from_str(COMMITTED).expect("the committed model is one, as a test tells")
    }

    /// Reads a model.
    ///
    /// # Errors
    /// A file of another content.
    pub fn read(path: &Path) -> Result<Self, RecordsError> {
        let remedy = "make one with `phr advise --fit RESULTS --model FILE`";
        let model: Self = read_json(path, remedy)?;
        if model.schema == SCHEMA {
            return Ok(model);
        }
        Err(RecordsError::Schema { path: path.into(), found: model.schema, expected: SCHEMA, remedy })
    }

    /// The facts that it needs.
    pub fn needs(&self) -> Vec<Fact> {
        self.facts.iter().map(|scale| scale.fact).collect()
    }

    /// The text of its file.
    pub fn file(&self) -> String {
        serde_json::to_string_pretty(self).expect("a model is plain data") + "\n"
    }

    /// The facts scaled as the weights want them, after the 1 of the constant.
    fn scaled(&self, facts: &SceneFacts) -> Vec<f64> {
        std::iter::once(1.0).chain(self.facts.iter().map(|scale| scale.of(facts))).collect()
    }

    /// What of a scene is far from the model's scenes, in words: beyond them lines are drawn, not known.
    fn remark(&self, facts: &SceneFacts) -> String {
        let others = self.facts.iter().filter(|scale| scale.fact != Fact::Triangles);
        let size = self.facts.iter().chain(&self.size).find(|scale| scale.fact == Fact::Triangles);
        let far: Vec<String> = size
            .into_iter()
            .chain(others)
            .filter(|scale| scale.of(facts).abs() > FAR)
            .map(|scale| {
                let side = if scale.of(facts) < 0.0 { "below" } else { "above" };
                format!("{} far {side} its scenes' mean of {:.1e}", scale.fact.name(), scale.mean.exp())
            })
            .collect();
        if far.is_empty() { String::new() } else { format!("; a guess: {}", far.join(", ")) }
    }

    /// The total times of all trees, in the model's order.
    pub fn lines(&self, facts: &SceneFacts) -> Vec<TotalTime> {
        let scaled = self.scaled(facts);
        let line = |tree: &TreeModel| {
            let per_triangle = tree.build.at(&scaled);
            let ms = |ns: f64| 1e-6 * ns * facts.triangles;
            let build_ms = Estimate {
                value: ms(per_triangle.value),
                low: ms(per_triangle.low),
                high: ms(per_triangle.high),
            };
            TotalTime { build_ms, ns_per_ray: tree.ray.at(&scaled) }
        };
        self.trees.iter().map(line).collect()
    }

    /// Advice for a mesh of such facts; trees of `widths` only.
    pub fn advise(&self, scene: &str, facts: &SceneFacts, rays: f64, widths: &[u32]) -> Advice {
        let known = |(tree, line): (&TreeModel, TotalTime)| Known {
            builder: tree.builder.clone(),
            width: tree.width,
            line: Some(line),
            traced: None,
            rounds: 0,
            note: String::new(),
        };
        let trees = self.trees.iter().zip(self.lines(facts)).map(known);
        Advice {
            scene: scene.into(),
            triangles: facts.triangles as usize,
            rays,
            origin: format!(
                "not measured: a model of {} scenes, {} threads of the machine of run {}, {}{}",
                self.scenes,
                self.threads,
                self.run_id,
                self.kernel,
                self.remark(facts)
            ),
            kernel: self.kernel.clone(),
            busy: 0.0,
            trees: trees.filter(|known| widths.contains(&known.width)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use observed::KERNEL;

    #[test]
    fn the_committed_model_is_that_of_the_committed_rows() {
        let rows = crate::bench::row::read(Path::new("results/reference")).unwrap();
        let made = choose::model_of(&rows).unwrap();
        assert_eq!(made.file(), COMMITTED, "run phr advise --fit results/reference");
        assert_eq!(Model::committed().kernel, KERNEL);
    }

    #[test]
    fn a_scene_unlike_those_of_the_model_is_told() {
        let model = Model::committed();
        let origin = |triangles: f64| {
            let facts = SceneFacts { triangles, sah: 40.0, epo: 5.0, leaf_fill: 0.75 };
            model.advise("a", &facts, 1e8, &[4]).origin
        };
        let [small, usual, large] = [12.0, 5e5, 5e8].map(origin);
        assert!(small.contains("; a guess: triangles far below its scenes' mean of 4."), "{small}");
        assert!(!usual.contains("guess"), "{usual}");
        assert!(large.contains("triangles far above"), "{large}");
    }

    #[test]
    fn a_model_advises_by_width() {
        let model = Model::committed();
        let facts = SceneFacts { triangles: 2e5, sah: 40.0, epo: 5.0, leaf_fill: 0.75 };
        let advice = model.advise("a", &facts, 1e8, &[4]);
        assert!(advice.trees.len() > 8 && advice.trees.iter().all(|known| known.width == 4));
        assert!(advice.winners().len() > 1, "nothing is best for any number of rays");
        let (best, _) = advice.best_at(1e8).unwrap();
        assert!(best.builder.starts_with("phr-"), "{best:?}");
    }
}
