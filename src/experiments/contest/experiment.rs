//! What makes an experiment: its builders, which are compared, and what the paper leads to expect.

use crate::report::figures::Figure;

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
    /// Lines through some of them in a plot of build time against trace time, where that is drawn.
    pub families: Option<fn() -> Families>,
}

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
    /// The figure of the changed builder, relative to the base.
    pub figure: Figure,
    /// Where its mean over scenes is then.
    pub range: (f64, f64),
    /// The paper's scenes, or stand-ins for them, of which it is said; all if empty.
    pub scenes: &'static [&'static str],
}

/// Lines in a plot.
#[derive(Clone, Debug)]
pub struct Families {
    /// The builder that ratios are to.
    pub base: String,
    /// Each with its name and its builders, each with a short label.
    pub lines: Vec<(String, Vec<(String, String)>)>,
}
