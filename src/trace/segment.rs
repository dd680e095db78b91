//! Segments in extended precision (`double_double`): how far a point or a ray is from one or from its line, and at what
//! angle.

use super::double_double::{self as extended, Vector};

/// All between two points, which may be the same.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    start: Vector,
    along: Vector,
}

impl Segment {
    /// From `start` to `end`.
    pub fn new(start: Vector, end: Vector) -> Self {
        Self { start, along: extended::difference(end, start) }
    }

    /// The longest edge of a triangle: all of it where it has no area.
    pub fn longest([a, b, c]: [Vector; 3]) -> Self {
        let longer = |one: Self, other: Self| if other.length() > one.length() { other } else { one };
        longer(longer(Self::new(a, b), Self::new(b, c)), Self::new(c, a))
    }

    fn length(&self) -> f64 {
        extended::rounded(self.along).length()
    }

    /// The distance of a point.
    pub fn distance(&self, point: Vector) -> f64 {
        let along = extended::rounded(self.along);
        let from_start = extended::rounded(extended::difference(point, self.start));
        let squared = along.length_squared();
        let share = if squared > 0.0 { (from_start.dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
        from_start.distance(share * along)
    }

    /// The sine of the angle with a direction; 1 for a point, which has none.
    pub fn sine(&self, dir: Vector) -> f64 {
        let product = self.length() * extended::rounded(dir).length();
        let across = extended::rounded(extended::cross(dir, self.along)).length();
        if product > 0.0 { across / product } else { 1.0 }
    }

    /// Parameter within `interval` at which a ray is nearest, and how far it is there: where the two lines are nearest
    /// to each other, beside an end of the segment, or at an end of the interval.
    pub fn nearest(&self, org: Vector, dir: Vector, interval: [f64; 2]) -> (f64, f64) {
        let to_start = extended::difference(self.start, org);
        let to_end = extended::along(to_start, 1f64.into(), self.along);
        let across = extended::cross(dir, self.along);
        let of_lines =
            extended::dot(extended::cross(to_start, self.along), across) / extended::dot(across, across);
        let [start, end] = [to_start, to_end].map(|to| extended::dot(to, dir) / extended::dot(dir, dir));
        [of_lines, start, end]
            .map(|t| t.value().max(interval[0]).min(interval[1]))
            .into_iter()
            .chain(interval)
            .filter(|t| t.is_finite())
            .map(|t| (t, self.distance(extended::along(org, t.into(), dir))))
            .fold((interval[0], f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// Parameter at which the line of a ray is nearest to the line through the segment, and how far it is there; beside
    /// the start where both have one direction, or the segment is a point.
    pub fn line_nearest(&self, org: Vector, dir: Vector) -> (f64, f64) {
        let to_start = extended::difference(self.start, org);
        let across = extended::cross(dir, self.along);
        let of_lines =
            extended::dot(extended::cross(to_start, self.along), across) / extended::dot(across, across);
        if of_lines.value().is_finite() {
            let apart = extended::dot(to_start, across).value() / extended::rounded(across).length();
            return (of_lines.value(), apart.abs());
        }
        let t = extended::dot(to_start, dir) / extended::dot(dir, dir);
        let apart = extended::difference(extended::along(org, t, dir), self.start);
        (t.value(), extended::rounded(apart).length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVER: [f64; 2] = [0.0, f64::INFINITY];

    fn vector(x: [f32; 3]) -> Vector {
        x.map(Into::into)
    }

    /// Along x from 0 to 4.
    fn segment() -> Segment {
        let [a, b, c] = [[0.0; 3], [4.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(vector);
        for corners in [[a, b, c], [b, c, a], [c, a, b]] {
            assert_eq!(Segment::longest(corners).length(), 4.0);
        }
        Segment::longest([a, b, c])
    }

    #[test]
    fn points_beside_and_beyond() {
        let distance = |x| segment().distance(vector(x));
        assert_eq!(distance([2.0, 3.0, 4.0]), 5.0);
        assert_eq!(distance([-3.0, 4.0, 0.0]), 5.0);
        assert_eq!(distance([7.0, 0.0, -4.0]), 5.0);
        let point = Segment::new(vector([1.0; 3]), vector([1.0; 3]));
        assert_eq!(point.distance(vector([1.0, 1.0, 3.0])), 2.0);
        assert_eq!((point.sine(vector([1.0; 3])), segment().sine(vector([2.0, 0.0, 0.0]))), (1.0, 0.0));
    }

    #[test]
    fn rays_across_beyond_behind_and_along() {
        let nearest = |org, dir, interval| segment().nearest(vector(org), vector(dir), interval);
        // Its line passes at 2 above, at a parameter of 5.
        let (org, down) = ([3.0, 2.0, 10.0], [0.0, 0.0, -2.0]);
        assert_eq!(nearest(org, down, EVER), (5.0, 2.0));
        assert_eq!(nearest(org, down, [0.0, 3.5]), (3.5, 13f64.sqrt()));
        assert_eq!(nearest(org, down, [5.5, 9.0]), (5.5, 5f64.sqrt()));
        assert_eq!(nearest(org, [0.0, 0.0, 1.0], EVER), (0.0, 104f64.sqrt()));
        assert_eq!(nearest([7.0, 4.0, 1.0], [0.0, 0.0, -1.0], EVER), (1.0, 5.0));
        // Lines meet at x = 6; the ray is nearest to the end.
        assert_eq!(nearest([8.0, 2.0, 0.0], [-1.0, -1.0, 0.0], EVER), (3.0, 2f64.sqrt()));
        assert_eq!(nearest([-5.0, 3.0, 0.0], [1.0, 0.0, 0.0], EVER).1, 3.0);
        assert_eq!(nearest([6.0, 0.0, 0.0], [1.0, 0.0, 0.0], EVER), (0.0, 2.0));
    }

    #[test]
    fn lines_have_no_ends() {
        let nearest = |org, dir| segment().line_nearest(vector(org), vector(dir));
        for x in [-900.0, 3.0, 7.0] {
            assert_eq!(nearest([x, 2.0, 10.0], [0.0, 0.0, -2.0]), (5.0, 2.0));
            assert_eq!(nearest([x, 2.0, 10.0], [0.0, 0.0, 2.0]), (-5.0, 2.0), "behind the origin");
            assert_eq!(nearest([x, 3.0, 4.0], [0.5, 0.0, 0.0]).1, 5.0, "along");
        }
        assert_eq!(nearest([8.0, 2.0, 0.0], [-1.0, -1.0, 0.0]), (2.0, 0.0));
        let point = Segment::new(vector([1.0; 3]), vector([1.0; 3]));
        assert_eq!(point.line_nearest(vector([1.0, 4.0, 3.0]), vector([0.0, 0.0, -1.0])), (2.0, 3.0));
    }
}
