//! From rows to verdicts: what each builder reaches in every scene, and whether it meets the target.

use super::list::{MORE_THAN, MORE_THAN_FOR_PEAK, Measure, Target};
use crate::bench::row::Row;
use crate::report::figures::{Figure, GRAFTED, PHR, Place, SceneFigures, Under, WIDTH, only, scenes};
use crate::report::means::Ratios;
use crate::scene::scalable_triangles;

/// Whether a target is met.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Mean and worst scene are within their limits.
    Met,
    /// One of them is not.
    NotMet,
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
            Self::Failed(scene) => format!("not met: failed in {scene}"),
            Self::NotMeasured => "not measured".into(),
            Self::NoTarget => "-".into(),
        }
    }

    /// [`Verdict::Met`] or [`Verdict::NotMet`].
    pub fn of(is_met: bool) -> Self {
        if is_met { Self::Met } else { Self::NotMet }
    }
}

/// A target with what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// The target.
    pub target: Target,
    /// Mean over scenes: geometric of ratios, arithmetic of bytes.
    pub mean: Option<f64>,
    /// The same mean under our kernel, of traces.
    pub under_phr: Option<f64>,
    /// The worst scene and its value.
    pub worst: Option<(String, f64)>,
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
        Self { main: with(most), one_thread: with(Some(1)), two_threads: with(Some(2)) }
    }

    /// The measured values of `target`, and the verdict.
    pub fn judge(&self, target: &Target) -> Judged {
        let names = self.scenes(target.measure);
        let (mut values, mut failed) = (Ratios::default(), None);
        for name in &names {
            match self.value(target, name, GRAFTED) {
                Place::Value(value) => values.0.push((name.clone(), value)),
                Place::Failed => failed = failed.or(Some(name.clone())),
                Place::Missing => {}
            }
        }
        let mean = mean(target.measure, &values);
        let worst = if is_at_least(target.measure) { values.least() } else { values.worst() }.cloned();
        let verdict = match (failed, mean, &worst) {
            _ if target.mean.is_none() && target.worst.is_none() => Verdict::NoTarget,
            (Some(scene), ..) => Verdict::Failed(scene),
            (None, Some(mean), Some((_, worst))) => {
                Verdict::of(reaches(target, mean, target.mean) && reaches(target, *worst, target.worst))
            }
            _ => Verdict::NotMeasured,
        };
        let scenes = values.0.len();
        Judged {
            target: *target,
            mean,
            under_phr: self.under_phr(target, &names),
            worst,
            scenes,
            of_scenes: names.len(),
            verdict,
        }
    }

    fn under_phr(&self, target: &Target, names: &[String]) -> Option<f64> {
        let Measure::Trace(_) = target.measure else { return None };
        let value = |name: &String| Some((name.clone(), self.value(target, name, PHR).value()?));
        Ratios(names.iter().filter_map(value).collect()).geometric()
    }

    /// Scenes that a measure is of.
    fn scenes(&self, measure: Measure) -> Vec<String> {
        match measure {
            Measure::Peak => scenes(&only(&self.main, |row| row.triangles > MORE_THAN_FOR_PEAK)),
            Measure::Threads => {
                let both = scenes(&self.one_thread);
                scenes(&self.two_threads).into_iter().filter(|name| both.contains(name)).collect()
            }
            Measure::Build(_) | Measure::Trace(_) | Measure::Tree => scenes(&self.main),
        }
    }

    /// The measured value of the builder in `scene`, traces under `kernel`.
    fn value(&self, target: &Target, scene: &str, kernel: &str) -> Place<f64> {
        let tree = (target.builder, WIDTH);
        let main = SceneFigures::of(&self.main, scene);
        let under = Under::One(kernel.into());
        let ratio = |base, figure| {
            let own = main.figure(tree, figure, &under);
            own.and_then(|_| Some(main.ratio_to((base, WIDTH), tree, figure, &under)?.value))
        };
        let per_triangle = |bytes: fn(&Row) -> Option<u64>| {
            main.build(tree).and_then(|row| Some(bytes(row)? as f64 / row.triangles as f64))
        };
        match target.measure {
            Measure::Build(base) => ratio(base, Figure::Build),
            Measure::Trace(base) => ratio(base, Figure::Trace),
            Measure::Peak => per_triangle(|row| row.peak_bytes),
            Measure::Tree => per_triangle(|row| row.bytes),
            Measure::Threads => {
                let one = SceneFigures::of(&self.one_thread, scene).build(tree);
                one.and_then(|one| {
                    // Times of two runs are not compared.
                    let of_run = only(&self.two_threads, |two| two.run_id == one.run_id);
                    let two = SceneFigures::of(&of_run, scene).build(tree).value()?;
                    Some(one.build_ms_median? / two.build_ms_median?)
                })
            }
        }
    }
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

fn reaches(target: &Target, value: f64, limit: Option<f64>) -> bool {
    limit.is_none_or(
        |limit| {
            if is_at_least(target.measure) { within(limit, value) } else { within(value, limit) }
        },
    )
}
