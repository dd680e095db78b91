//! A sentence of the verdict, in parts, so that a page may set names and intervals apart.

use super::field::Field;
use crate::report::figures::interval::LEAST_ROUNDS;
use crate::report::figures::{Figure, Tree, Under, tree_name};

/// A part of a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// The name of a tree.
    Name(String),
    /// The 95 % interval of the figure before it.
    Interval(String),
    /// Other words.
    Words(String),
}

impl Part {
    /// Its text.
    pub fn text(&self) -> &str {
        match self {
            Self::Name(text) | Self::Interval(text) | Self::Words(text) => text,
        }
    }
}

/// A sentence.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sentence(pub Vec<Part>);

impl Sentence {
    pub(super) fn name(mut self, tree: Tree<'_>) -> Self {
        self.0.push(Part::Name(tree_name(tree)));
        self
    }

    pub(super) fn words(mut self, words: impl Into<String>) -> Self {
        self.0.push(Part::Words(words.into()));
        self
    }

    /// A mean with its interval, or a scene's ratio with that over rounds; the base's is 1.
    pub(super) fn ratio(mut self, field: &Field<'_>, tree: Tree<'_>, figure: Figure, under: &Under) -> Self {
        let ratios = field.ratios(tree, figure, under);
        let mean = ratios.geometric().map_or_else(|| "?".into(), |mean| format!("{mean:.2}"));
        self.0.push(Part::Words(mean));
        if let Some(interval) = ratios.interval(ratios.over()).filter(|_| tree != field.base) {
            self.0.push(Part::Interval(format!(" {}", interval.shown(2))));
        }
        self
    }

    /// Which trees are not told apart from the best.
    pub(super) fn rivals(self, field: &Field<'_>, best: Tree<'_>, figure: Figure, under: &Under) -> Self {
        let Some(rivals) = field.rivals(best, figure, under) else {
            return self.words(format!("; {LEAST_ROUNDS} rounds at least would tell how sure that is"));
        };
        match rivals[..] {
            [] => self,
            [rival] => self.words("; not told apart from it is ").name(rival),
            [nearest, ref others @ ..] => {
                let and = format!(" and {} more", others.len());
                self.words("; not told apart from it are ").name(nearest).words(and)
            }
        }
    }

    /// As plain text.
    pub fn text(&self) -> String {
        self.0.iter().map(Part::text).collect()
    }
}
