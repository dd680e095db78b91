//! The constants that were chosen by looking at scenes, and what their neighbours give: from `chosen.csv`, a line
//! for each constant, and `rows.csv`, which `cargo bench --bench constants` prints.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use crate::bench::files::{RecordsError, read_csv_file};
use crate::bench::statistics::geometric_mean;
use crate::report::grid::Grid;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A constant, as a person wrote it down.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Chosen {
    preset: String,
    constant: String,
    value: String,
    place: String,
    scenes: String,
}

/// What a neighbouring value gives in a scene, relative to the preset.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Neighbour {
    scene: String,
    preset: String,
    width: usize,
    constant: String,
    value: f64,
    sah: f64,
    refs_per_tri: f64,
    node_visits: f64,
    block_tests: f64,
    build: Option<f64>,
}

/// A line for each constant, neighbouring value and width of trees: geometric means over the scenes, relative to the
/// preset, and the scene whose node visits differ most.
///
/// # Errors
/// One line: a file that cannot be read, or neighbours of a constant that is not listed.
pub fn constants(folder: &Path) -> Result<String, String> {
    let told = |error: RecordsError| error.to_string();
    let written = "write it as results/README.md tells";
    let chosen: Vec<Chosen> = read_csv_file(&folder.join("chosen.csv"), written).map_err(told)?;
    let path = folder.join("rows.csv");
    let printed = "run `cargo bench --bench constants -- SCENE...`";
    let neighbours: Vec<Neighbour> = read_csv_file(&path, printed).map_err(told)?;
    let is_of = |of: &Neighbour, c: &Chosen| (&of.preset, &of.constant) == (&c.preset, &c.constant);
    if let Some(stray) = neighbours.iter().find(|of| !chosen.iter().any(|c| is_of(of, c))) {
        let (path, Neighbour { preset, constant, .. }) = (path.display(), stray);
        return Err(format!("{path}: {constant} of {preset} is not in chosen.csv; add it there"));
    }
    let mut grid = Grid::new([
        "preset",
        "constant",
        "value",
        "in",
        "chosen on",
        "neighbour",
        "width",
        "build",
        "SAH cost",
        "references",
        "node visits",
        "block tests",
        "most visits",
    ]);
    for constant in &chosen {
        let Chosen { preset, constant: name, value, place, scenes } = constant;
        let head: Vec<String> = [preset, name, value, place, scenes].map(Clone::clone).into();
        let of: Vec<&Neighbour> = neighbours.iter().filter(|of| is_of(of, constant)).collect();
        let mut values: Vec<(f64, usize)> = of.iter().map(|of| (of.value, of.width)).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        values.dedup();
        if values.is_empty() {
            grid.push(head.clone());
        }
        for (index, (value, width)) in values.into_iter().enumerate() {
            let of: Vec<&Neighbour> =
                of.iter().copied().filter(|of| (of.value, of.width) == (value, width)).collect();
            // The constant is told once.
            let mut cells = if index == 0 { head.clone() } else { vec![String::new(); head.len()] };
            cells.extend([shown(value), width.to_string()]);
            let mean = |figure: fn(&Neighbour) -> Option<f64>| {
                let ratios: Vec<f64> = of.iter().filter_map(|of| figure(of)).collect();
                geometric_mean(&ratios).map_or_else(|| "-".into(), |mean| format!("{mean:.3}"))
            };
            cells.extend([
                mean(|of| of.build),
                mean(|of| Some(of.sah)),
                mean(|of| Some(of.refs_per_tri)),
                mean(|of| Some(of.node_visits)),
                mean(|of| Some(of.block_tests)),
            ]);
            let most = of.iter().max_by(|a, b| distance(a.node_visits).total_cmp(&distance(b.node_visits)));
            cells.extend(most.map(|most| format!("{:.2} {}", most.node_visits, most.scene)));
            grid.push(cells);
        }
    }
    let mut scenes: Vec<&str> = neighbours.iter().map(|of| of.scene.as_str()).collect();
    scenes.sort_unstable();
    scenes.dedup();
    let is_timed = neighbours.iter().any(|of| of.build.is_some());
    let builds = if is_timed { ", build times the least of three or more by turns" } else { "" };
    Ok(format!(
        "{}\nRelative to the preset: geometric means over {}. Costs and counts are exact{builds}. most visits: the \
         scene whose node visits differ most.\n",
        grid.markdown(),
        scenes.join(", ")
    ))
}

/// How far a ratio is from 1, up or down.
fn distance(ratio: f64) -> f64 {
    ratio.ln().abs()
}

/// A power of two below a tenth as a fraction, others as they are.
fn shown(value: f64) -> String {
    let inverse = 1.0 / value;
    if value < 0.1 && inverse.fract() == 0.0 && inverse.log2().fract() == 0.0 {
        format!("1/{inverse}")
    } else {
        format!("{value}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_stand_beside_their_constant() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let chosen = "preset,constant,value,place,scenes\nspeed,delta,6,config.rs,two\n# rows: 1\n";
        write("chosen.csv", chosen);
        let header = "scene,preset,width,constant,value,sah,refs_per_tri,node_visits,block_tests,build\n";
        let lines =
            "a,speed,4,delta,3,1,1,0.5,1,2\nb,speed,8,delta,3,1,1,3,1,\nb,speed,4,delta,3,1,1,1,1,0.5\n";
        let rows = format!("{header}{lines}# rows: 3\n");
        write("rows.csv", &rows);
        let text = constants(folder.path()).unwrap();
        let cells = |line: &str| -> Vec<String> { line.split('|').map(|cell| cell.trim().into()).collect() };
        let mut lines = text.lines().skip_while(|line| !line.contains("config.rs")).map(cells);
        let first = ["speed", "delta", "6", "config.rs", "two", "3", "4"];
        let figures = ["1.000", "1.000", "1.000", "0.707", "1.000", "0.50 a"];
        assert_eq!(lines.next().unwrap()[1..14], [&first[..], &figures].concat(), "{text}");
        let second = ["", "", "", "", "", "3", "8", "-", "1.000", "1.000", "3.000", "1.000", "3.00 b"];
        assert_eq!(lines.next().unwrap()[1..14], second, "{text}");
        for stray in ["a,speed,4,alpha,3,1,1,0.5,1,2", "a,fast,4,delta,3,1,1,0.5,1,2"] {
            write("rows.csv", &format!("{header}{stray}\n# rows: 1\n"));
            assert!(constants(folder.path()).unwrap_err().contains("is not in chosen.csv"));
        }
        for (name, whole) in [("chosen.csv", chosen), ("rows.csv", &rows)] {
            write("rows.csv", &rows);
            for end in 0..whole.len() {
                write(name, &whole[..end]);
                let error = constants(folder.path()).unwrap_err();
                assert!(error.contains(name) && error.lines().count() == 1, "{error}");
            }
            write(name, whole);
        }
    }

    #[test]
    fn small_powers_of_two_are_fractions() {
        assert_eq!([1.0 / 512.0, 0.25, 5e-4, 64.0].map(shown), ["1/512", "0.25", "0.0005", "64"]);
    }
}
