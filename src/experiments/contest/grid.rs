//! The grid of alpha and delta of equation 2 (paper 5.4): its points, its fronts, and each scene's best points.

use super::compared::{FIGURES, Mean, OF_TREES, name as name_of};
use super::experiment::{Among, Comparison, Expectation, Families};
use super::variants::changed;
use crate::bench::row::Row;
use crate::builders::PhrConfig;
use crate::report::figures::{Figure, SceneFigures, Under};
use crate::report::grid::Grid;
use crate::report::means::Ratios;
use crate::report::plot::pareto::front;

/// The paper's values.
const ALPHAS: [f32; 4] = [0.45, 0.5, 0.55, 0.65];
const DELTAS: [f32; 6] = [5.0, 6.0, 7.0, 8.0, 9.0, 10.0];

/// A point may take so many times a preset's steps and still count as equal to it.
const EQUAL: f64 = 1.01;

/// Alpha and delta.
type Point = (f32, f32);

fn name(alpha: f32, delta: f32) -> String {
    changed("phr-hq", &format!("alpha={alpha}+delta={delta}"))
}

fn label(alpha: f32, delta: f32) -> String {
    format!("{alpha}, {delta}")
}

fn points() -> impl Iterator<Item = Point> {
    ALPHAS.into_iter().flat_map(|alpha| DELTAS.map(|delta| (alpha, delta)))
}

fn preset(config: &PhrConfig) -> String {
    name(config.alpha, config.delta)
}

/// A builder for each point.
pub fn variants() -> Vec<String> {
    points().map(|(alpha, delta)| name(alpha, delta)).collect()
}

/// What the paper compares: (0.5, 7) with PHR-HQ, (0.5, 5) with PHR-Fast.
pub fn comparisons() -> Vec<Comparison> {
    let expected =
        |says, figure, range, scenes| Expectation { says, figure, range, among: Among::Paper(scenes) };
    const LARGE: &[&str] = &["San Miguel", "Powerplant"];
    let of_hq = [
        expected("it builds about 35 % faster there", Figure::Build, (0.55, 0.75), LARGE),
        expected("it traces no slower there", Figure::Trace, (0.0, 1.0), LARGE),
    ];
    let of_fast = [
        expected("it builds 9 % faster in Conference", Figure::Build, (0.86, 0.96), &["Conference"]),
        expected("it builds 33 % faster in Hairball", Figure::Build, (0.57, 0.77), &["Hairball"]),
        expected("it traces as fast in both", Figure::Trace, (0.97, 1.03), &["Conference", "Hairball"]),
    ];
    vec![
        Comparison { changed: name(0.5, 7.0), base: preset(&PhrConfig::HQ), expected: of_hq.into() },
        Comparison { changed: name(0.5, 5.0), base: preset(&PhrConfig::FAST), expected: of_fast.into() },
    ]
}

/// A line for each alpha, by delta.
pub fn families() -> Families {
    let line = |alpha: f32| {
        let points = DELTAS.map(|delta| (name(alpha, delta), label(alpha, delta)));
        (format!("alpha {alpha}, delta 5 to 10"), points.into())
    };
    Families { base: preset(&PhrConfig::HQ), lines: ALPHAS.map(line).into() }
}

/// The grid's figures in a run.
struct Measured<'a> {
    scenes: Vec<SceneFigures<'a>>,
    width: u32,
    under: &'a Under,
}

/// The range of the grid and its fronts in the mean, and each scene's best points beside the presets.
pub fn findings(rows: &[Row], width: u32, under: &Under) -> String {
    let measured = Measured { scenes: SceneFigures::all(rows), width, under };
    let range = measured.range();
    if range.is_empty() {
        return range;
    }
    let fronts: String = OF_TREES.iter().map(|&figure| measured.front(figure)).collect();
    format!(
        "{range}The front in the mean over scenes, build time and each figure relative to PHR-HQ:\n\n{fronts}\n{}",
        measured.best_points()
    )
}

impl Measured<'_> {
    fn ratios(&self, (alpha, delta): Point, base: &str, figure: Figure) -> Ratios {
        let (base, own) = ((base, self.width), name(alpha, delta));
        Ratios::among(&self.scenes, base, (&own, self.width), figure, self.under)
    }

    /// The points that have both figures: build time, and `figure`, in the mean relative to PHR-HQ.
    fn known(&self, figure: Figure) -> Vec<(Point, (f64, f64))> {
        let base = preset(&PhrConfig::HQ);
        let mean = |point, figure| self.ratios(point, &base, figure).geometric();
        points()
            .filter_map(|point| Some((point, (mean(point, Figure::Build)?, mean(point, figure)?))))
            .collect()
    }

    /// From where to where the means go; empty without figures.
    fn range(&self) -> String {
        let of = |figure: Figure| {
            let known = self.known(figure);
            let values = || known.iter().map(|(_, at)| at.1);
            let (least, most) = (values().reduce(f64::min)?, values().reduce(f64::max)?);
            Some(format!("{} {least:.2} to {most:.2}", name_of(figure)))
        };
        let told: Vec<String> = FIGURES.iter().filter_map(|&figure| of(figure)).collect();
        if told.is_empty() {
            return String::new();
        }
        format!("All points in the mean, relative to PHR-HQ: {}.\n\n", told.join(", "))
    }

    /// A line with the front of build time against `figure`, and how far the presets are from it.
    fn front(&self, figure: Figure) -> String {
        let known = self.known(figure);
        let on_front = front(&known.iter().map(|(_, at)| *at).collect::<Vec<_>>());
        if on_front.is_empty() {
            return String::new();
        }
        let told = |i: &usize| {
            let ((alpha, delta), (build, value)) = known[*i];
            format!("({alpha}, {delta}) {build:.2} {value:.3}")
        };
        let preset_told = |says: &str, config: &PhrConfig| {
            let own = known.iter().position(|(point, _)| *point == (config.alpha, config.delta));
            match own {
                None => format!("{says} was not measured."),
                Some(i) if on_front.contains(&i) => format!("{says} is on it."),
                Some(i) => {
                    // Of those that build no slower, the one on the front with the least figure.
                    let better = on_front.iter().filter(|&&other| known[other].1.0 <= known[i].1.0);
                    let better = better.min_by(|&&a, &&b| known[a].1.1.total_cmp(&known[b].1.1));
                    let Some(&(point, _)) = better.map(|&i| &known[i]) else { return String::new() };
                    let mean = Mean::of(&self.ratios(point, &preset(config), figure));
                    let mean = mean.map_or_else(String::new, |mean| mean.shown());
                    let ((alpha, delta), figure) = (point, name_of(figure));
                    format!(
                        "{says} is not on it: ({alpha}, {delta}) builds no slower, and has {mean} of its {figure}."
                    )
                }
            }
        };
        format!(
            "* by {}: {}. {} {}\n",
            name_of(figure),
            on_front.iter().map(told).collect::<Vec<_>>().join(", "),
            preset_told("PHR-Fast", &PhrConfig::FAST),
            preset_told("PHR-HQ", &PhrConfig::HQ)
        )
    }

    /// The best points of each scene by steps, which have no noise.
    fn best_points(&self) -> String {
        let header =
            ["scene", "as PHR-HQ", "build", "steps", "as PHR-Fast", "build", "steps", "on the front"];
        let mut grid = Grid::new(header);
        for scene in &self.scenes {
            let mut line = vec![scene.scene().to_owned()];
            for config in [PhrConfig::HQ, PhrConfig::FAST] {
                line.extend(self.best(scene, &preset(&config)));
            }
            let here = self.relative(scene, &preset(&PhrConfig::HQ));
            let on_front = front(&here.iter().map(|(_, at)| *at).collect::<Vec<_>>());
            let names = on_front.into_iter().map(|i| format!("({}, {})", here[i].0.0, here[i].0.1));
            line.push(names.collect::<Vec<_>>().join(" "));
            grid.push(line);
        }
        format!(
            "{}\nas PHR-HQ, as PHR-Fast: the point (alpha, delta) that builds fastest of those whose rays take at most 1 % more \
             steps than the preset's, with its build time and steps relative to these. The front is that of build time \
             against steps.\n",
            grid.markdown()
        )
    }

    /// The points' build times and steps in a scene, relative to a builder's.
    fn relative(&self, scene: &SceneFigures<'_>, base: &str) -> Vec<(Point, (f64, f64))> {
        let at = |(alpha, delta): Point| {
            let (base, own) = ((base, self.width), name(alpha, delta));
            let ratio = |figure| Some(scene.ratio_to(base, (&own, self.width), figure, self.under)?.value);
            Some((ratio(Figure::Build)?, ratio(Figure::Steps)?))
        };
        points().filter_map(|point| Some((point, at(point)?))).collect()
    }

    /// The point of a scene that builds fastest of those with as few steps as the preset, and its build time and steps
    /// relative to that.
    fn best(&self, scene: &SceneFigures<'_>, preset: &str) -> [String; 3] {
        let known = self.relative(scene, preset);
        let equal = known.into_iter().filter(|(_, (_, steps))| *steps <= EQUAL);
        let found = equal.min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        found.map_or_else(Default::default, |((alpha, delta), (build, steps))| {
            [format!("({alpha}, {delta})"), format!("{build:.2}"), format!("{steps:.2}")]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{GRAFTED, PHR};

    /// A point whose builds, steps and traces are told, its cost alike in all.
    fn rows(point: Point, build: f64, steps: f64, trace: f64) -> [Row; 2] {
        [GRAFTED, PHR].map(|kernel| Row {
            sah: Some(5.0),
            node_visits_per_ray: (kernel == PHR).then_some(steps),
            block_tests_per_ray: (kernel == PHR).then_some(0.0),
            ..Row::by_hand(&name(point.0, point.1), 4, kernel, build, trace)
        })
    }

    #[test]
    fn presets_are_judged_by_each_figure_on_its_own() {
        let rows = [
            rows((0.55, 9.0), 10.0, 8.0, 9.0),
            // Builds faster than PHR-HQ and traces faster, but its rays take more steps.
            rows((0.5, 7.0), 8.0, 9.0, 6.0),
            rows((0.5, 6.0), 7.0, 12.0, 12.0),
            rows((0.45, 7.0), 6.0, 10.0, 12.0),
        ]
        .concat();
        let text = findings(&rows, 4, &Under::best(&rows));
        let line = |figure: &str| {
            let start = format!("* by {figure}: ");
            text.lines()
                .find_map(|line| line.strip_prefix(&start))
                .unwrap_or_else(|| panic!("{text}"))
                .to_owned()
        };
        assert!(
            line("steps").starts_with("(0.45, 7) 0.60 1.250, (0.5, 7) 0.80 1.125, (0.55, 9) 1.00 1.000.")
        );
        assert!(line("steps").ends_with("of its steps. PHR-HQ is on it."), "{text}");
        assert!(
            line("steps")
                .contains("PHR-Fast is not on it: (0.45, 7) builds no slower, and has 0.83 [0.83, 0.83] of")
        );
        assert!(
            line("trace").contains("PHR-HQ is not on it: (0.5, 7) builds no slower, and has 0.67"),
            "{text}"
        );
        assert!(
            text.contains("relative to PHR-HQ: build 0.60 to 1.00, SAH cost 1.00 to 1.00, steps"),
            "{text}"
        );
        let best: Vec<&str> =
            text.lines().find(|line| line.starts_with("| a ")).unwrap().split('|').map(str::trim).collect();
        assert_eq!(best[2..8], ["(0.55, 9)", "1.00", "1.00", "(0.45, 7)", "0.86", "0.83"], "{text}");
        assert!(findings(&[], 4, &Under::Own).is_empty());
    }
}
