//! Two runs compared, figure by figure: is B faster than A, slower or the same, as far as the interval of
//! the ratio can tell?

use crate::bench::cell::Kernel;
use crate::bench::environment::Environment;
use crate::bench::files::RecordsError;
use crate::bench::files::read_json;
use crate::bench::results_dir;
use crate::bench::rounds::{ByRound, paired};
use crate::bench::row::{self, ALL, Row};
use crate::bench::samples::{CellSamples, SAMPLES, Samples};
use crate::bench::statistics::{Ratio, Summary};
use crate::bench::turns::paired::PairedMean;
use crate::bench::visit_times::{all_ms, times};
use crate::report::figures::interval::LEAST_ROUNDS;
use crate::report::grid::{Grid, short};
use crate::trace::RayKind;
use std::collections::HashSet;
use std::path::Path;

/// A run as it lies on disk.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// Its rows.
    pub rows: Vec<Row>,
    /// Its samples, if they were kept.
    pub samples: Option<Samples>,
    /// Where it was made, if that was kept.
    pub environment: Option<Environment>,
}

impl Recorded {
    /// Reads a results folder, or a CSV alone.
    ///
    /// # Errors
    /// No such rows; samples or environment that are there but cannot be read.
    pub fn read(path: &Path) -> Result<Self, RecordsError> {
        let samples = path.join(SAMPLES);
        let remedy = "fetch it again, or remove it: then single views have no times by round";
        Ok(Self {
            rows: row::read(path)?,
            samples: samples.is_file().then(|| read_json(&samples, remedy)).transpose()?,
            environment: results_dir::environment(path)?,
        })
    }

    fn cell(&self, row: &Row) -> Option<&CellSamples> {
        let scene = self.samples.as_ref()?.scene(&row.scene)?;
        scene.cells.iter().find(|cell| cell.cell.builder == row.builder && cell.cell.width == row.width)
    }
}

/// What a comparison says of B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// The whole interval lies above the threshold.
    Slower,
    /// The interval reaches over a threshold, or nothing is known of the spread.
    Inconclusive,
    /// The whole interval lies below the threshold.
    Faster,
    /// The whole interval lies between the thresholds.
    Same,
}

impl Change {
    /// All, the worst first.
    pub const ALL: [Self; 4] = [Self::Slower, Self::Inconclusive, Self::Faster, Self::Same];

    /// Decides about a ratio of times. A `threshold` of 0.05 lets times grow by 5 %, or shrink by as much
    /// that they grow by 5 % on the way back.
    pub fn of(ratio: &Ratio, threshold: f64) -> Self {
        let (least, most) = (1.0 / (1.0 + threshold), 1.0 + threshold);
        if ratio.low > most {
            Self::Slower
        } else if ratio.high < least {
            Self::Faster
        } else if ratio.low >= least && ratio.high <= most {
            Self::Same
        } else {
            Self::Inconclusive
        }
    }

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slower => "slower",
            Self::Inconclusive => "inconclusive",
            Self::Faster => "faster",
            Self::Same => "same",
        }
    }
}

/// A figure of a run.
struct Measure {
    name: String,
    of: String,
    sha: String,
    rays: Option<u64>,
    summary: Summary,
    times: ByRound,
}

/// A figure in both runs.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// What was measured: scene, tree, kernel, view, rays.
    pub name: String,
    /// Median in A, ms.
    pub a: f64,
    /// Median in B, ms.
    pub b: f64,
    /// B relative to A.
    pub ratio: Ratio,
    /// What that says.
    pub verdict: Change,
}

/// What came of two runs.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The figures that both have.
    pub comparisons: Vec<Comparison>,
    /// What could not be compared, and why.
    pub remarks: Vec<String>,
    /// What works in A but not in B.
    pub failures: Vec<String>,
    /// Figures that A alone has, and B alone.
    pub unmatched: [usize; 2],
}

impl Outcome {
    /// Number of figures with a verdict.
    pub fn count(&self, verdict: Change) -> usize {
        self.comparisons.iter().filter(|comparison| comparison.verdict == verdict).count()
    }

    /// Compares `b` with `a`; `totals` leaves out single views and kinds of rays.
    pub fn of(a: &Recorded, b: &Recorded, threshold: f64, totals: bool) -> Self {
        let mut outcome = Self::default();
        outcome.note_machines(a, b);
        let (ours, theirs) = (measures(a, totals), measures(b, totals));
        let (mut only_a, mut changed) = (Vec::new(), Vec::new());
        for (index, old) in ours.iter().enumerate() {
            let Some(new) = theirs.iter().find(|new| new.name == old.name) else {
                only_a.push(old.of.clone());
                continue;
            };
            if (&old.sha, old.rays) != (&new.sha, new.rays) {
                changed.push(old.of.clone());
                continue;
            }
            let ratio = ratio(new, old, index as u64);
            outcome.comparisons.push(Comparison {
                name: old.name.clone(),
                a: old.summary.median,
                b: new.summary.median,
                verdict: Change::of(&ratio, threshold),
                ratio,
            });
        }
        let known: HashSet<&str> = ours.iter().map(|measure| measure.name.as_str()).collect();
        let only_b = theirs.iter().filter(|new| !known.contains(new.name.as_str())).map(|new| new.of.clone());
        let only_b: Vec<String> = only_b.collect();
        outcome.note_errors(a, b);
        outcome.unmatched = [only_a.len(), only_b.len()];
        outcome.note("only in A", only_a);
        outcome.note("only in B", only_b);
        outcome.note("other geometry or other rays", changed);
        outcome
    }

    fn note(&mut self, why: &str, names: Vec<String>) {
        let mut seen = HashSet::new();
        let new = names.into_iter().filter(|name| seen.insert(name.clone()));
        self.remarks.extend(new.map(|name| format!("{why}: {name}")));
    }

    fn note_machines(&mut self, a: &Recorded, b: &Recorded) {
        let (Some(a), Some(b)) = (&a.environment, &b.environment) else { return };
        let mut differs = |what: &str, a: &str, b: &str| {
            if a != b {
                self.remarks.push(format!("another {what}: {a} in A, {b} in B"));
            }
        };
        differs("host", &a.machine.host, &b.machine.host);
        differs("processor", &a.machine.cpu, &b.machine.cpu);
        differs("Embree", &a.library.embree, &b.library.embree);
        differs("compiler", &a.program.rustc, &b.program.rustc);
    }

    /// What failed in B only is worse than slow.
    fn note_errors(&mut self, a: &Recorded, b: &Recorded) {
        let is_bad = |row: &&Row| !row.is_good();
        let same = |x: &Row, y: &Row| {
            (&x.scene, &x.builder, x.width, &x.kernel) == (&y.scene, &y.builder, y.width, &y.kernel)
        };
        let was_bad = |row: &Row| a.rows.iter().filter(is_bad).any(|old| same(old, row));
        let was_there = |row: &Row| {
            a.rows
                .iter()
                .any(|old| (&old.scene, &old.builder, old.width) == (&row.scene, &row.builder, row.width))
        };
        for row in b.rows.iter().filter(is_bad) {
            let text = format!("{} {}/{} {}: {}", row.scene, row.builder, row.width, row.kernel, row.error);
            if was_bad(row) || !was_there(row) {
                self.remarks.push(format!("no figures in B: {text}"));
            } else {
                self.failures.push(text);
            }
        }
    }

    /// The outcome as Markdown; figures that are the same are only counted, unless `all` are to be shown.
    pub fn document(&self, threshold: f64, all: bool) -> String {
        let mut grid = Grid::new(["figure", "A ms", "B ms", "B / A", "95 % interval", "verdict"]);
        for verdict in Change::ALL {
            let shown = all || verdict != Change::Same;
            for one in self.comparisons.iter().filter(|one| shown && one.verdict == verdict) {
                let interval = format!("{:.3} to {:.3}", one.ratio.low, one.ratio.high);
                let ratio = format!("{:.3}", one.ratio.value);
                let verdict = verdict.name().into();
                grid.push(vec![one.name.clone(), short(one.a), short(one.b), ratio, interval, verdict]);
            }
        }
        let mut text = if grid.is_empty() { String::new() } else { grid.markdown() + "\n" + LEGEND };
        text.extend(self.failures.iter().map(|failure| format!("failed in B: {failure}\n")));
        text.extend(self.remarks.iter().map(|remark| format!("{remark}\n")));
        text + &self.summary(threshold) + "\n"
    }

    /// One line of counts.
    pub fn summary(&self, threshold: f64) -> String {
        let counts = Change::ALL.map(|verdict| format!("{} {}", self.count(verdict), verdict.name()));
        let [only_a, only_b] = self.unmatched;
        let others = [(self.failures.len(), "failed"), (only_a, "only in A"), (only_b, "only in B")];
        let others =
            others.map(|(count, what)| if count == 0 { String::new() } else { format!(", {count} {what}") });
        let (figures, threshold) = (self.comparisons.len(), short(100.0 * threshold));
        format!("{figures} figures, threshold {threshold} %: {}{}", counts.join(", "), others.concat())
    }
}

const LEGEND: &str = "A ms, B ms: medians. B / A: geometric mean of the ratios of rounds that both have, of three at least, else the \
    ratio of the medians. The interval does not hold drift between two runs: `--against` makes them by turns.\n\n";

/// `new` relative to `old`, as [`LEGEND`] has it.
fn ratio(new: &Measure, old: &Measure, seed: u64) -> Ratio {
    let pairs = paired(&new.times, &old.times);
    if pairs.len() >= LEAST_ROUNDS {
        let logs: Vec<f64> = pairs.iter().map(|[new, old]| (new / old).ln()).collect();
        return PairedMean::of([&logs[..]].into_iter()).ratio();
    }
    Ratio::cautious((&new.summary, &all_ms(&new.times)), (&old.summary, &all_ms(&old.times)), seed)
}

/// The figures of a run, each under its own name.
fn measures(run: &Recorded, totals: bool) -> Vec<Measure> {
    let mut measures: Vec<Measure> = Vec::new();
    let mut names = HashSet::new();
    // Rows over all rays first: they alone have the rounds of their build.
    let (of_all, of_some): (Vec<&Row>, Vec<&Row>) = run.rows.iter().partition(|row| row.is_total());
    for row in of_all.into_iter().chain(of_some).filter(|row| row.is_good() && (!totals || row.is_total())) {
        let tree = format!("{} {}/{}, {} threads", row.scene, row.builder, row.width, row.threads);
        let cell = run.cell(row);
        let mut add = |figure: String, of: String, summary: Option<Summary>, rays, times: Option<ByRound>| {
            let name = format!("{of}: {figure}");
            if let Some(summary) = summary
                && names.insert(name.clone())
            {
                let times = times.unwrap_or_default();
                measures.push(Measure { name, of, sha: row.scene_sha.clone(), rays, summary, times });
            }
        };
        // Builds stand in the rows of every kernel, but are one figure.
        let build = Some(row.by_round.build.clone());
        add(format!("{} build", row.regime), tree.clone(), row.build_ms(), None, build);

        let view = if row.view == ALL { None } else { row.view.parse().ok() };
        let kind = RayKind::ALL.into_iter().find(|kind| kind.name() == row.ray_kind);
        // Rows of single views and kinds have their times in the samples alone.
        let traced = |is_frame: bool| {
            if row.is_total() {
                return Some(if is_frame { &row.by_round.frame } else { &row.by_round.trace }.clone());
            }
            let matches = |found: Option<RayKind>| match found {
                None => is_frame,
                Some(found) => !is_frame && kind.is_none_or(|kind| kind == found),
            };
            Some(times(cell?, Kernel::by_name(&row.kernel)?, view, matches))
        };
        let of = format!("{tree}, {}", row.kernel);
        let views = if row.view == ALL { "all views".to_owned() } else { format!("view {}", row.view) };
        add(format!("{views}, {} rays", row.ray_kind), of.clone(), row.trace_ms(), row.rays, traced(false));
        add(format!("{views}, frame"), of, row.frame_ms(), row.rays, traced(true));
    }
    measures
}
