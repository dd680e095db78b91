//! A small writer of SVG: the few marks that charts need, coordinates with two decimals, nothing that
//! changes from run to run.

use std::fmt::{Display, Write};

/// Families of fonts, the one that PNGs are drawn with first.
const FONTS: &str = "Ubuntu, Helvetica, Arial, sans-serif";

/// Shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A disc.
    Circle,
    /// A square on its side.
    Square,
    /// A square on its corner.
    Diamond,
    /// A triangle pointing up.
    Up,
    /// A triangle pointing down.
    Down,
}

/// Where a text is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

impl Display for Anchor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        })
    }
}

/// A drawing in progress; lengths in pixels, y downwards.
#[derive(Clone, Debug)]
pub struct Svg {
    text: String,
}

impl Svg {
    /// A white sheet.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"{FONTS}\">\n"
        );
        text += &format!(
            "<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
            escaped(title)
        );
        Self { text }
    }

    /// A line through `points`, with SVG attributes such as `stroke-dasharray` in `more`.
    pub fn line(&mut self, points: &[(f64, f64)], colour: &str, width: f64, more: &str) {
        let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect();
        let points = points.join(" ");
        self.put(format_args!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{more}/>"
        ));
    }

    /// A frame.
    pub fn frame(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), colour: &str) {
        self.put(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"none\" stroke=\"{colour}\"/>"
        ));
    }

    /// A filled rectangle, with SVG attributes such as `fill-opacity` in `more`.
    pub fn fill(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), colour: &str, more: &str) {
        self.put(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{colour}\"{more}/>"
        ));
    }

    /// A point of about `radius`; if hollow, filled with a white that lets through what is below it.
    pub fn point(&mut self, (x, y): (f64, f64), shape: Shape, radius: f64, colour: &str, hollow: bool) {
        let fill = match hollow {
            true => "fill=\"#ffffff\" fill-opacity=\"0.6\" ".to_owned(),
            false => format!("fill=\"{colour}\" "),
        };
        let stroke = format!("stroke=\"{colour}\" stroke-width=\"1.5\"");
        // Equal areas look equally large.
        let corners: &[(f64, f64)] = match shape {
            Shape::Circle => {
                self.put(format_args!(
                    "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" {fill}{stroke}/>"
                ));
                return;
            }
            Shape::Square => &[(-0.89, -0.89), (0.89, -0.89), (0.89, 0.89), (-0.89, 0.89)],
            Shape::Diamond => &[(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)],
            Shape::Up => &[(0.0, -1.4), (1.25, 0.8), (-1.25, 0.8)],
            Shape::Down => &[(0.0, 1.4), (1.25, -0.8), (-1.25, -0.8)],
        };
        let corners: Vec<String> =
            corners.iter().map(|(dx, dy)| format!("{:.2},{:.2}", x + radius * dx, y + radius * dy)).collect();
        self.put(format_args!("<polygon points=\"{}\" {fill}{stroke}/>", corners.join(" ")));
    }

    /// A text whose baseline starts, centres or ends at a place; `more` as for lines.
    pub fn text(
        &mut self,
        (x, y): (f64, f64),
        anchor: Anchor,
        size: f64,
        colour: &str,
        text: &str,
        more: &str,
    ) {
        let text = escaped(text);
        self.put(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" font-size=\"{size}\" fill=\"{colour}\"{more}>{text}</text>"
        ));
    }

    /// The whole file.
    pub fn finish(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }

    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{element}");
    }
}

/// `text` with the characters that mean something in XML, and those it forbids, replaced.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_the_file() {
        let mut svg = Svg::new(10.0, 10.0, "a & b");
        svg.text((1.0, 2.0), Anchor::End, 12.0, "#000000", "<\"evil\"\u{7}>", "");
        let text = svg.finish();
        assert!(text.contains("&lt;&quot;evil&quot; &gt;") && text.contains("a &amp; b"), "{text}");
        assert!(text.ends_with("</svg>\n"));
    }
}
