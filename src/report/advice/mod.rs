//! Which builder for a scene and a number of rays: total time = build + rays / speed for every tree, who wins
//! where, and where the lines cross. From a quick measurement ([`measured`]), whose noise [`estimate`] bears, or from
//! a [`model`] over the mesh's facts. [`page`] is the text, [`rows`] the CSV, [`tuned`] the page of a search,
//! [`tuned_rows`] its CSV, [`crate::report::plot::total_time`] the plot.

pub mod estimate;
pub mod measured;
pub mod model;
pub mod page;
pub mod rows;
pub mod tuned;
pub mod tuned_rows;

#[cfg(test)]
mod simulated;

use super::figures::tree_name;
use crate::bench::quick::line::{TotalTime, least_at, not_told_apart, winners};
use crate::bench::quick::survey::Surveyed;
use estimate::{Traced, estimates};

/// Trees of a model that take at most this many times as long as the best are near it.
pub const NEAR: f64 = 1.05;

/// What is known of a tree.
#[derive(Clone, Debug)]
pub struct Known {
    /// The builder.
    pub builder: String,
    /// Children per node.
    pub width: u32,
    /// Its total time; `None` where there is none.
    pub line: Option<TotalTime>,
    /// What its total time was estimated from; `None` for a model's.
    pub traced: Option<Traced>,
    /// Visits behind it; 0 for a model's.
    pub rounds: usize,
    /// Why there is no line, or no further round.
    pub note: String,
}

impl Known {
    /// The tree's name.
    pub fn name(&self) -> String {
        tree_name((&self.builder, self.width))
    }

    /// The trees of a survey, their total times estimated from all of them together.
    pub fn of_survey(surveyed: &[Surveyed]) -> Vec<Self> {
        let mut all: Vec<Self> = surveyed.iter().map(Self::measured).collect();
        let traced: Vec<Traced> = all.iter().filter_map(|known| known.traced).collect();
        let lines = all.iter_mut().filter_map(|known| known.line.as_mut());
        for (line, estimate) in lines.zip(estimates(&traced)) {
            *line = estimate;
        }
        all
    }

    /// As measured.
    fn measured(surveyed: &Surveyed) -> Self {
        let Surveyed { cell, visits, nodes_per_ray, note } = surveyed;
        let (width, line) = (cell.width, TotalTime::of(visits));
        let traced = line.map(|line| Traced {
            width,
            build_ms: line.build_ms,
            ns_per_ray: line.ns_per_ray,
            visits: visits.len(),
            nodes_per_ray: *nodes_per_ray,
        });
        let (builder, note) = (cell.builder.clone(), note.clone());
        Self { builder, width, line, traced, rounds: visits.len(), note }
    }
}

/// Advice for a scene.
#[derive(Clone, Debug)]
pub struct Advice {
    /// The scene.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// The number of rays asked for.
    pub rays: f64,
    /// How the lines came about, in words.
    pub origin: String,
    /// The kernel whose traces they are of.
    pub kernel: String,
    /// The share of the time that other programs held the processors during the measurement; 0 without one.
    pub busy: f64,
    /// All trees.
    pub trees: Vec<Known>,
}

impl Advice {
    /// The trees with lines.
    pub fn lines(&self) -> Vec<(&Known, TotalTime)> {
        self.trees.iter().filter_map(|known| Some((known, known.line?))).collect()
    }

    /// The trees that win somewhere, each with the number of rays from which on it does.
    pub fn winners(&self) -> Vec<(&Known, f64)> {
        let lines = self.lines();
        let only: Vec<TotalTime> = lines.iter().map(|(_, line)| *line).collect();
        winners(&only).into_iter().map(|(i, from)| (lines[i].0, from)).collect()
    }

    /// The best tree for so many rays, and those near it: whose interval overlaps with its; by a model, whose errors
    /// are much the same for all trees, those that take at most [`NEAR`] times as long.
    pub fn best_at(&self, rays: f64) -> Option<(&Known, Vec<&Known>)> {
        let lines = self.lines();
        let only: Vec<TotalTime> = lines.iter().map(|(_, line)| *line).collect();
        let best = least_at(&only, rays)?;
        let overlaps = not_told_apart(&only, rays);
        let is_near = |i: usize| match lines[i].0.rounds {
            0 => only[i].at(rays) <= NEAR * only[best].at(rays),
            _ => overlaps[i],
        };
        let near = (0..lines.len()).filter(|&i| i != best && is_near(i));
        let mut near: Vec<usize> = near.collect();
        near.sort_by(|&a, &b| only[a].at(rays).total_cmp(&only[b].at(rays)));
        Some((lines[best].0, near.into_iter().map(|i| lines[i].0).collect()))
    }
}

/// A number of rays in words: `50M`.
pub fn rays_in_words(rays: f64) -> String {
    let units = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")];
    let (unit, suffix) = units.into_iter().find(|(unit, _)| rays >= 0.9995 * unit).unwrap_or((1.0, ""));
    let text = format!("{:.*}", if rays / unit < 9.995 { 1 } else { 0 }, rays / unit);
    format!("{}{suffix}", text.strip_suffix(".0").unwrap_or(&text))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::bench::quick::QuickVisit;
    use crate::bench::quick::survey::DROPPED;

    pub(crate) fn advice() -> Advice {
        let known = |builder: &str, width, line| Known {
            builder: builder.into(),
            width,
            line,
            traced: None,
            rounds: 3,
            note: String::new(),
        };
        let exact = |build, ray| Some(TotalTime::exact(build, ray));
        Advice {
            scene: "a, b".into(),
            triangles: 1000,
            rays: 5e7,
            origin: "made by hand".into(),
            kernel: "embree-grafted".into(),
            busy: 0.0,
            trees: vec![
                known("lbvh", 4, exact(10.0, 200.0)),
                known("phr-speed", 8, exact(50.0, 120.0)),
                known("phr-best", 8, exact(200.0, 100.0)),
                known("aac", 4, exact(300.0, 150.0)),
                Known { note: DROPPED.into(), ..known("hunt-50", 4, exact(400.0, 300.0)) },
                Known { note: "no time".into(), ..known("hunt-500", 8, None) },
            ],
        }
    }

    #[test]
    fn winners_cross_where_totals_are_equal() {
        let advice = advice();
        let found: Vec<(String, f64)> =
            advice.winners().iter().map(|(known, from)| (known.name(), *from)).collect();
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["lbvh", "phr-speed / 8", "phr-best / 8"]);
        assert!((found[1].1 - 5e5).abs() < 1.0 && (found[2].1 - 7.5e6).abs() < 1.0, "{found:?}");
        let (best, near) = advice.best_at(5e7).unwrap();
        assert_eq!((best.name().as_str(), near.len()), ("phr-best / 8", 0));

        // A note does not tell trees apart, intervals do.
        let mut unsure = advice.clone();
        for known in &mut unsure.trees[3..5] {
            known.line = TotalTime::of(&[QuickVisit { build_ms: 300.0, ns_per_ray: 150.0 }]);
        }
        let (_, near) = unsure.best_at(5e7).unwrap();
        let near: Vec<String> = near.into_iter().map(Known::name).collect();
        assert_eq!(near, ["aac", "hunt-50"]);
    }

    #[test]
    fn a_survey_is_known_by_its_estimates() {
        let of = |builder: &str, ns: &[f64], nodes_per_ray| Surveyed {
            cell: crate::bench::cell::Cell::new(builder, 4, &[]),
            visits: ns.iter().map(|&ns_per_ray| QuickVisit { build_ms: 10.0, ns_per_ray }).collect(),
            nodes_per_ray,
            note: String::new(),
        };
        let surveyed = [
            of("disturbed", &[150.0], Some(20.0)),
            of("late", &[], None),
            of("known", &[100.0, 101.0, 99.0, 100.0], Some(20.0)),
        ];
        let known = Known::of_survey(&surveyed);
        let [disturbed, late, sure] = &known[..] else { panic!("three trees") };
        assert!(late.line.is_none() && late.traced.is_none());
        let ns = |known: &Known| known.line.unwrap().ns_per_ray.value;
        assert!(ns(disturbed) < 140.0 && (ns(sure) - 100.0).abs() < 10.0, "{known:?}");
        assert!((disturbed.traced.unwrap().ns_per_ray.value - 150.0).abs() < 1e-9, "as measured");
    }

    #[test]
    fn numbers_of_rays_are_short() {
        let words = [1e5, 5e7, 1e9, 2.5e6, 999_999.0, 12.0].map(rays_in_words);
        assert_eq!(words, ["100k", "50M", "1G", "2.5M", "1M", "12"]);
    }
}
