//! The ratios of a comparison over the scenes of a run.

use super::experiment::Comparison;
use crate::bench::row::Row;
use crate::report::figures::interval::{Interval, Over};
use crate::report::figures::{Figure, Under};
use crate::report::means::Ratios;
use crate::report::paper;

/// The figures that experiments compare, with their names.
pub const FIGURES: [(&str, Figure); 3] =
    [("build", Figure::Build), ("SAH cost", Figure::Cost), ("trace", Figure::Trace)];

/// The ratios of a comparison.
pub struct Compared<'a> {
    /// What is compared.
    pub comparison: &'a Comparison,
    /// Ratios by scene, in the order of [`FIGURES`].
    pub ratios: [Ratios; 3],
}

/// A mean with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// The geometric mean over scenes.
    pub value: f64,
    /// Over scenes and rounds, or over rounds where there is one scene; nothing where too little is known.
    pub interval: Option<Interval>,
}

impl<'a> Compared<'a> {
    /// The ratios of trees of `width`; `None` if the rows have no figure of both builders.
    pub fn of(comparison: &'a Comparison, rows: &[Row], width: u32, under: &Under) -> Option<Self> {
        let (changed, base) = ((comparison.changed.as_str(), width), (comparison.base.as_str(), width));
        let ratios = FIGURES.map(|(_, figure)| Ratios::to(base, rows, changed, figure, under));
        ratios.iter().any(|ratios| !ratios.0.is_empty()).then_some(Self { comparison, ratios })
    }

    /// The ratios of `figure`, one of [`FIGURES`].
    pub fn of_figure(&self, figure: Figure) -> &Ratios {
        let place = FIGURES.iter().position(|(_, known)| *known == figure);
        &self.ratios[place.unwrap_or(0)]
    }
}

impl Mean {
    /// The mean of some ratios; `None` of none.
    pub fn of(ratios: &Ratios) -> Option<Self> {
        let over = if ratios.0.len() > 1 { Over::ScenesAndRounds } else { Over::Rounds };
        let interval = ratios.interval(over).filter(|interval| interval.high.is_finite());
        Some(Self { value: ratios.geometric()?, interval })
    }

    /// The mean over those of the paper's scenes, or stand-ins for them, and what is sure of these very scenes; `None` if
    /// there are none of them.
    pub fn in_scenes(ratios: &Ratios, scenes: &[&str]) -> Option<Self> {
        let is_one = |name: &str| paper::scene_of(name).is_some_and(|scene| scenes.contains(&scene.as_str()));
        let those = Ratios(ratios.0.iter().filter(|ratio| is_one(&ratio.scene)).cloned().collect());
        let interval = those.interval(Over::Rounds).filter(|interval| interval.high.is_finite());
        Some(Self { value: those.geometric()?, interval })
    }

    /// As `0.93 [0.90, 0.96]`.
    pub fn shown(&self) -> String {
        let interval = self.interval.map_or_else(|| "[?]".into(), |interval| interval.shown(2));
        format!("{:.2} {interval}", self.value)
    }

    /// Whether the mean is within a range: the whole interval is, or none of it, or that is not known.
    pub fn verdict(&self, (least, most): (f64, f64)) -> &'static str {
        match self.interval {
            None => "is undecided",
            Some(Interval { low, high }) if least <= low && high <= most => "holds",
            Some(Interval { low, high }) if high < least || most < low => "does not hold",
            Some(_) => "is undecided",
        }
    }
}
