//! What the paper says of its eight methods together, and no comparison of two tells: who comes first and second,
//! how near PHR-HQ comes to the best trees, and the front.

use super::compared::name;
use super::methods::names;
use crate::bench::row::Row;
use crate::report::figures::{BASELINE, Figure, SceneFigures, Under};
use crate::report::means::Ratios;
use crate::report::plot::pareto::front;

/// Who builds fastest and second fastest, in how many scenes (5.1).
pub fn of_builds(rows: &[Row], width: u32, under: &Under) -> String {
    let scenes = SceneFigures::all(rows);
    let at = |place| told(&at_place(&scenes, width, Figure::Build, under, place));
    format!("Fastest build, by scenes: {}. Second fastest: {}.\n", at(0), at(1))
}

/// Who traces fastest and second fastest, how PHR-HQ's trees compare with those of Embree Fast-Spatial scene by
/// scene, and the front of build times against traces (5.2).
pub fn of_traces(rows: &[Row], width: u32, under: &Under) -> String {
    let scenes = SceneFigures::all(rows);
    let of = |by: &str, figure, [first, second]: [&str; 2]| {
        let at = |place| told(&at_place(&scenes, width, figure, under, place));
        let base = ("embree-fast-spatial", width);
        let ratios = Ratios::among(&scenes, base, ("phr-hq", width), figure, under);
        if ratios.0.is_empty() {
            return String::new();
        }
        let front = front_of(&scenes, width, figure, under).join(", ");
        format!(
            "* By {by}: {first}, by scenes: {}; {second}: {}. PHR-HQ's trees relative to those of Embree Fast-Spatial: {}. The \
             front of the eight, in the mean: {front}.\n",
            at(0),
            at(1),
            nearness(&ratios)
        )
    };
    let traced = SceneFigures::traced_by(&scenes, under);
    of(name(Figure::Trace), traced, ["fastest", "second fastest"])
        + &of(name(Figure::Steps), Figure::Steps, ["fewest", "second fewest"])
}

/// The methods that have the `place`-th least figure, each with in how many scenes; scenes that lack a method are
/// left out.
fn at_place(
    scenes: &[SceneFigures<'_>],
    width: u32,
    figure: Figure,
    under: &Under,
    place: usize,
) -> Vec<(String, usize)> {
    let mut counts: Vec<(String, usize)> = names().into_iter().map(|name| (name, 0)).collect();
    for scene in scenes {
        let of = |(name, _): &(String, usize)| scene.figure((name.as_str(), width), figure, under).value();
        let known: Option<Vec<f64>> = counts.iter().map(|method| of(method).map(|it| it.median)).collect();
        let Some(known) = known else { continue };
        let mut order: Vec<usize> = (0..known.len()).collect();
        order.sort_by(|&a, &b| known[a].total_cmp(&known[b]));
        counts[order[place]].1 += 1;
    }
    counts.retain(|(_, count)| *count > 0);
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}

fn told(counts: &[(String, usize)]) -> String {
    let told: Vec<String> = counts.iter().map(|(name, count)| format!("{name} in {count}")).collect();
    if told.is_empty() { "not known".into() } else { told.join(", ") }
}

/// In how many scenes a figure is less than another's, and how much more in the others.
fn nearness(ratios: &Ratios) -> String {
    let within = |above: f64, most: f64| {
        ratios.0.iter().filter(|ratio| above < ratio.value && ratio.value <= most).count()
    };
    format!(
        "less in {} of {}, up to 5 % more in {}, 5 to 10 % in {}, 10 to 20 % in {}, beyond that in {}",
        within(0.0, 1.0),
        ratios.0.len(),
        within(1.0, 1.05),
        within(1.05, 1.1),
        within(1.1, 1.2),
        within(1.2, f64::INFINITY)
    )
}

/// The methods on the front of build time against `figure`, means relative to Embree SAH, by growing build time.
fn front_of(scenes: &[SceneFigures<'_>], width: u32, figure: Figure, under: &Under) -> Vec<String> {
    let mean = |builder: &str, figure| {
        Ratios::among(scenes, (BASELINE.0, width), (builder, width), figure, under).geometric()
    };
    let known: Vec<(String, (f64, f64))> = names()
        .into_iter()
        .filter_map(|name| {
            let at = (mean(&name, Figure::Build)?, mean(&name, figure)?);
            Some((name, at))
        })
        .collect();
    let at: Vec<(f64, f64)> = known.iter().map(|(_, at)| *at).collect();
    front(&at).into_iter().map(|i| known[i].0.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{GRAFTED, PHR};

    /// Each method's build and trace time in scenes `a` and `b`; steps are the trace time.
    const METHODS: [(&str, f64, f64); 8] = [
        ("embree-morton", 1.0, 9.0),
        ("phr-fast", 2.0, 6.0),
        ("hunt-50", 3.0, 7.0),
        ("aac", 4.0, 8.0),
        ("embree-sah", 5.0, 6.5),
        ("phr-hq", 6.0, 5.0),
        ("hunt-500", 7.0, 5.5),
        ("embree-fast-spatial", 20.0, 4.8),
    ];

    fn rows() -> Vec<Row> {
        let row = |scene: &str, (builder, build, trace): (&str, f64, f64)| {
            [GRAFTED, PHR].map(|kernel| Row {
                scene: scene.into(),
                node_visits_per_ray: (kernel == PHR).then_some(trace - 1.0),
                block_tests_per_ray: (kernel == PHR).then_some(1.0),
                ..Row::by_hand(builder, 4, kernel, build, trace)
            })
        };
        let slower = |(builder, build, trace): (&'static str, f64, f64)| match builder {
            "aac" => (builder, 1.5, trace),
            "phr-hq" => (builder, build, 4.0),
            _ => (builder, build, trace),
        };
        let a = METHODS.into_iter().flat_map(|method| row("a", method));
        a.chain(METHODS.into_iter().flat_map(|method| row("b", slower(method)))).collect()
    }

    #[test]
    fn places_are_counted_by_scenes() {
        let rows = rows();
        let told = of_builds(&rows, 4, &Under::best(&rows));
        assert_eq!(
            told,
            "Fastest build, by scenes: embree-morton in 2. Second fastest: aac in 1, phr-fast in 1.\n"
        );
        let lacking: Vec<Row> = rows.iter().filter(|row| row.builder != "aac").cloned().collect();
        assert!(
            of_builds(&lacking, 4, &Under::best(&lacking)).contains("Fastest build, by scenes: not known")
        );
    }

    #[test]
    fn nearness_and_front_are_told_by_time_and_by_steps() {
        let rows = rows();
        let told = of_traces(&rows, 4, &Under::best(&rows));
        let fastest = "fastest, by scenes: embree-fast-spatial in 1, phr-hq in 1; second fastest: embree-fast-spatial in 1, \
                       phr-hq in 1.";
        assert!(told.contains(&format!("* By trace: {fastest}")), "{told}");
        assert!(told.contains("less in 1 of 2, up to 5 % more in 1, 5 to 10 % in 0"), "{told}");
        assert!(told.contains("in the mean: embree-morton, phr-fast, phr-hq.\n* By steps: fewest"), "{told}");
    }
}
