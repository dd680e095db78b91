//! What makes an experiment: its builders, which are compared, and what the paper leads to expect.

use crate::bench::row::Row;
use crate::bench::statistics::geometric_mean;
use crate::report::figures::{Figure, Under};
use crate::report::paper::{self, PaperRow};

/// An experiment.
pub struct Experiment {
    /// Name on the command line, and of its folder.
    pub name: &'static str,
    /// Section of the paper.
    pub section: &'static str,
    /// What is asked, for headings.
    pub about: &'static str,
    /// What the paper says, in our words.
    pub paper: &'static str,
    /// What the figures cannot tell; may be empty.
    pub caveat: &'static str,
    /// The builders, by the names of [`Recipe`](crate::builders::Recipe).
    pub entrants: fn() -> Vec<String>,
    /// Which of them are compared with which.
    pub comparisons: fn() -> Vec<Comparison>,
    /// By what they are compared.
    pub figures: &'static [Figure],
    /// Lines through some of them in plots of build time against steps and trace time, where those are drawn.
    pub families: Option<fn() -> Families>,
    /// What their rows tell beyond comparisons of two, over trees of a width, in words.
    pub more: Option<More>,
}

/// Text from rows, over trees of a width, with traces under a kernel.
pub type More = fn(&[Row], u32, &Under) -> String;

/// A builder beside another.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The builder that differs.
    pub changed: String,
    /// From this one.
    pub base: String,
    /// What the paper leads to expect.
    pub expected: Vec<Expectation>,
}

/// A statement that a mean ratio can hold or refute.
#[derive(Clone, Copy, Debug)]
pub struct Expectation {
    /// In words, after "that".
    pub says: &'static str,
    /// The figure of the changed builder, relative to the base. A statement of traces is judged by their steps too.
    pub figure: Figure,
    /// Where its mean over scenes is then.
    pub range: (f64, f64),
    /// The scenes of which it is said.
    pub among: Among,
}

/// Scenes of which something is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Among {
    /// All of a run.
    All,
    /// These of the paper's scenes, or stand-ins for them.
    Paper(&'static [&'static str]),
    /// Those of a kind, by name.
    Kind(&'static [&'static str]),
    /// Those of so many triangles and more.
    From(u64),
}

impl Among {
    /// Whether a scene of a name and a number of triangles is one.
    pub fn has(self, scene: &str, triangles: u64) -> bool {
        match self {
            Self::All => true,
            Self::Paper(names) => paper::scene_of(scene).is_some_and(|name| names.contains(&name.as_str())),
            Self::Kind(names) => names.contains(&scene),
            Self::From(least) => triangles >= least,
        }
    }

    /// The paper's own mean ratio of `figure` over those of its scenes; `None` if it has none.
    pub fn of_paper(self, comparison: &Comparison, figure: Figure) -> Option<f64> {
        let is_one = |row: &PaperRow| match self {
            Self::All => true,
            Self::Paper(names) => names.contains(&&*row.scene),
            Self::Kind(names) => names.iter().any(|name| paper::scene_of(name).as_ref() == Some(&row.scene)),
            Self::From(least) => 1000 * row.kilotriangles >= least,
        };
        let all = paper::ratios_to(&comparison.base, &comparison.changed, figure);
        let ratios: Vec<f64> =
            all.into_iter().filter(|(row, _)| is_one(row)).map(|(_, ratio)| ratio).collect();
        geometric_mean(&ratios)
    }
}

/// Lines in a plot.
#[derive(Clone, Debug)]
pub struct Families {
    /// The builder that ratios are to.
    pub base: String,
    /// Each with its name and its builders, each with a short label.
    pub lines: Vec<(String, Vec<(String, String)>)>,
}
