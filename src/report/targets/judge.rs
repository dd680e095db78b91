//! From rows to verdicts: what each builder reaches in every scene, and whether it meets the target.

use super::list::{MORE_THAN, MORE_THAN_FOR_PEAK, Measure, Target};
use crate::bench::rounds::paired;
use crate::bench::row::Row;
use crate::report::figures::interval::{Interval, Noise, Over, SceneRatio};
use crate::report::figures::{Figure, GRAFTED, PHR, Place, SceneFigures, Under, only, scenes};
use crate::report::means::Ratios;
use crate::scene::scalable_triangles;

/// Whether a target is met.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The mean and every scene are within their limits, with their whole 95 % intervals.
    Met,
    /// One of them is not.
    NotMet,
    /// The interval of one reaches over its limit.
    Undecided,
    /// The builder failed in this scene.
    Failed(String),
    /// The rows do not have it.
    NotMeasured,
    /// There is no limit.
    NoTarget,
}

impl Verdict {
    /// As a cell.
    pub fn cell(&self) -> String {
        match self {
            Self::Met => "met".into(),
            Self::NotMet => "not met".into(),
            Self::Undecided => "undecided".into(),
            Self::Failed(scene) => format!("not met: failed in {scene}"),
            Self::NotMeasured => "not measured".into(),
            Self::NoTarget => "-".into(),
        }
    }

    /// Whether a figure that lies in `interval` is at most `limit`.
    pub fn at_most(limit: f64, interval: Interval) -> Self {
        match (within(interval.low, limit), within(interval.high, limit)) {
            (_, true) => Self::Met,
            (true, false) => Self::Undecided,
            (false, false) => Self::NotMet,
        }
    }

    /// Whether a figure that lies in `interval` is at least `limit`.
    pub fn at_least(limit: f64, interval: Interval) -> Self {
        Self::at_most(1.0 / limit, Interval { low: 1.0 / interval.high, high: 1.0 / interval.low })
    }

    /// Of two verdicts on one target that which stands.
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::NotMet, _) | (_, Self::NotMet) => Self::NotMet,
            (Self::Undecided, _) | (_, Self::Undecided) => Self::Undecided,
            _ => Self::Met,
        }
    }
}

/// A target with what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// The target.
    pub target: Target,
    /// Mean over scenes: geometric of ratios, arithmetic of bytes.
    pub mean: Option<f64>,
    /// Its 95 % interval over scenes and rounds, of ratios.
    pub interval: Option<Interval>,
    /// Half its interval over rounds alone, as text.
    pub noise: String,
    /// The same mean under our kernel, of traces.
    pub under_phr: Option<f64>,
    /// The worst scene and its value.
    pub worst: Option<SceneRatio>,
    /// Scenes whose intervals reach over the limit of the worst.
    pub may_exceed: usize,
    /// Scenes behind the figures.
    pub scenes: usize,
    /// Scenes that could be.
    pub of_scenes: usize,
    /// Whether it is met.
    pub verdict: Verdict,
}

/// The rows that targets are judged by.
pub struct Judge {
    /// Rows with most threads, for all but the comparison of threads.
    main: Vec<Row>,
    one_thread: Vec<Row>,
    two_threads: Vec<Row>,
}

impl Judge {
    /// Partitions the rows of a run: large scenes only, without the scalable ones.
    pub fn new(rows: &[Row]) -> Self {
        let rows = only(rows, |row| row.triangles > MORE_THAN && scalable_triangles(&row.scene).is_none());
        let most = rows.iter().map(|row| row.threads).max();
        let with = |threads| only(&rows, |row| row.is_total() && Some(row.threads) == threads);
        Self { main: of_one_run_each(with(most)), one_thread: with(Some(1)), two_threads: with(Some(2)) }
    }

    /// Rows of large scenes with most threads.
    pub fn main(&self) -> &[Row] {
        &self.main
    }

    /// The measured values of `target`, and the verdict.
    pub fn judge(&self, target: &Target) -> Judged {
        let names = self.scenes(target.measure);
        let (mut values, mut failed) = (Ratios::default(), None);
        for name in &names {
            match self.value(target, name, GRAFTED) {
                Place::Value(value) => values.0.push(value),
                Place::Failed => failed = failed.or(Some(name.clone())),
                Place::Missing => {}
            }
        }
        let mean = mean(target.measure, &values);
        let worst = if is_at_least(target.measure) { values.least() } else { values.worst() }.cloned();
        let interval = values.interval(Over::ScenesAndRounds).filter(|_| !is_of_bytes(target.measure));
        let (of_scenes, may_exceed) =
            of_each(&values, |interval| verdict_on(target.measure, target.worst, Some(interval)));
        let verdict = match (failed, mean) {
            _ if target.mean.is_none() && target.worst.is_none() => Verdict::NoTarget,
            (Some(scene), _) => Verdict::Failed(scene),
            (None, None) => Verdict::NotMeasured,
            (None, Some(mean)) => {
                let exact = Interval { low: mean, high: mean };
                let of_mean = verdict_on(target.measure, target.mean, interval.or(Some(exact)));
                let verdict = of_mean.and(of_scenes);
                // The scenes that are missing may be the slow ones.
                if values.0.len() < names.len() { verdict.and(Verdict::Undecided) } else { verdict }
            }
        };
        let scenes = values.0.len();
        Judged {
            target: *target,
            mean,
            interval,
            noise: if is_of_bytes(target.measure) { String::new() } else { values.noise() },
            under_phr: self.under_phr(target, &names),
            worst,
            may_exceed,
            scenes,
            of_scenes: names.len(),
            verdict,
        }
    }

    fn under_phr(&self, target: &Target, names: &[String]) -> Option<f64> {
        let Measure::Trace(_) = target.measure else { return None };
        let value = |name: &String| self.value(target, name, PHR).value();
        Ratios(names.iter().filter_map(value).collect()).geometric()
    }

    /// Scenes that a measure is of.
    fn scenes(&self, measure: Measure) -> Vec<String> {
        match measure {
            Measure::Peak | Measure::PeakTo(_) => {
                scenes(&only(&self.main, |row| row.triangles > MORE_THAN_FOR_PEAK))
            }
            Measure::Threads => {
                let both = scenes(&self.one_thread);
                scenes(&self.two_threads).into_iter().filter(|name| both.contains(name)).collect()
            }
            Measure::Build(_) | Measure::Trace(_) | Measure::Tree => scenes(&self.main),
        }
    }

    /// The measured value of the builder in `scene`, traces under `kernel`.
    fn value(&self, target: &Target, scene: &str, kernel: &str) -> Place<SceneRatio> {
        let tree = (target.builder, target.width);
        let main = SceneFigures::of(&self.main, scene);
        let under = Under::One(kernel.into());
        let ratio = |base, figure| {
            let own = main.figure(tree, figure, &under);
            own.and_then(|_| main.ratio_to((base, target.width), tree, figure, &under))
        };
        let exact = |value| Some(SceneRatio { scene: scene.into(), value, noise: Noise::NONE });
        let per_triangle = |bytes: fn(&Row) -> Option<u64>| {
            main.build(tree).and_then(|row| exact(bytes(row)? as f64 / row.triangles as f64))
        };
        match target.measure {
            Measure::Build(base) => ratio(base, Figure::Build),
            Measure::Trace(base) => ratio(base, Figure::Trace),
            Measure::PeakTo(base) => main.build(tree).and_then(|row| {
                let base = main.build((base, target.width)).value()?;
                exact(row.peak_bytes? as f64 / base.peak_bytes? as f64)
            }),
            Measure::Peak => per_triangle(|row| row.peak_bytes),
            Measure::Tree => per_triangle(|row| row.bytes),
            Measure::Threads => {
                let one = SceneFigures::of(&self.one_thread, scene).build(tree);
                one.and_then(|one| {
                    // Times of two runs are not compared.
                    let of_run = only(&self.two_threads, |two| two.run_id == one.run_id);
                    let two = SceneFigures::of(&of_run, scene).build(tree).value()?;
                    let (a, b) = (one.build_ms()?, two.build_ms()?);
                    let pairs = paired(&one.by_round.build, &two.by_round.build);
                    let (value, noise) = (a.median / b.median, Noise::of(&a, &b, pairs));
                    Some(SceneRatio { scene: scene.into(), value, noise })
                })
            }
        }
    }
}

/// The rows of each scene that are of the run which has most of it: a build that failed there is not made good by
/// another run, whose times are not comparable.
fn of_one_run_each(rows: Vec<Row>) -> Vec<Row> {
    let main_run = |scene: &String| {
        let of_scene: Vec<&Row> = rows.iter().filter(|row| row.scene == *scene).collect();
        let count = |id: &str| of_scene.iter().filter(|row| row.run_id == id).count();
        // Of several with as many, the first.
        let run = of_scene.iter().map(|row| &row.run_id).rev().max_by_key(|id| count(id));
        (scene.clone(), run.cloned().unwrap_or_default())
    };
    let runs: Vec<(String, String)> = scenes(&rows).iter().map(main_run).collect();
    only(&rows, |row| runs.iter().any(|(scene, run)| (scene, run) == (&row.scene, &row.run_id)))
}

fn mean(measure: Measure, values: &Ratios) -> Option<f64> {
    if is_of_bytes(measure) { values.arithmetic() } else { values.geometric() }
}

/// True of bytes per triangle, false of ratios.
pub fn is_of_bytes(measure: Measure) -> bool {
    matches!(measure, Measure::Peak | Measure::Tree)
}

/// True if more is better.
pub fn is_at_least(measure: Measure) -> bool {
    measure == Measure::Threads
}

/// True up to the limit and at it, whatever the last bit of a mean.
pub fn within(value: f64, limit: f64) -> bool {
    const ROUNDING: f64 = 1e-9;
    value <= limit * (1.0 + ROUNDING)
}

/// The verdict on every scene: that of the largest ratio alone would let noise in another pass. And of how many it is
/// not [`Verdict::Met`].
pub fn of_each(ratios: &Ratios, verdict: impl Fn(Interval) -> Verdict) -> (Verdict, usize) {
    let verdicts: Vec<Verdict> = ratios.0.iter().map(|scene| verdict(scene.interval())).collect();
    let beyond = verdicts.iter().filter(|verdict| **verdict != Verdict::Met).count();
    (verdicts.into_iter().fold(Verdict::Met, Verdict::and), beyond)
}

/// A limit that is not set is met.
fn verdict_on(measure: Measure, limit: Option<f64>, interval: Option<Interval>) -> Verdict {
    match limit.zip(interval) {
        None => Verdict::Met,
        Some((limit, interval)) if is_at_least(measure) => Verdict::at_least(limit, interval),
        Some((limit, interval)) => Verdict::at_most(limit, interval),
    }
}
