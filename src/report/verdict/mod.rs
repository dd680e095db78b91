//! The answer in three sentences: which tree traces fastest, which builds fastest, and which takes least time for how
//! many rays. Saved trees take no part in it: a sentence of its own says how long each takes to load.

pub mod field;
mod loading;
mod sentence;
pub mod totals;

use crate::report::figures::{Figure, Tree, Under};
use field::Field;
use loading::loading;
pub use sentence::{Part, Sentence};
use totals::{Stretch, stretches, totals};

/// The three sentences, traces compared under `under`, none where there are saved trees alone; and one for each saved
/// tree.
pub fn verdict(field: &Field<'_>, under: &Under) -> Vec<Sentence> {
    let has_builders = field.built().next().is_some();
    let compared = has_builders.then(|| of_builders(field, under));
    compared.into_iter().flatten().chain(loading(field)).collect()
}

fn of_builders(field: &Field<'_>, under: &Under) -> [Sentence; 3] {
    let Some((quickest, _)) = field.least(Figure::Build, under) else {
        let none = Sentence::default();
        return [
            none.clone().words(format!("No build time of {} was measured.", based(field))),
            none.clone().words("So nothing can be compared."),
            none.words("The errors of the rows say why."),
        ];
    };
    match field.least(Figure::Trace, under) {
        Some((best, _)) => [
            fastest_trace(field, best, under),
            fastest_build(field, quickest, under),
            least_total(&stretches(&totals(field, Figure::Build, under))),
        ],
        None => [
            opening(field)
                .words(", ")
                .name(quickest)
                .words(" builds fastest: in ")
                .ratio(field, quickest, Figure::Build, under)
                .words(format!(" of the time of {}", based(field)))
                .rivals(field, quickest, Figure::Build, under)
                .words("."),
            lowest_cost(field, under),
            Sentence::default()
                .words("No rays were traced: a run without --build-only tells which tree pays."),
        ],
    }
}

fn opening(field: &Field<'_>) -> Sentence {
    let threads =
        field.scenes.iter().flat_map(|scene| scene.totals()).map(|row| row.threads).max().unwrap_or(0);
    let threads = if threads == 1 { "1 thread".into() } else { format!("{threads} threads") };
    Sentence::default().words(match &field.scenes[..] {
        [scene] => format!("In {} on {threads}", scene.scene()),
        scenes => format!("Over {} scenes on {threads}", scenes.len()),
    })
}

/// The base in words.
fn based(field: &Field<'_>) -> String {
    format!("{}, {}-wide", field.base.0, field.base.1)
}

fn fastest_trace(field: &Field<'_>, best: Tree<'_>, under: &Under) -> Sentence {
    if best == field.base {
        return opening(field).words(", no tree traces faster than ").name(best).words(".");
    }
    opening(field)
        .words(", ")
        .name(best)
        .words(" traces fastest: in ")
        .ratio(field, best, Figure::Trace, under)
        .words(format!(" of the time of {}, after ", based(field)))
        .ratio(field, best, Figure::Build, under)
        .words(" of its build time")
        .rivals(field, best, Figure::Trace, under)
        .words(".")
}

fn fastest_build(field: &Field<'_>, quickest: Tree<'_>, under: &Under) -> Sentence {
    if quickest == field.base {
        return Sentence::default().words("None builds faster than ").name(quickest).words(".");
    }
    Sentence::default()
        .name(quickest)
        .words(" builds fastest: in ")
        .ratio(field, quickest, Figure::Build, under)
        .words(" of its build time, and traces in ")
        .ratio(field, quickest, Figure::Trace, under)
        .words(" of its time")
        .rivals(field, quickest, Figure::Build, under)
        .words(".")
}

fn lowest_cost(field: &Field<'_>, under: &Under) -> Sentence {
    let Some((tree, cost)) = field.least(Figure::Cost, under) else {
        return Sentence::default().words("No SAH cost is known.");
    };
    Sentence::default()
        .name(tree)
        .words(format!(" has the lowest SAH cost, {cost:.2} of that of {}.", based(field)))
}

fn least_total(stretches: &[Stretch<'_>]) -> Sentence {
    let opening = Sentence::default().words("Build and rays together, ");
    let [first, rest @ ..] = stretches else {
        return Sentence::default().words("No tree has both times, so no number of rays decides.");
    };
    let takes = opening.name(first.tree);
    let [second, ..] = rest else { return takes.words(" takes least time at any number of rays.") };
    let mut sentence = takes.words(format!(" takes least time up to {}", rays_in_words(second.from)));
    for (index, stretch) in rest.iter().enumerate() {
        sentence = match rest.get(index + 1) {
            Some(next) => {
                let until = format!(" up to {}", rays_in_words(next.from));
                sentence.words(", ").name(stretch.tree).words(until)
            }
            None => sentence.words(" and ").name(stretch.tree).words(" beyond."),
        };
    }
    sentence
}

/// Two digits and a word: `3.1 million rays`.
pub fn rays_in_words(rays: f64) -> String {
    let digits = 10f64.powf(rays.log10().floor() - 1.0);
    let rays = (rays / digits).round() * digits;
    let (unit, word) = match rays {
        rays if rays >= 1e9 => (1e9, " billion"),
        rays if rays >= 1e6 => (1e6, " million"),
        rays if rays >= 1e3 => (1e3, " thousand"),
        _ => (1.0, ""),
    };
    let value = rays / unit;
    let decimals = usize::from(value < 10.0 && value.fract().abs() > 1e-9);
    format!("{value:.decimals$}{word} rays")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::row::Row;

    fn row(scene: &str, builder: &str, build: f64, trace: f64) -> Row {
        Row { scene: scene.into(), rays: Some(1_000_000), ..Row::by_hand(builder, 4, "phr", build, trace) }
    }

    fn sentences(rows: &[Row]) -> Vec<String> {
        let field = Field::of(rows).unwrap();
        verdict(&field, &Under::One("phr".into())).iter().map(Sentence::text).collect()
    }

    #[test]
    fn the_best_and_the_crossings_are_named() {
        let rows: Vec<Row> = ["a", "b"]
            .into_iter()
            .flat_map(|scene| {
                [
                    row(scene, "embree-sah", 20.0, 2.0),
                    row(scene, "lbvh", 5.0, 4.0),
                    row(scene, "phr-hq", 40.0, 1.0),
                ]
            })
            .collect();
        let found = sentences(&rows);
        assert!(
            found[0].starts_with("Over 2 scenes on 2 threads, phr-hq traces fastest: in 0.50 ["),
            "{found:?}"
        );
        assert!(found[0].contains("of the time of embree-sah, 4-wide, after 2.00 ["), "{found:?}");
        assert!(found[1].starts_with("lbvh builds fastest: in 0.25 ["), "{found:?}");
        // 5 + 4 n = 20 + 2 n at 7.5 million, 20 + 2 n = 40 + n at 20.
        let until = "Build and rays together, lbvh takes least time up to 7.5 million rays, \
                     embree-sah up to 20 million rays and phr-hq beyond.";
        assert_eq!(found[2], until);
    }

    #[test]
    fn the_best_by_less_than_noise_is_not_told_apart() {
        let rounds = |times: [f64; 3]| times.into_iter().enumerate().map(|(i, ms)| (i as u32, ms)).collect();
        let of = |builder, build: f64, trace: [f64; 3]| {
            let mut row = row("a", builder, build, trace[1]);
            row.by_round.build = rounds([build; 3]);
            row.by_round.trace = rounds(trace);
            row
        };
        let rows = [
            of("embree-sah", 20.0, [2.0; 3]),
            of("phr-hq", 40.0, [0.9, 1.0, 1.1]),
            of("phr-best", 60.0, [1.1, 1.01, 1.0]),
        ];
        let found = sentences(&rows);
        assert!(found[0].ends_with("; not told apart from it is phr-best."), "{found:?}");
        assert!(found[1].starts_with("None builds faster than embree-sah"), "{found:?}");
    }

    #[test]
    fn two_rounds_tell_of_no_noise() {
        let row = |builder, build| Row { rounds: 2, ..row("a", builder, build, 1.0) };
        let found = sentences(&[row("embree-sah", 20.0), row("lbvh", 5.0)]);
        assert!(found[1].ends_with("; 3 rounds at least would tell how sure that is."), "{found:?}");
    }

    #[test]
    fn builds_alone_and_nothing_at_all_are_told() {
        let untraced = |builder, build| Row { trace_ms_median: None, ..row("a", builder, build, 1.0) };
        let found = sentences(&[untraced("lbvh", 5.0), untraced("phr-hq", 10.0)]);
        assert!(found[0].starts_with("In a on 2 threads, lbvh builds fastest: in 1.00 of"), "{found:?}");
        assert!(found[2].contains("--build-only"), "{found:?}");
        let cost = |builder, sah| Row { sah: Some(sah), ..untraced(builder, sah) };
        let found = sentences(&[cost("lbvh", 5.0), cost("phr-hq", 2.0)]);
        assert_eq!(found[1], "phr-hq has the lowest SAH cost, 0.40 of that of lbvh, 4-wide.");
        let failed = Row { build_ms_median: None, error: "out of memory".into(), ..untraced("lbvh", 5.0) };
        assert_eq!(sentences(&[failed])[0], "No build time of lbvh, 4-wide was measured.");
    }

    #[test]
    fn saved_trees_are_loaded_and_no_builders() {
        let wide = |builder, build| Row { width: 8, ..row("a", builder, build, 1.0) };
        let config = r#"{"builder":"phr-speed"}"#;
        let saved = Row { builder_config: config.into(), ..wide("saved:x", 0.5) };
        let rows = [row("a", "embree-sah", 20.0, 2.0), wide("phr-speed", 5.0), saved.clone()];
        let found = sentences(&rows);
        let loads = "saved:x / 8 loads in 0.500 ms; phr-speed / 8, which built it, takes 5.00 ms.";
        assert_eq!((found.len(), &*found[3]), (4, loads));
        assert!(found[..3].iter().all(|sentence| sentence.contains("phr-speed / 8")), "{found:?}");
        assert!(!found[..3].concat().contains("saved:"), "{found:?}");
        // Its builder of another width tells nothing of it, and there is no verdict on it alone.
        let found = sentences(&[row("a", "phr-speed", 5.0, 1.0), saved.clone()]);
        assert_eq!(found[3], "saved:x / 8 loads in 0.500 ms.");
        assert_eq!(sentences(&[saved]), ["saved:x / 8 loads in 0.500 ms."]);
    }

    #[test]
    fn numbers_of_rays_have_two_digits() {
        let words = [123.0, 5_040.0, 996_000.0, 31_400_000.0, 4e9].map(rays_in_words);
        assert_eq!(
            words,
            ["120 rays", "5 thousand rays", "1 million rays", "31 million rays", "4 billion rays"]
        );
    }
}
