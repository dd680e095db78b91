//! Families of builders: how their points look on the page, as in the figures.

use crate::report::plot::chart::style;
use crate::report::plot::svg::Shape;
use serde::Serialize;

/// A family of builders.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Family {
    /// What their names begin with.
    pub name: &'static str,
    /// Name of the shape.
    pub shape: &'static str,
    /// Colour on paper, that of the figures.
    pub light: &'static str,
    /// Colour on a dark ground, as far from the others as there.
    pub dark: &'static str,
}

/// The families, the last of all others, with their colours on a dark ground (after Okabe and Ito, lighter).
const FAMILIES: [(&str, &str); 5] = [
    ("embree", "#56b4e9"),
    ("phr", "#f28542"),
    ("hunt", "#2bbf94"),
    ("aac", "#de9cc0"),
    ("other", "#ece9e2"),
];

/// All families.
pub fn families() -> Vec<Family> {
    FAMILIES.iter().map(|&(name, dark)| family(name, dark)).collect()
}

/// The family of a builder.
pub fn family_of(builder: &str) -> Family {
    let found = FAMILIES.iter().find(|(name, _)| builder.starts_with(name)).unwrap_or(&FAMILIES[4]);
    family(found.0, found.1)
}

fn family(name: &'static str, dark: &'static str) -> Family {
    let (shape, light) = style(name);
    let shape = match shape {
        Shape::Circle => "circle",
        Shape::Square => "square",
        Shape::Diamond => "diamond",
        Shape::Up => "up",
        Shape::Down => "down",
    };
    Family { name, shape, light, dark }
}
