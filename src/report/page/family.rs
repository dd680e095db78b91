//! Families of builders: how their points look on the page, as in the figures.

use crate::report::plot::chart::style;
use crate::report::plot::svg::Shape;
use serde::Serialize;

/// A family of builders.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Family {
    /// What their names begin with.
    pub name: &'static str,
    /// What the key calls them.
    pub about: &'static str,
    /// Name of the shape.
    pub shape: &'static str,
    /// Colour on paper, that of the figures.
    pub light: &'static str,
    /// Colour on a dark ground, as far from the others as there.
    pub dark: &'static str,
}

/// The families, the last of all others, with their colours on a dark ground (after Okabe and Ito, lighter).
const FAMILIES: [(&str, &str); 8] = [
    ("embree", "#56b4e9"),
    ("phr", "#f28542"),
    ("hunt", "#2bbf94"),
    ("aac", "#de9cc0"),
    ("ploc", "#e0b040"),
    ("obvhs", "#b5a1e6"),
    ("svenstaro", "#b5a1e6"),
    ("other", "#ece9e2"),
];

/// The families of some builders.
pub fn families<'a>(builders: impl Iterator<Item = &'a str>) -> Vec<Family> {
    let found: Vec<&str> = builders.map(|builder| family_of(builder).name).collect();
    let known = FAMILIES.iter().filter(|(name, _)| found.contains(name));
    known.map(|&(name, dark)| family(name, dark)).collect()
}

/// The family of a builder.
pub fn family_of(builder: &str) -> Family {
    let found =
        FAMILIES.iter().find(|(name, _)| builder.starts_with(name)).unwrap_or(&FAMILIES[FAMILIES.len() - 1]);
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
    let about = if name == "other" { "lbvh and others" } else { name };
    Family { name, about, shape, light, dark }
}
