//! Families of builders: their shapes and colours are the same in all figures and on the page.

use super::svg::Shape;

/// A family of builders.
#[derive(Debug)]
pub struct Family {
    /// What the names of its builders begin with.
    pub prefix: &'static str,
    /// What keys call it.
    pub name: &'static str,
    /// Shape of its points.
    pub shape: Shape,
    /// Colour on paper, after Okabe and Ito: told apart by colour-blind readers too.
    pub light: &'static str,
    /// Colour on a dark ground, as far from the others as there.
    pub dark: &'static str,
}

const fn family([prefix, name]: [&'static str; 2], shape: Shape, [light, dark]: [&'static str; 2]) -> Family {
    Family { prefix, name, shape, light, dark }
}

/// Those that have names, the paper's first.
pub static FAMILIES: [Family; 7] = [
    family(["embree", "Embree"], Shape::Circle, ["#0072b2", "#56b4e9"]),
    family(["phr", "PHR"], Shape::Up, ["#d55e00", "#f28542"]),
    family(["hunt", "Hunt"], Shape::Square, ["#009e73", "#2bbf94"]),
    family(["aac", "AAC"], Shape::Diamond, ["#cc79a7", "#de9cc0"]),
    family(["ploc", "PLOC"], Shape::Square, ["#b8860b", "#e0b040"]),
    family(["obvhs", "obvhs"], Shape::Diamond, ["#6a4fa3", "#b5a1e6"]),
    family(["svenstaro", "bvh"], Shape::Circle, ["#6a4fa3", "#b5a1e6"]),
];

/// All other builders.
pub static OTHERS: Family = family(["", "lbvh and others"], Shape::Down, ["#000000", "#ece9e2"]);

/// The family of a builder.
pub fn family_of(builder: &str) -> &'static Family {
    FAMILIES.iter().find(|family| builder.starts_with(family.prefix)).unwrap_or(&OTHERS)
}

/// Shape and colour of a builder on paper.
pub fn style(builder: &str) -> (Shape, &'static str) {
    let family = family_of(builder);
    (family.shape, family.light)
}
