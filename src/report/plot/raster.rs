//! From SVG to PNG, with a font that a crate ships: no font of the machine has a say.

use resvg::{tiny_skia, usvg};
use std::sync::{Arc, LazyLock};

/// Why there is no PNG.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// The drawing cannot be read.
    #[error("figure: {0}; report this with the results")]
    Svg(#[from] usvg::Error),
    /// The drawing is too large for memory, or without extent.
    #[error("figure of {width} x {height} pixels cannot be drawn; give fewer scenes")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The encoder failed.
    #[error("figure: {0}; give fewer scenes")]
    Png(String),
}

static OPTIONS: LazyLock<usvg::Options<'static>> = LazyLock::new(|| {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    // Whatever family a drawing names first, this is the only one there is.
    let family = fonts.faces().next().and_then(|face| face.families.first()).map(|family| family.0.clone());
    let family = family.unwrap_or_default();
    fonts.set_sans_serif_family(family.clone());
    usvg::Options { fontdb: Arc::new(fonts), font_family: family, ..usvg::Options::default() }
});

/// Draws `svg` with two pixels for each of its own and encodes it; large drawings with one and a half, to keep
/// files small.
///
/// # Errors
/// A drawing that is malformed or too large.
pub fn png(svg: &str) -> Result<Vec<u8>, RasterError> {
    const LARGE: f32 = 2e6;
    let size = usvg::Tree::from_str(svg, &OPTIONS)?.size();
    png_with(svg, if size.width() * size.height() > LARGE { 1.5 } else { 2.0 }, &[])
}

/// Colours to put over a drawing, pixel for pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// The upper left corner: pixels from the left and from the top.
    pub at: (usize, usize),
    /// Pixels per row.
    pub width: usize,
    /// Red, green and blue, row by row.
    pub rgb: Vec<[u8; 3]>,
}

/// Likewise with `scale` pixels for each of the drawing's, and `patches` over it; what of them lies outside is left
/// out.
///
/// # Errors
/// As [`png()`].
pub fn png_with(svg: &str, scale: f32, patches: &[Patch]) -> Result<Vec<u8>, RasterError> {
    let tree = usvg::Tree::from_str(svg, &OPTIONS)?;
    let size = |length: f32| (length * scale).ceil() as u32;
    let (width, height) = (size(tree.size().width()), size(tree.size().height()));
    let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or(RasterError::Size { width, height })?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    for Patch { at: (x, y), width: across, rgb } in patches {
        for (row, colours) in rgb.chunks(*across).enumerate() {
            for (column, [r, g, b]) in colours.iter().enumerate() {
                let (x, y) = (x + column, y + row);
                if x < width as usize && y < height as usize {
                    let place = 4 * (y * width as usize + x);
                    pixels.data_mut()[place..place + 4].copy_from_slice(&[*r, *g, *b, 255]);
                }
            }
        }
    }
    pixels.encode_png().map_err(|error| RasterError::Png(error.to_string()))
}

/// Width of a line of text, pixels; ten per cent more than in our font, since others are wider.
pub fn text_width(text: &str, size: f64) -> f64 {
    let mut svg = super::svg::Svg::new(4000.0, 100.0, "");
    svg.text((0.0, 50.0), super::svg::Anchor::Start, size, "#000000", text, "");
    let tree = usvg::Tree::from_str(&svg.finish(), &OPTIONS);
    let of_text = |tree: usvg::Tree| {
        let texts = tree.root().children().iter().filter(|node| matches!(node, usvg::Node::Text(_)));
        texts.map(|node| f64::from(node.abs_bounding_box().width())).fold(0.0, f64::max)
    };
    1.1 * tree.map_or(0.6 * size * text.chars().count() as f64, of_text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_has_a_width_and_is_drawn() {
        let (short, long) = (text_width("phr-hq", 12.0), text_width("embree-fast-spatial", 12.0));
        assert!(25.0 < short && short < 50.0 && 2.0 * short < long && long < 140.0, "{short} {long}");

        let mut svg = super::super::svg::Svg::new(60.0, 20.0, "");
        let blank = png(&svg.clone().finish()).unwrap();
        svg.text((5.0, 15.0), super::super::svg::Anchor::Start, 12.0, "#000000", "phr-hq", "");
        assert_ne!(png(&svg.finish()).unwrap(), blank);
    }

    #[test]
    fn nonsense_is_an_error() {
        assert!(matches!(png("no drawing"), Err(RasterError::Svg(_))));
    }
}
