//! The short table of the first page: a few trees relative to Embree SAH.

use crate::bench::row::{Row, WARM};
use crate::bench::statistics::Summary;
use crate::report::figures::{BASELINE, Figure, SceneFigures, Tree, Under, scenes, tree_name, trees};
use crate::report::grid::Grid;
use crate::report::means::{Ratios, WORST};

/// Rounds are far apart where the slowest takes so many times as long as the fastest.
const FAR: f64 = 1.2;

/// Geometric means of build time, trace time and SAH cost of the trees of `builders`, of every width that `rows`
/// have or of the one named (`phr-speed/8`), and the scene whose trace time is worst. With rows of `withheld`
/// scenes, their means stand beside these, where they have the tree.
///
/// # Errors
/// One line, if a builder has no such figure in `rows`.
pub fn summary(
    rows: &[Row],
    withheld: Option<&[Row]>,
    builders: &[&str],
    under: &Under,
) -> Result<String, String> {
    let mut header = vec!["tree"];
    for figure in ["build time", "trace time"] {
        header.push(figure);
        header.extend(withheld.map(|_| "withheld"));
    }
    header.extend(["worst trace", "in", "SAH cost"]);
    let mut grid = Grid::new(header);
    let (of_open, of_withheld) = (scenes(rows).len(), withheld.map_or(0, |rows| scenes(rows).len()));
    let mut are_whole = true;
    for builder in builders {
        let is_named = |tree: &Tree<'_>| tree.0 == *builder || format!("{}/{}", tree.0, tree.1) == *builder;
        let of_builder = trees(rows).into_iter().filter(is_named);
        let lines: Option<Vec<Vec<String>>> = of_builder
            .map(|tree| {
                let ratios = |rows, figure| Ratios::of(rows, tree, figure, under);
                // The baseline is 1 in every scene.
                let is_base = tree == BASELINE;
                let mean = |rows, figure| match is_base {
                    true => Some("1.00".to_owned()),
                    false => ratios(rows, figure).shown(),
                };
                let has = |rows, all| {
                    let mut figures = [Figure::Build, Figure::Trace, Figure::Cost].into_iter();
                    figures.all(|figure| [0, all].contains(&ratios(rows, figure).0.len()))
                };
                let is_whole = has(rows, of_open) && withheld.is_none_or(|rows| has(rows, of_withheld));
                are_whole &= is_whole;
                let mut cells = vec![tree_name(tree) + if is_whole { "" } else { "*" }];
                for figure in [Figure::Build, Figure::Trace] {
                    cells.push(mean(rows, figure)?);
                    cells.extend(withheld.map(|rows| mean(rows, figure).unwrap_or_else(|| "-".into())));
                }
                let traces = ratios(rows, Figure::Trace);
                cells.extend(traces.worst_shown().filter(|_| !is_base).unwrap_or_default());
                cells.push(mean(rows, Figure::Cost)?);
                Some(cells)
            })
            .collect();
        let missing =
            || format!("the rows have no build, trace and cost of {builder} beside Embree SAH, 4-wide");
        let lines = lines.filter(|lines| !lines.is_empty()).ok_or_else(missing)?;
        lines.into_iter().for_each(|line| grid.push(line));
    }
    let threads = rows.first().map_or(0, |row| row.threads);
    let withheld = withheld.map_or_else(String::new, |rows| {
        let revision = rows.first().map_or("", |row| &row.git_rev);
        let reused = if rows.iter().any(|row| row.regime == WARM) {
            " There our builds reused memory and Embree's did not, which favours us."
        } else {
            ""
        };
        format!(
            " Withheld: {of_withheld} other scenes, on another machine, by revision {revision}. Those who tuned did not see them, \
             except five in a probe for phr-speed.{reused}"
        )
    });
    let fewer = if are_whole { "" } else { " * a mean over fewer scenes." };
    Ok(format!(
        "{}\nRelative to Embree SAH, 4-wide: less is better. Geometric means over {of_open} scenes, {threads} threads; in brackets \
         95 % intervals. Trees are 4-wide, or 8-wide (/ 8). Traces: {}.{withheld} {WORST}{fewer}\n",
        grid.markdown(),
        under.about()
    ))
}

/// In how many builds and traces the slowest round took more than 1.2 times as long as the fastest: `50 % of all
/// builds and 21 % of all traces`; `None` where no row has several rounds.
pub fn spread(rows: &[Row], under: &Under) -> Option<String> {
    let of_scenes = SceneFigures::all(rows);
    let share = |figure| {
        let times = trees(rows).into_iter().flat_map(|tree| {
            of_scenes.iter().filter_map(move |scene| scene.figure(tree, figure, under).value())
        });
        let several: Vec<Summary> = times.filter(|times| times.count > 1).collect();
        let far = several.iter().filter(|times| times.max > FAR * times.min).count();
        (!several.is_empty()).then(|| 100.0 * far as f64 / several.len() as f64)
    };
    let (builds, traces) = share(Figure::Build).zip(share(Figure::Trace))?;
    Some(format!("{builds:.0} % of all builds and {traces:.0} % of all traces"))
}
