//! The total time of a tree as a line over the number of rays: build + rays / speed; which line is least where, the
//! crossings between them, and which lines cannot be told apart from the least.

use super::QuickVisit;
use crate::bench::statistics::Ratio;
use crate::bench::turns::paired::PairedMean;

/// A value with its 95 % interval.
pub type Estimate = Ratio;

/// The total time of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TotalTime {
    /// Build time, ms.
    pub build_ms: Estimate,
    /// Time per ray, ns.
    pub ns_per_ray: Estimate,
}

impl TotalTime {
    /// From visits: geometric means with Student's intervals; `None` without any. The ends of the interval of one visit
    /// are 0 and infinite.
    pub fn of(visits: &[QuickVisit]) -> Option<Self> {
        if visits.is_empty() {
            return None;
        }
        let mean = |figure: fn(&QuickVisit) -> f64| {
            let logs: Vec<f64> = visits.iter().map(|visit| figure(visit).ln()).collect();
            PairedMean::of(std::iter::once(&logs[..])).ratio()
        };
        Some(Self { build_ms: mean(|visit| visit.build_ms), ns_per_ray: mean(|visit| visit.ns_per_ray) })
    }

    /// A line without errors, of medians.
    pub fn exact(build_ms: f64, ns_per_ray: f64) -> Self {
        let exact = |value| Estimate { value, low: value, high: value };
        Self { build_ms: exact(build_ms), ns_per_ray: exact(ns_per_ray) }
    }

    /// The geometric mean of lines without errors; `None` of none.
    pub fn mean(lines: impl Iterator<Item = Self>) -> Option<Self> {
        let visit =
            |line: Self| QuickVisit { build_ms: line.build_ms.value, ns_per_ray: line.ns_per_ray.value };
        let mean = Self::of(&lines.map(visit).collect::<Vec<_>>())?;
        Some(Self::exact(mean.build_ms.value, mean.ns_per_ray.value))
    }

    /// Milliseconds for the build and so many rays.
    pub fn at(&self, rays: f64) -> f64 {
        self.build_ms.value + 1e-6 * self.ns_per_ray.value * rays
    }

    /// The same with its interval: the errors of both parts in quadrature.
    pub fn estimate_at(&self, rays: f64) -> Estimate {
        let (build, ray, scale) = (self.build_ms, self.ns_per_ray, 1e-6 * rays);
        let below = (build.value - build.low).hypot(scale * (ray.value - ray.low));
        let above = (build.high - build.value).hypot(scale * (ray.high - ray.value));
        let value = self.at(rays);
        Estimate { value, low: (value - below).max(0.0), high: value + above }
    }
}

/// The index of the least of `lines` at so many rays; `None` without lines.
pub fn least_at(lines: &[TotalTime], rays: f64) -> Option<usize> {
    (0..lines.len()).min_by(|&a, &b| lines[a].at(rays).total_cmp(&lines[b].at(rays)))
}

/// Which of `lines` cannot be told apart from the least at so many rays: their intervals overlap. The least is one.
pub fn not_told_apart(lines: &[TotalTime], rays: f64) -> Vec<bool> {
    let Some(least) = least_at(lines, rays) else { return Vec::new() };
    let high = lines[least].estimate_at(rays).high;
    lines.iter().map(|line| line.estimate_at(rays).low <= high).collect()
}

/// Which of `lines` may be the least for some number of rays: those that are it somewhere, and those that cannot be
/// told apart from it at one of `budgets`.
pub fn competing(lines: &[TotalTime], budgets: &[f64]) -> Vec<bool> {
    let mut found = vec![false; lines.len()];
    for (winner, _) in winners(lines) {
        found[winner] = true;
    }
    for &rays in budgets {
        for (competes, is_near) in found.iter_mut().zip(not_told_apart(lines, rays)) {
            *competes |= is_near;
        }
    }
    found
}

/// Which line is least where: indices, each with the number of rays from which on it is, upwards from 0.
pub fn winners(lines: &[TotalTime]) -> Vec<(usize, f64)> {
    let key = |i: usize| (lines[i].build_ms.value, lines[i].ns_per_ray.value);
    let order = |&a: &usize, &b: &usize| {
        let ((a, b), (c, d)) = (key(a), key(b));
        a.total_cmp(&c).then(b.total_cmp(&d))
    };
    let Some(first) = (0..lines.len()).min_by(order) else { return Vec::new() };
    let mut found = vec![(first, 0.0)];
    loop {
        let (last, from) = found[found.len() - 1];
        let (build, ray) = key(last);
        let crossing = |i: usize| {
            let (other_build, other_ray) = key(i);
            (other_ray < ray).then(|| (i, 1e6 * (other_build - build) / (ray - other_ray)))
        };
        let next = (0..lines.len()).filter_map(crossing).min_by(|(i, a), (j, b)| {
            // Of lines that cross at one place the flattest goes on.
            a.total_cmp(b).then(key(*i).1.total_cmp(&key(*j).1))
        });
        match next {
            Some((i, at)) => found.push((i, at.max(from))),
            None => return found,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn winners_are_the_least_everywhere() {
        let mut random = SplitMix64::new(1);
        for count in [1, 2, 5, 30] {
            let mut value = || f64::from(random.range(1.0, 100.0));
            let lines: Vec<TotalTime> = (0..count).map(|_| TotalTime::exact(value(), value())).collect();
            let found = winners(&lines);
            assert!(found.windows(2).all(|pair| pair[0].1 <= pair[1].1));
            for step in 0..120 {
                let rays = 10f64.powf(f64::from(step) / 12.0);
                let best = lines[least_at(&lines, rays).unwrap()].at(rays);
                let (winner, _) = *found.iter().rev().find(|(_, from)| *from <= rays).unwrap();
                assert!((lines[winner].at(rays) / best - 1.0).abs() < 1e-9, "{rays} of {count}");
            }
        }
        assert!(winners(&[]).is_empty());
    }

    #[test]
    fn lines_compete_where_they_are_least_or_intervals_overlap() {
        let line = |build_ms: f64, ns_per_ray: f64, error: f64| {
            let figure =
                |value: f64| Estimate { value, low: value / (1.0 + error), high: value * (1.0 + error) };
            TotalTime { build_ms: figure(build_ms), ns_per_ray: figure(ns_per_ray) }
        };
        let lines = [
            line(10.0, 200.0, 0.05),
            line(100.0, 100.0, 0.05),
            // Slower than the second everywhere, but one knows little of it.
            line(110.0, 115.0, 0.3),
            line(130.0, 150.0, 0.05),
            // The least below ten thousand rays alone, which no one asked for.
            line(9.0, 300.0, 0.05),
        ];
        assert_eq!(not_told_apart(&lines, 1e8), [false, true, true, false, false]);
        assert_eq!(competing(&lines, &[1e6, 1e8]), [true, true, true, false, true]);
        assert!(not_told_apart(&[], 1e8).is_empty() && competing(&[], &[1e8]).is_empty());
    }

    #[test]
    fn totals_and_their_intervals() {
        let visit = |build_ms, ns_per_ray| QuickVisit { build_ms, ns_per_ray };
        let one = TotalTime::of(&[visit(10.0, 100.0)]).unwrap();
        assert!((one.at(1e6) - 110.0).abs() < 1e-9);
        assert_eq!(one.estimate_at(1e6).high, f64::INFINITY);
        let three = TotalTime::of(&[visit(9.0, 100.0), visit(10.0, 100.0), visit(11.0, 100.0)]).unwrap();
        let total = three.estimate_at(1e6);
        assert!(total.low < 108.0 && total.value > 109.5 && total.high > 112.0, "{total:?}");
        assert!(three.estimate_at(1e9).high / three.at(1e9) < 1.01, "builds hardly count there");
        assert_eq!(TotalTime::of(&[]), None);
    }
}
