//! Where a part stands: an affine map made of additions, multiplications and square roots alone, so that
//! generated scenes do not depend on a platform's sine.

use glam::Vec3;

/// Sine and cosine of `turns` full turns.
pub fn sin_cos(turns: f32) -> (f32, f32) {
    let turns = f64::from(turns);
    let quarter = (turns * 4.0 + 0.5).floor();
    let x = (turns - quarter * 0.25) * std::f64::consts::TAU;
    let s = x * x;
    // Taylor series over an eighth of a turn to either side: exact in f32.
    let sin = x * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0))));
    let cos = 1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0))));
    let (sin, cos) = (sin as f32, cos as f32);
    match quarter.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// An affine map from a part's own coordinates to its surroundings. Y is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Images of the unit vectors.
    pub axes: [Vec3; 3],
    /// Image of the origin.
    pub origin: Vec3,
}

impl Frame {
    /// The map that changes nothing.
    pub const WORLD: Self = Self { axes: Vec3::AXES, origin: Vec3::ZERO };

    /// Moved to a point, not turned.
    pub const fn at(x: f32, y: f32, z: f32) -> Self {
        Self { axes: Vec3::AXES, origin: Vec3::new(x, y, z) }
    }

    /// The image of a point.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.origin + self.direction(p)
    }

    /// The image of a direction.
    #[inline]
    pub fn direction(&self, d: Vec3) -> Vec3 {
        self.axes[0] * d.x + self.axes[1] * d.y + self.axes[2] * d.z
    }

    /// First `inner`, then this map: `inner` is placed within this frame.
    #[must_use]
    pub fn with(&self, inner: &Self) -> Self {
        Self { axes: inner.axes.map(|axis| self.direction(axis)), origin: self.point(inner.origin) }
    }

    /// A point of this frame becomes the origin.
    #[must_use]
    pub fn moved(&self, x: f32, y: f32, z: f32) -> Self {
        self.with(&Self::at(x, y, z))
    }

    /// Stretched along its axes.
    #[must_use]
    pub fn scaled(&self, x: f32, y: f32, z: f32) -> Self {
        Self { axes: [self.axes[0] * x, self.axes[1] * y, self.axes[2] * z], origin: self.origin }
    }

    /// Stretched alike along its axes.
    #[must_use]
    pub fn sized(&self, size: f32) -> Self {
        self.scaled(size, size, size)
    }

    /// Turned about its axis `axis` (0 x, 1 y, 2 z).
    #[must_use]
    pub fn turned(&self, axis: usize, turns: f32) -> Self {
        let (sin, cos) = sin_cos(turns);
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut axes = self.axes;
        axes[a] = self.axes[a] * cos + self.axes[b] * sin;
        axes[b] = self.axes[b] * cos - self.axes[a] * sin;
        Self { axes, origin: self.origin }
    }

    /// The frame whose Y axis runs from `from` to `to`, its other axes of length `width`.
    pub fn along(from: Vec3, to: Vec3, width: f32) -> Self {
        let along = to - from;
        let [x, z] = across(along.normalize_or(Vec3::Y));
        Self { axes: [x * width, along, z * width], origin: from }
    }
}

/// Two unit vectors that are perpendicular to the unit vector `direction` and each other.
pub fn across(direction: Vec3) -> [Vec3; 2] {
    let helper = if direction.x.abs() < 0.6 { Vec3::X } else { Vec3::Z };
    let x = direction.cross(helper).normalize();
    [x, x.cross(direction)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sine_is_a_sine() {
        for i in -1000..1000 {
            let turns = i as f32 / 311.0;
            let (sin, cos) = sin_cos(turns);
            let (s, c) = (f64::from(turns) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(sin) - s).abs() < 2e-7 && (f64::from(cos) - c).abs() < 2e-7, "{turns}");
        }
    }

    #[test]
    fn frames_nest() {
        let outer = Frame::at(1.0, 2.0, 3.0).turned(1, 0.25).sized(2.0);
        let p = outer.moved(1.0, 0.0, 0.0).point(Vec3::ZERO);
        assert!(p.distance(Vec3::new(1.0, 2.0, 1.0)) < 1e-6, "{p}");
        let along = Frame::along(Vec3::X, Vec3::new(1.0, 0.0, 5.0), 0.5);
        assert!(along.point(Vec3::Y).distance(Vec3::new(1.0, 0.0, 5.0)) < 1e-6);
        assert!((along.axes[0].length() - 0.5).abs() < 1e-6 && along.axes[0].dot(along.axes[2]).abs() < 1e-6);
    }
}
