//! Families of builders as the page reads them: those of the plots with the shape as a word.

use crate::report::plot::families::{self, FAMILIES, OTHERS};
use crate::report::plot::svg::Shape;
use serde::Serialize;

/// A family of builders.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Family {
    /// What their names begin with, or `other`.
    pub name: &'static str,
    /// What the key calls them.
    pub about: &'static str,
    /// Name of the shape.
    pub shape: &'static str,
    /// Colour on paper.
    pub light: &'static str,
    /// Colour on a dark ground.
    pub dark: &'static str,
}

/// The families of some builders.
pub fn families<'a>(builders: impl Iterator<Item = &'a str>) -> Vec<Family> {
    let found: Vec<&str> = builders.map(|builder| family_of(builder).name).collect();
    let all = FAMILIES.iter().chain([&OTHERS]).map(Family::of);
    all.filter(|family| found.contains(&family.name)).collect()
}

/// The family of a builder.
pub fn family_of(builder: &str) -> Family {
    Family::of(families::family_of(builder))
}

impl Family {
    fn of(family: &families::Family) -> Self {
        let &families::Family { prefix, name: about, shape, light, dark } = family;
        let shape = match shape {
            Shape::Circle => "circle",
            Shape::Square => "square",
            Shape::Diamond => "diamond",
            Shape::Up => "up",
            Shape::Down => "down",
        };
        Self { name: if prefix.is_empty() { "other" } else { prefix }, about, shape, light, dark }
    }
}
