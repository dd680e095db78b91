//! Random numbers without state: a hash of (seed, pixel, dimension), so that a pixel's numbers do not depend
//! on the order in which pixels are done.

use crate::random::{GOLDEN, mix};

/// The numbers of one pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelRandom(u64);

impl PixelRandom {
    pub(super) fn new(seed: u64, pixel: u32) -> Self {
        Self(mix(mix(seed ^ GOLDEN) ^ u64::from(pixel)))
    }

    /// The two numbers of `dimension`, uniform in [0, 1).
    pub(super) fn pair(self, dimension: u32) -> [f32; 2] {
        let bits = mix(self.0.wrapping_add(u64::from(dimension).wrapping_mul(GOLDEN)));
        const STEP: f32 = 1.0 / (1 << 24) as f32;
        [(bits >> 40) as f32 * STEP, ((bits >> 16) & 0xff_ffff) as f32 * STEP]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_unlike_their_neighbours() {
        let mut sum = [0.0f64; 3];
        let n = 1 << 16;
        for pixel in 0..n {
            let [a, b] = PixelRandom::new(7, pixel).pair(0);
            let [c, _] = PixelRandom::new(7, pixel).pair(1);
            assert!((0.0..1.0).contains(&a) && (0.0..1.0).contains(&b));
            for (sum, x) in sum.iter_mut().zip([a * b, b * c, a * c]) {
                *sum += f64::from(x);
            }
        }
        for mean in sum.map(|sum| sum / f64::from(n)) {
            assert!((mean - 0.25).abs() < 0.005, "products of independent numbers average 1/4, not {mean}");
        }
    }

    #[test]
    fn numbers_depend_on_all_three() {
        let x = PixelRandom::new(1, 2).pair(3);
        assert_eq!(x, PixelRandom::new(1, 2).pair(3));
        assert_ne!(x, PixelRandom::new(2, 2).pair(3));
        assert_ne!(x, PixelRandom::new(1, 3).pair(3));
        assert_ne!(x, PixelRandom::new(1, 2).pair(4));
    }
}
