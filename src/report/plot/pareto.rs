//! The Pareto front: the methods that no other beats in both build time and trace time.

/// Indices of the points that no other point dominates, by growing x. A point dominates another if it is no
/// greater in either coordinate and smaller in one; of equal points the first stays. Points that are not
/// finite are never on the front.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    order.sort_by(|&i, &j| {
        let (a, b) = (points[i], points[j]);
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(i.cmp(&j))
    });
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let is_better = points[i].1 < best;
        best = best.min(points[i].1);
        is_better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dominated_points_are_left_out() {
        let points = [(1.0, 1.0), (0.5, 2.0), (2.0, 0.5), (2.0, 1.0), (1.5, 1.5), (0.4, 2.0)];
        assert_eq!(front(&points), [5, 0, 2]);
    }

    #[test]
    fn of_equal_points_one_stays() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [0]);
        assert_eq!(front(&[(1.0, 2.0), (1.0, 1.0)]), [1]);
        assert_eq!(front(&[(1.0, 1.0), (2.0, 1.0)]), [0]);
    }

    #[test]
    fn nothing_and_nonsense_have_no_front() {
        assert!(front(&[]).is_empty());
        assert_eq!(front(&[(f64::NAN, 0.0), (1.0, 1.0), (0.0, f64::INFINITY)]), [1]);
    }

    /// A point is off the front exactly if one on it dominates it, or equals it.
    #[test]
    fn every_other_point_is_dominated() {
        let points: Vec<(f64, f64)> =
            (0..200u32).map(|i| (f64::from(i * 7919 % 101), f64::from(i * 104_729 % 97))).collect();
        let front = front(&points);
        let dominates = |a: (f64, f64), b: (f64, f64)| a.0 <= b.0 && a.1 <= b.1 && a != b;
        for (i, &point) in points.iter().enumerate() {
            let beaten = front.iter().any(|&j| dominates(points[j], point) || points[j] == point && j != i);
            assert_ne!(front.contains(&i), beaten, "{point:?}");
        }
    }

    /// "The Pareto front is formed by Embree Morton, PHR-Fast, Embree SAH, PHR-HQ, and Embree Fast-Spatial."
    #[test]
    fn the_papers_front_is_the_one_it_states() {
        use crate::report::figures::Figure;
        use crate::report::means::Ratios;
        let builders: Vec<&str> = crate::report::paper::builders().collect();
        let mean = |builder, figure| Ratios::of_paper(builder, figure).arithmetic().unwrap();
        let points: Vec<(f64, f64)> =
            builders.iter().map(|b| (mean(b, Figure::Build), mean(b, Figure::Frame))).collect();
        let front: Vec<&str> = front(&points).into_iter().map(|i| builders[i]).collect();
        assert_eq!(front, ["embree-morton", "phr-fast", "embree-sah", "phr-hq", "embree-fast-spatial"]);
    }
}
