//! How the families of builders look in figures, the same in all of them.

use super::svg::Shape;

/// Shape and colour by family; colours after Okabe and Ito, told apart by colour-blind readers too.
pub fn style(builder: &str) -> (Shape, &'static str) {
    match builder {
        name if name.starts_with("embree") => (Shape::Circle, "#0072b2"),
        name if name.starts_with("phr") => (Shape::Up, "#d55e00"),
        name if name.starts_with("hunt") => (Shape::Square, "#009e73"),
        name if name.starts_with("aac") => (Shape::Diamond, "#cc79a7"),
        _ => (Shape::Down, "#000000"),
    }
}
