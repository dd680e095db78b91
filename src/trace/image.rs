//! Images of linear light.

use crate::memory::huge_pages;
use glam::Vec3;

/// An image of linear RGB, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` pixels of linear radiance, 1 is white.
    pub rgb: Vec<[f32; 3]>,
}

impl Image {
    /// A black image.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            rgb: huge_pages::filled(width as usize * height as usize, [0.0; 3], "an image"),
        }
    }

    /// Adds `weight` times `other`, pixel by pixel: averages images of several seeds. Pixels that only one
    /// of them has are left alone.
    pub fn add(&mut self, other: &Self, weight: f32) {
        for (sum, pixel) in self.rgb.iter_mut().zip(&other.rgb) {
            *sum = (Vec3::from(*sum) + weight * Vec3::from(*pixel)).into();
        }
    }

    /// The pixels as 8-bit sRGB, row by row.
    pub fn to_srgb8(&self) -> Vec<u8> {
        self.rgb.iter().flatten().map(|&x| srgb8(x)).collect()
    }
}

/// The sRGB transfer function (IEC 61966-2-1), rounded to 8 bits; NaN is black.
fn srgb8(linear: f32) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

/// Why an image could not be written.
#[cfg(feature = "harness")]
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file could not be made or written.
    #[error("{path}: {error}; check that the folder exists and is writable", path = path.display())]
    Write {
        /// The file.
        path: std::path::PathBuf,
        /// The cause.
        error: png::EncodingError,
    },
}

#[cfg(feature = "harness")]
impl Image {
    /// Writes the image as 8-bit sRGB PNG.
    ///
    /// # Errors
    /// [`ImageError::Write`] if the file cannot be written, or the image has no pixels.
    pub fn write_png(&self, path: &std::path::Path) -> Result<(), ImageError> {
        let failed = |error| ImageError::Write { path: path.to_path_buf(), error };
        let file = std::fs::File::create(path).map_err(|error| failed(error.into()))?;
        let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(&self.to_srgb8()).map_err(failed)?;
        writer.finish().map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_maps_the_known_values() {
        for (linear, encoded) in [(0.0, 0), (1.0, 255), (0.5, 188), (0.002, 7), (7.0, 255), (-1.0, 0)] {
            assert_eq!(srgb8(linear), encoded, "{linear}");
        }
        assert_eq!(srgb8(f32::NAN), 0);
    }

    #[test]
    fn images_average() {
        let mut sum = Image::new(1, 1);
        sum.add(&Image { width: 1, height: 1, rgb: vec![[1.0, 0.5, 0.0]] }, 0.5);
        sum.add(&Image { width: 1, height: 1, rgb: vec![[0.0, 0.5, 1.0]] }, 0.5);
        assert_eq!(sum.rgb, [[0.5; 3]]);
    }

    #[cfg(feature = "harness")]
    #[test]
    fn png_files_read_back_and_bad_paths_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        let image = Image { width: 2, height: 1, rgb: vec![[0.0, 0.5, 1.0], [1.0; 3]] };
        image.write_png(&path).unwrap();
        let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, [0, 188, 255, 255, 255, 255]);
        let error = image.write_png(&folder.path().join("none/x.png")).unwrap_err().to_string();
        assert!(error.contains("none/x.png") && !error.contains('\n'), "{error}");
    }
}
