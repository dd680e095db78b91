//! The ratios of a comparison over the scenes of a run.

use super::experiment::{Among, Comparison};
use crate::bench::row::Row;
use crate::report::figures::interval::{Interval, Over};
use crate::report::figures::{Figure, SceneFigures, Under};
use crate::report::means::Ratios;

/// The figures that most experiments compare.
pub const FIGURES: &[Figure] = &[Figure::Build, Figure::Cost, Figure::Steps, Figure::Trace];
/// Those where times of builds tell nothing.
pub const OF_TREES: &[Figure] = &[Figure::Cost, Figure::Steps, Figure::Trace];

/// The name of a figure, one of [`FIGURES`].
pub fn name(figure: Figure) -> &'static str {
    match figure {
        Figure::Cost => "SAH cost",
        Figure::Steps => "steps",
        Figure::Trace => "trace",
        _ => "build",
    }
}

/// The ratios of a comparison.
pub struct Compared<'a> {
    /// What is compared.
    pub comparison: &'a Comparison,
    /// Each figure with its ratios by scene.
    pub ratios: Vec<(Figure, Ratios)>,
}

/// A mean with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// The geometric mean over scenes.
    pub value: f64,
    /// Over scenes and rounds, or over rounds where there is one scene; nothing where too little is known.
    pub interval: Option<Interval>,
    /// What the interval is over.
    pub over: Over,
}

/// In a table, behind an interval over rounds alone.
pub const OF_ROUNDS: &str = ", rounds";

impl<'a> Compared<'a> {
    /// The ratios of trees of `width`, those of traces over whole frames where the scenes have them; `None` if
    /// there are no figures of both builders.
    pub fn of(
        comparison: &'a Comparison,
        figures: &[Figure],
        scenes: &[SceneFigures<'_>],
        width: u32,
        under: &Under,
    ) -> Option<Self> {
        let (changed, base) = ((comparison.changed.as_str(), width), (comparison.base.as_str(), width));
        let of = |&figure: &Figure| {
            let measured =
                if figure == Figure::Trace { SceneFigures::traced_by(scenes, under) } else { figure };
            (figure, Ratios::among(scenes, base, changed, measured, under))
        };
        let ratios: Vec<(Figure, Ratios)> = figures.iter().map(of).collect();
        ratios.iter().any(|(_, ratios)| !ratios.0.is_empty()).then_some(Self { comparison, ratios })
    }

    /// The ratios of `figure`; none if it is not compared.
    pub fn of_figure(&self, figure: Figure) -> Option<&Ratios> {
        self.ratios.iter().find(|(known, _)| *known == figure).map(|(_, ratios)| ratios)
    }

    /// Whether any scene has `figure`: whole frames have no steps.
    pub fn is_measured(&self, figure: Figure) -> bool {
        self.of_figure(figure).is_some_and(|ratios| !ratios.0.is_empty())
    }
}

impl Mean {
    /// The mean of some ratios; `None` of none.
    pub fn of(ratios: &Ratios) -> Option<Self> {
        Self::over(ratios, ratios.over())
    }

    fn over(ratios: &Ratios, over: Over) -> Option<Self> {
        let interval = ratios.interval(over).filter(|interval| interval.high.is_finite());
        Some(Self { value: ratios.geometric()?, interval, over })
    }

    /// The mean over the scenes `among` those of the rows, which know their triangles. Of the paper's scenes it is
    /// told what is sure of these very scenes, of others what is of their kind. `None` if there are none of them.
    pub fn among(ratios: &Ratios, among: Among, rows: &[Row]) -> Option<Self> {
        let triangles =
            |scene: &str| rows.iter().find(|row| row.scene == scene).map_or(0, |row| row.triangles);
        let is_one = |scene: &str| among.has(scene, triangles(scene));
        let those = Ratios(ratios.0.iter().filter(|ratio| is_one(&ratio.scene)).cloned().collect());
        match among {
            Among::Paper(_) => Self::over(&those, Over::Rounds),
            Among::All | Among::Kind(_) | Among::From(_) => Self::of(&those),
        }
    }

    /// As `0.93 [0.90, 0.96]`.
    pub fn shown(&self) -> String {
        let interval = self.interval.map_or_else(|| "[?]".into(), |interval| interval.shown(2));
        format!("{:.2} {interval}", self.value)
    }

    /// The same in a table, which says where the interval is over rounds alone.
    pub fn cell(&self) -> String {
        let is_of_rounds = self.over == Over::Rounds && self.interval.is_some();
        self.shown() + if is_of_rounds { OF_ROUNDS } else { "" }
    }

    /// Whether the mean is within a range: the whole interval is, or none of it, or that is not known.
    pub fn verdict(&self, (least, most): (f64, f64)) -> &'static str {
        match self.interval {
            None => "is undecided",
            Some(Interval { low, high }) if least <= low && high <= most => "holds",
            Some(Interval { low, high }) if high < least || most < low => "does not hold",
            Some(_) => "is undecided",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::kinds::{LARGE, SCANS};
    use super::*;
    use crate::report::figures::{GRAFTED, PHR};

    /// A tree of a scene under both kernels.
    fn rows(scene: &str, triangles: u64, builder: &str, trace: f64, visits: f64) -> [Row; 2] {
        [GRAFTED, PHR].map(|kernel| Row {
            scene: scene.into(),
            triangles,
            node_visits_per_ray: (kernel == PHR).then_some(visits),
            block_tests_per_ray: (kernel == PHR).then_some(1.0),
            ..Row::by_hand(builder, 4, kernel, 10.0, trace)
        })
    }

    #[test]
    fn steps_are_those_of_our_kernel_and_have_no_noise() {
        let rows = [rows("statue", 9, "phr-fast", 10.0, 3.0), rows("statue", 9, "aac", 30.0, 5.0)].concat();
        let comparison = Comparison { changed: "aac".into(), base: "phr-fast".into(), expected: Vec::new() };
        let scenes = SceneFigures::all(&rows);
        let compared = Compared::of(&comparison, FIGURES, &scenes, 4, &Under::best(&rows)).unwrap();
        let mean = |figure| Mean::of(compared.of_figure(figure).unwrap());
        assert_eq!(mean(Figure::Steps).map(|mean| mean.shown()).as_deref(), Some("1.50 [1.50, 1.50]"));
        assert_eq!(mean(Figure::Trace).map(|mean| mean.cell()).as_deref(), Some("3.00 [3.00, 3.00], rounds"));
        assert_eq!(mean(Figure::Cost), None, "the rows have no cost");
        assert!(Compared::of(&comparison, OF_TREES, &scenes, 8, &Under::best(&rows)).is_none());
    }

    #[test]
    fn something_is_said_of_some_scenes() {
        let of = |scene: &str, triangles, trace| {
            [rows(scene, triangles, "phr-fast", 10.0, 3.0), rows(scene, triangles, "aac", trace, 5.0)]
                .concat()
        };
        let rows = [
            of("statue", 200_000, 20.0),
            of("clinic", 1_200_000, 40.0),
            of("sanmiguel-like", 10_000_000, 10.0),
        ]
        .concat();
        let ratios = Ratios::to(("phr-fast", 4), &rows, ("aac", 4), Figure::Trace, &Under::best(&rows));
        let mean = |among| Mean::among(&ratios, among, &rows).map(|mean| (mean.value * 100.0).round());
        assert_eq!(mean(Among::All), Some(200.0));
        assert_eq!(mean(SCANS), Some(200.0));
        assert_eq!(mean(LARGE), Some(200.0));
        assert_eq!(mean(Among::Paper(&["San Miguel"])), Some(100.0));
        assert_eq!(mean(Among::Paper(&["Hairball"])), None);
        let over = |among| Mean::among(&ratios, among, &rows).map(|mean| mean.over);
        assert_eq!(over(Among::All), Some(Over::ScenesAndRounds));
        assert_eq!(over(Among::Paper(&["San Miguel", "Powerplant"])), Some(Over::Rounds));
    }
}
