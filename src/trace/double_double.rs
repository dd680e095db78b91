//! Sums of two `f64`, about 106 bits: what the oracle computes in. Differences of `f32` coordinates are exact in
//! it, and products of three of them err by 1e-30 of their size, so that the normal of a triangle is right however
//! thin the triangle is. Algorithms: Dekker, "A floating-point technique for extending the available precision"
//! (1971), with a fused multiply-add for the error of a product.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The sum of a number and a much smaller one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// `a + b` without error.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let of_b = high - a;
        Self { high, low: (a - (high - of_b)) + (b - of_b) }
    }

    /// `a + b` without error where `a` is the larger.
    fn ordered_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// Rounded to `f64`.
    pub fn value(self) -> f64 {
        self.high + self.low
    }
}

impl From<f32> for DoubleDouble {
    fn from(x: f32) -> Self {
        Self { high: x.into(), low: 0.0 }
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let first = Self::ordered_sum(high.high, high.low + low.high);
        Self::ordered_sum(first.high, first.low + low.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high) + (self.high * other.low + self.low * other.high);
        Self::ordered_sum(high, low)
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    /// Long division with three digits of 53 bits.
    fn div(self, other: Self) -> Self {
        let digit = |rest: Self| Self { high: rest.high / other.high, low: 0.0 };
        let first = digit(self);
        let rest = self - other * first;
        let second = digit(rest);
        first + second + digit(rest - other * second)
    }
}

/// A vector.
pub type Vector = [DoubleDouble; 3];

/// `a - b`.
pub fn difference(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// The scalar product.
pub fn dot(a: Vector, b: Vector) -> DoubleDouble {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    let component = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [component(1, 2), component(2, 0), component(0, 1)]
}

/// `a + t b`.
pub fn along(a: Vector, t: DoubleDouble, b: Vector) -> Vector {
    std::array::from_fn(|axis| a[axis] + t * b[axis])
}

/// Rounded to `f64`.
pub fn rounded(a: Vector) -> glam::DVec3 {
    glam::DVec3::from_array(a.map(DoubleDouble::value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(x: f64) -> DoubleDouble {
        DoubleDouble { high: x, low: 0.0 }
    }

    #[test]
    fn small_parts_are_kept() {
        let tiny = exact(2f64.powi(-90));
        assert_eq!((exact(1.0) + tiny - exact(1.0)).value(), 2f64.powi(-90));
        // (1 + e)(1 - e) = 1 - e^2, of which f64 keeps nothing.
        let e = exact(2f64.powi(-40));
        let product = (exact(1.0) + e) * (exact(1.0) - e);
        assert_eq!((exact(1.0) - product).value(), 2f64.powi(-80));
    }

    #[test]
    fn quotients_are_right_to_thirty_digits() {
        let third = exact(1.0) / exact(3.0);
        assert!((third * exact(3.0) - exact(1.0)).value().abs() < 1e-31);
        assert!(third.low != 0.0);
        assert!(!(exact(1.0) / exact(0.0)).value().is_finite());
    }

    /// In `f64` the normal of this triangle is off by a quarter.
    #[test]
    fn normals_of_needles_are_right() {
        let vector = |x: [f32; 3]| x.map(DoubleDouble::from);
        let (up, next) = (1.0 + f32::EPSILON, f32::from_bits(1));
        let normal = cross(vector([1.0, up, 0.0]), vector([up, 1.0 + 2.0 * f32::EPSILON, next]));
        let e = f64::from(f32::EPSILON);
        // (1 + 2e) - (1 + e)^2 = -e^2.
        assert_eq!(normal[2].value(), -e * e);
        assert_eq!(rounded(normal).x, f64::from(up) * f64::from(next));
    }
}
