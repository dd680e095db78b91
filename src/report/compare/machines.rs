//! A run on unlike machines: each tree relative to Embree SAH on the same machine, the machines side by side. No
//! figure is a mean over machines; as no scene is divided, they differ in scenes too.

use crate::bench::row::Row;
use crate::report::figures::{BASELINE, Figure, SceneFigures, Tree, Under, tree_name, trees};
use crate::report::grid::Grid;
use crate::report::means::Ratios;

/// The file in the folder of machines.
pub const COMPARED: &str = "compared.md";

/// The comparison of machines, each described in words and with the rows measured on it.
pub fn compared(machines: &[(String, Vec<Row>)]) -> String {
    let trees = trees(machines.iter().flat_map(|(_, rows)| rows));
    let Some(&first) = trees.first() else { return String::new() };
    let base = if trees.contains(&BASELINE) { BASELINE } else { first };
    let mut unders: Vec<Under> = machines.iter().map(|(_, rows)| Under::best(rows)).collect();
    unders.dedup();
    let under = if let [under] = &unders[..] { under } else { &Under::Own };
    let figures: Vec<Vec<SceneFigures<'_>>> =
        machines.iter().map(|(_, rows)| SceneFigures::all(rows)).collect();

    let mut text = format!(
        "# Unlike machines\n\nGeometric means over the scenes of each machine, relative to {} on that machine [95 % interval]. \
         Every scene was measured on one machine: a mean over machines would be of neither.\n\n",
        tree_name(base)
    );
    for (index, ((machine, _), scenes)) in machines.iter().zip(&figures).enumerate() {
        let names: Vec<&str> = scenes.iter().map(SceneFigures::scene).collect();
        text += &format!("* machine {}: {machine}: {}\n", index + 1, names.join(", "));
    }
    for (title, figure) in [("Build time", Figure::Build), ("Trace time", Figure::Trace)] {
        let numbers = (1..=machines.len()).map(|number| format!("machine {number}"));
        let mut grid = Grid::new(std::iter::once("tree".to_owned()).chain(numbers));
        for &tree in &trees {
            let cells: Vec<String> =
                figures.iter().map(|scenes| cell(scenes, base, tree, figure, under)).collect();
            if cells.iter().any(|cell| cell != NONE) {
                grid.push([vec![tree_name(tree)], cells].concat());
            }
        }
        if !grid.is_empty() {
            let traced = if figure == Figure::Trace { format!(": {}", under.about()) } else { String::new() };
            text += &format!("\n## {title}{traced}\n\n{}", grid.markdown());
        }
    }
    if text.contains("]*") { text + "\n`*`: mean over fewer of the machine's scenes\n" } else { text }
}

const NONE: &str = "-";

fn cell(
    scenes: &[SceneFigures<'_>],
    base: Tree<'_>,
    tree: Tree<'_>,
    figure: Figure,
    under: &Under,
) -> String {
    let ratios = Ratios::among(scenes, base, tree, figure, under);
    let fewer = if ratios.0.len() < scenes.len() { "*" } else { "" };
    match (ratios.geometric(), ratios.interval(ratios.over())) {
        (Some(_), _) if tree == base => "1".into(),
        (Some(mean), Some(interval)) => format!("{mean:.2} {}{fewer}", interval.shown(2)),
        _ => NONE.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, builder: &str, build: f64, trace: f64) -> Row {
        Row { scene: scene.into(), ..Row::by_hand(builder, 4, "embree-grafted", build, trace) }
    }

    #[test]
    fn each_machine_is_compared_with_itself() {
        let machines = [
            ("one".to_owned(), vec![row("a", "embree-sah", 10.0, 10.0), row("a", "phr-hq", 5.0, 20.0)]),
            ("other".to_owned(), vec![row("b", "embree-sah", 100.0, 10.0), row("b", "phr-hq", 300.0, 10.0)]),
        ];
        let text = compared(&machines);
        let line = |name: &str| text.lines().find(|line| line.contains(name)).unwrap();
        assert!(line("machine 1: one").ends_with(": a") && line("machine 2: other").ends_with(": b"));
        assert_eq!(line("| phr-hq"), "| phr-hq     | 0.50 [0.50, 0.50] | 3.00 [3.00, 3.00] |", "{text}");
        assert_eq!(line("| embree-sah"), "| embree-sah |                 1 |                 1 |", "{text}");
        // The mean over both would be that of 0.5 and 3.
        assert!(!text.contains("1.22"), "{text}");
    }
}
