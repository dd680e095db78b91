//! The picture, written as PNG.

use phr::glam::Vec3;
use phr::trace::{Image, ImageError};
use rayon::prelude::*;
use std::path::Path;

pub struct Picture {
    width: u32,
    height: u32,
    /// Linear light, rows from the top.
    pixels: Vec<Vec3>,
}

impl Picture {
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![Vec3::ZERO; width as usize * height as usize] }
    }

    /// The rows, to be filled by many threads.
    pub fn rows(&mut self) -> impl IndexedParallelIterator<Item = &mut [Vec3]> {
        self.pixels.par_chunks_mut(self.width as usize)
    }

    /// Writes it, bright light compressed to what a screen shows (Reinhard).
    pub fn write(&self, path: &Path) -> Result<(), ImageError> {
        let shown = |light: &Vec3| (*light / (1.0 + 0.35 * light.max_element())).to_array();
        let rgb = self.pixels.iter().map(shown).collect();
        Image { width: self.width, height: self.height, rgb }.write_png(path)
    }
}
