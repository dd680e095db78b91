//! The key of Figure 6: the marks of trees by width, the paper's, and the fronts through them, and what the shapes
//! mean.

use super::chart::{DASHES, GREY, INK, Line};
use super::families::{FAMILIES, family_of, style};
use super::raster::text_width;
use super::svg::{Anchor, Svg};
use crate::report::figures::WIDTH;

const DARK: &str = "#4d4d4d";
const PALE: &str = "#c4c4c4";
const BAND: &str = "#dfe8d8";

/// Families of the paper's builders.
const OF_PAPER: usize = 4;

/// A line of the key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// Trees of width 4 and their front.
    Four,
    /// Trees of width 8 and their front.
    Eight,
    /// The front over both widths.
    Both,
    /// The paper's points and their front.
    Paper,
}

impl Entry {
    /// The entry of trees of `width`.
    pub fn of_width(width: u32) -> Self {
        if width == WIDTH { Self::Four } else { Self::Eight }
    }

    /// The entries of a figure with trees of `widths`: one each, and the front over both.
    pub fn of_widths(widths: &[u32]) -> Vec<Self> {
        let has = |entry| widths.iter().any(|&width| Self::of_width(width) == entry);
        let mut entries: Vec<Self> = [Self::Four, Self::Eight].into_iter().filter(|&e| has(e)).collect();
        if entries.len() > 1 {
            entries.push(Self::Both);
        }
        entries
    }

    /// How its front is drawn.
    pub fn line(self) -> Line {
        match self {
            Self::Four => Line { colour: DARK, width: 1.5, more: "" },
            Self::Eight => Line { colour: DARK, width: 1.5, more: DASHES },
            Self::Both => Line { colour: BAND, width: 9.0, more: " stroke-linejoin=\"round\"" },
            Self::Paper => Line { colour: PALE, width: 1.5, more: DASHES },
        }
    }

    /// Colour of its points where that does not tell the builder.
    pub fn colour(self) -> &'static str {
        if self == Self::Paper { GREY } else { INK }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Four => "4-wide trees and their front",
            Self::Eight => "8-wide trees and their front",
            Self::Both => "front over both",
            Self::Paper => "the paper (16 threads, Embree 2.11, frame times) and its front",
        }
    }
}

/// Draws `entry` from a place on, in texts of `size`; returns where it ends.
pub fn key(svg: &mut Svg, (x, y): (f64, f64), entry: Entry, size: f64) -> f64 {
    let mut end = x;
    if entry != Entry::Both {
        for family in &FAMILIES[..OF_PAPER] {
            let colour = if entry == Entry::Paper { entry.colour() } else { family.light };
            svg.point((end, y), family.shape, 4.7, colour, entry != Entry::Four);
            end += 15.0;
        }
    }
    let Line { colour, width, more } = entry.line();
    svg.line(&[(end, y), (end + 24.0, y)], colour, width, more);
    svg.text((end + 30.0, y + 4.5), Anchor::Start, size, INK, entry.text(), "");
    end + 30.0 + text_width(entry.text(), size)
}

/// Draws what the shapes of `builders` mean from a place on: families, and others by their names where those are few.
pub fn shapes(svg: &mut Svg, (x, y): (f64, f64), builders: &[&str], size: f64) {
    let mut entries: Vec<(&str, String)> = Vec::new();
    for family in &FAMILIES {
        if builders.iter().any(|builder| builder.starts_with(family.prefix)) {
            entries.push((family.prefix, family.name.into()));
        }
    }
    let is_other = |builder: &&&str| family_of(builder).prefix.is_empty();
    let mut others: Vec<&str> = builders.iter().filter(is_other).copied().collect();
    others.sort_unstable();
    others.dedup();
    if let Some(&first) = others.first() {
        entries.push((first, if others.len() <= 3 { others.join(", ") } else { "others".into() }));
    }
    let mut end = x;
    for (builder, name) in entries {
        let (shape, colour) = style(builder);
        svg.point((end, y), shape, 4.7, colour, false);
        svg.text((end + 11.0, y + 4.5), Anchor::Start, size, INK, &name, "");
        end += 32.0 + text_width(&name, size);
    }
}

/// Where the entries of a key stand that are so wide, in lines from `first` on, so far apart, that end before `right`.
pub fn in_lines(
    widths: impl Iterator<Item = f64>,
    first: (f64, f64),
    right: f64,
    apart: f64,
) -> Vec<(f64, f64)> {
    let (mut x, mut y) = first;
    let place = |width: f64| {
        if x > first.0 && x + width > right {
            (x, y) = (first.0, y + apart);
        }
        x += width;
        (x - width, y)
    };
    widths.map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_key_has_several_lines() {
        let places = in_lines([30.0, 40.0, 50.0, 200.0].into_iter(), (10.0, 5.0), 100.0, 20.0);
        assert_eq!(places, [(10.0, 5.0), (40.0, 5.0), (10.0, 25.0), (10.0, 45.0)]);
    }

    #[test]
    fn shapes_are_named_as_far_as_they_are_there() {
        let told = |builders: &[&str]| {
            let mut svg = Svg::new(10.0, 10.0, "");
            shapes(&mut svg, (0.0, 0.0), builders, 13.0);
            svg.finish()
        };
        let some = told(&["lbvh", "phr-hq", "embree-sah", "phr-fast"]);
        assert!(some.contains(">Embree<") && some.contains(">PHR<") && some.contains(">lbvh<"), "{some}");
        assert!(!some.contains(">AAC<") && some.matches("<text").count() == 3, "{some}");
        assert!(
            told(&["lbvh", "ploc"]).contains(">PLOC<") && told(&["a", "b", "c", "d"]).contains(">others<")
        );
    }
}
