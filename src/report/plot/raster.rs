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

/// Draws `svg` with two pixels for each of its own and encodes it; large drawings with one and a half, larger ones
/// with one and a quarter, to keep files below a megabyte.
///
/// # Errors
/// A drawing that is malformed or too large.
pub fn png(svg: &str) -> Result<Vec<u8>, RasterError> {
    encoded(&figure(svg)?)
}

/// Whether the file `png` shows what [`png()`] makes of `svg`. Pixels are compared, not bytes: another version of the
/// crate that deflates them writes the same picture in other bytes.
///
/// # Errors
/// As [`png()`].
pub fn shows(png: &[u8], svg: &str) -> Result<bool, RasterError> {
    let drawn = figure(svg)?;
    Ok(tiny_skia::Pixmap::decode_png(png).is_ok_and(|shown| shown == drawn))
}

/// Whether two PNGs have the same pixels; a file that is none is like no other.
pub fn are_alike(png: &[u8], other: &[u8]) -> bool {
    let [png, other] = [png, other].map(|file| tiny_skia::Pixmap::decode_png(file).ok());
    png.is_some() && png == other
}

fn figure(svg: &str) -> Result<tiny_skia::Pixmap, RasterError> {
    let tree = usvg::Tree::from_str(svg, &OPTIONS)?;
    let scale = match tree.size().width() * tree.size().height() {
        ..=2e6 => 2.0,
        ..=3e6 => 1.5,
        _ => 1.25,
    };
    rendered(&tree, scale)
}

fn rendered(tree: &usvg::Tree, scale: f32) -> Result<tiny_skia::Pixmap, RasterError> {
    let size = |length: f32| (length * scale).ceil() as u32;
    let (width, height) = (size(tree.size().width()), size(tree.size().height()));
    let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or(RasterError::Size { width, height })?;
    resvg::render(tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    Ok(pixels)
}

fn encoded(pixels: &tiny_skia::Pixmap) -> Result<Vec<u8>, RasterError> {
    pixels.encode_png().map_err(|error| RasterError::Png(error.to_string()))
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
    let mut pixels = rendered(&usvg::Tree::from_str(svg, &OPTIONS)?, scale)?;
    let (width, height) = (pixels.width() as usize, pixels.height() as usize);
    for Patch { at: (x, y), width: across, rgb } in patches {
        for (row, colours) in rgb.chunks(*across).enumerate() {
            for (column, [r, g, b]) in colours.iter().enumerate() {
                let (x, y) = (x + column, y + row);
                if x < width && y < height {
                    let place = 4 * (y * width + x);
                    pixels.data_mut()[place..place + 4].copy_from_slice(&[*r, *g, *b, 255]);
                }
            }
        }
    }
    encoded(&pixels)
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

    /// A small drawing with a text at `x`.
    fn with_text(x: f64) -> String {
        let mut svg = super::super::svg::Svg::new(61.0, 21.0, "");
        svg.text((x, 15.0), super::super::svg::Anchor::Start, 12.0, "#000000", "phr-hq", "");
        svg.finish()
    }

    /// The same pixels in other bytes.
    fn deflated_otherwise(file: &[u8]) -> Vec<u8> {
        let shown = tiny_skia::Pixmap::decode_png(file).unwrap();
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, shown.width(), shown.height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::NoCompression);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&shown.take_demultiplied()).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn files_are_told_apart_by_their_pixels() {
        let svg = with_text(5.0);
        let (file, moved) = (png(&svg).unwrap(), png(&with_text(6.0)).unwrap());
        let same = deflated_otherwise(&file);
        assert_ne!(same, file);
        assert!(shows(&file, &svg).unwrap() && shows(&same, &svg).unwrap() && are_alike(&same, &file));
        assert!(!shows(&moved, &svg).unwrap() && !are_alike(&moved, &file));
        assert!(!shows(b"no picture", &svg).unwrap() && !are_alike(b"no picture", b"no picture"));
        assert!(shows(&file, "no drawing").is_err());
    }

    #[test]
    fn nonsense_is_an_error() {
        assert!(matches!(png("no drawing"), Err(RasterError::Svg(_))));
    }
}
