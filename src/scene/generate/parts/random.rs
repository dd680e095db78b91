//! Counter-based random numbers and noise: the same on every platform, whatever the order of evaluation, and of streams
//! by name, so that a scene keeps its triangles where another part of it draws more.

use crate::random::{self, GOLDEN};
use glam::Vec3;

/// Draw number `value` of the generator seeded with 0.
pub fn mix(value: u64) -> u64 {
    random::mix(value.wrapping_mul(GOLDEN).wrapping_add(GOLDEN))
}

/// A stream of random numbers named by its key.
#[derive(Clone, Debug)]
pub struct Random {
    key: u64,
    counter: u64,
}

impl Random {
    /// The stream `stream` of `seed`.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self { key: mix(seed ^ mix(stream)), counter: 0 }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.counter += 1;
        mix(self.key ^ mix(self.counter))
    }

    /// Uniform in [0, 1), with 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// Uniform between the two.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Uniform in `0..count`; `count` > 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    /// A point in the unit ball.
    pub fn in_ball(&mut self) -> Vec3 {
        loop {
            let p = Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - Vec3::ONE;
            if p.dot(p) <= 1.0 && p.dot(p) > 1e-6 {
                return p;
            }
        }
    }
}

/// Smooth noise in [-1, 1], about one bump per unit of length.
pub fn noise(seed: u64, p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let weight = f * f * (Vec3::splat(3.0) - f * 2.0);
    let [x, y, z] = cell.to_array().map(|c| c as i32 as u32 as u64);
    let corner = |i: u64| {
        let (x, y, z) = (x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
        let name = (x & 0x1f_ffff) | (y & 0x1f_ffff) << 21 | (z & 0x1f_ffff) << 42;
        (mix(seed ^ name) >> 40) as f32 / (1u32 << 23) as f32 - 1.0
    };
    let mixed = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |i| mixed(corner(i), corner(i + 1), weight.x);
    mixed(mixed(along_x(0), along_x(2), weight.y), mixed(along_x(4), along_x(6), weight.y), weight.z)
}

/// Noise summed over octaves, each of half the size and half the height.
pub fn fractal(seed: u64, p: Vec3, octaves: u32) -> f32 {
    (0..octaves)
        .map(|i| noise(seed.wrapping_add(u64::from(i)), p * (1u32 << i) as f32) / (1u32 << i) as f32)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_and_repeat() {
        let draw = |seed, stream| Random::new(seed, stream).bits();
        assert_eq!(draw(1, 2), draw(1, 2));
        assert_ne!(draw(1, 2), draw(2, 1));
        let mut random = Random::new(3, 0);
        let mean = (0..10_000).map(|_| random.unit()).sum::<f32>() / 1e4;
        assert!((mean - 0.5).abs() < 0.02);
    }

    #[test]
    fn noise_is_continuous_and_bounded() {
        let at = |i: i32| noise(7, Vec3::new(i as f32 * 1e-3, 0.3, -2.7));
        for i in -3000..3000 {
            assert!((at(i) - at(i + 1)).abs() < 0.01 && at(i).abs() <= 1.0);
        }
    }
}
