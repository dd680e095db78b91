//! Tables, and what they tell of gaps.

use super::*;
use phr::report::figures::Under;
use phr::report::{readme, table};
use std::collections::BTreeMap;

#[test]
fn table_1_has_the_figures_of_the_rows() {
    let text = table::document(&rows(), true);
    // Build ms, cost, ms of one of two views, MRays/s.
    let expected =
        ["phr-hq", "embree-grafted", "20.0", "20.0", "8.00", "62.5", "20.0", "20.0", "62.5", "8.00"];
    assert_eq!(cells(&text, "## Table 1", "phr-hq"), expected);
    assert!(
        text.contains("trace ms: the recorded rays alone") && text.contains("of one view, mean of"),
        "{text}"
    );
    // Rows that are sums alone do not tell of how many views.
    let sums: Vec<Row> = rows().into_iter().filter(Row::is_total).collect();
    let text = table::document(&sums, true);
    assert_eq!(cells(&text, "## Table 1", "phr-hq")[4], "16.0");
    assert!(text.contains("of all views together"), "{text}");
}

#[test]
fn failures_and_gaps_are_told_not_averaged() {
    let text = table::document(&rows(), true);
    assert_eq!(cells(&text, "## Table 1", "lbvh")[6..], ["error", "error", "error", "error"]);
    assert_eq!(cells(&text, "## Table 1", "hunt-50")[2..6], ["-", "-", "-", "-"]);
    assert!(text.contains("No build for conference-like: hunt-50\n"), "{text}");
    assert!(text.contains("no figures: yard lbvh/4: out of memory"), "{text}");
    // One scene is left of lbvh.
    assert_eq!(
        means(&text, "### Build time", "lbvh"),
        ["0.500", "-", "0.500", "-", "0.50 [0.50, 0.50]", "conference-like", "1"]
    );
}

#[test]
fn means_are_those_worked_out_by_hand() {
    let text = table::document(&rows(), true);
    assert_eq!(cells(&text, "### Build time", "phr-hq")[4..6], ["[0.002, 576.239]", "±0.3 %"]);
    // (2 + 0.5) / 2 and sqrt(2 * 0.5); (0.8 + 1.25) / 2 and sqrt(0.8 * 1.25).
    assert_eq!(
        means(&text, "### Build time", "phr-hq"),
        ["1.250", "1.821", "1.000", "1.636", "2.00 [1.99, 2.01]", "conference-like", "2"]
    );
    assert_eq!(
        means(&text, "### Trace time", "phr-hq"),
        ["1.025", "0.977", "1.000", "0.975", "1.25 [1.24, 1.26]", "yard", "2"]
    );
    assert_eq!(cells(&text, "### SAH cost", "phr-hq")[1..3], ["1.250", "0.947"]);
}

#[test]
fn kernels_are_never_mixed_silently() {
    let rows = rows();
    let text = table::document_under(&rows, true, &Under::by_name("phr", &rows).unwrap());
    assert_eq!(cells(&text, "## Table 1", "phr-hq")[..6], ["phr-hq", "phr", "20.0", "20.0", "16.0", "31.2"]);
    assert!(text.contains("all trees under the kernel phr"), "{text}");
    // Without Embree SAH under a kernel there is no ratio under it.
    let without: Vec<Row> =
        rows.iter().filter(|r| r.kernel != "phr" || r.builder != "embree-sah").cloned().collect();
    let text = table::document_under(&without, true, &Under::by_name("phr", &without).unwrap());
    assert!(!text.contains("### Trace time, recorded rays"), "{text}");
    assert!(
        Under::by_name("embree-native", &rows).unwrap_err().contains("there are embree-grafted, phr, own")
    );
}

#[test]
fn the_summary_has_the_means_and_the_worst_trace() {
    let folder = written(&rows());
    let made = |asked: &str| {
        let text = format!("<!-- summary: . {asked} -->\n<!-- end -->\n");
        readme::regenerate(&text, folder.path()).map_err(|error| error.to_string())
    };
    let text = made("embree-sah phr-hq").unwrap();
    assert_eq!(
        cells(&text, "<!--", "phr-hq"),
        [
            "phr-hq",
            "1.00 [0.00, 576.24]",
            "1.00 [0.13, 7.75]",
            "1.25 [1.24, 1.26]",
            "yard",
            "1.00 [0.00, 575.17]"
        ]
    );
    assert_eq!(cells(&text, "<!--", "embree-sah")[1..], ["1.00", "1.00", "", "", "1.00"]);
    assert!(text.contains("over 2 scenes, 2 threads") && !text.contains("fewer"), "{text}");
    // It failed in one.
    let text = made("lbvh phr-hq").unwrap();
    assert_eq!(cells(&text, "<!--", "lbvh*")[4], "conference-like");
    assert!(text.contains("| phr-hq ") && text.contains("* a mean over fewer scenes."), "{text}");
    for unknown in ["aac", "phr-hq/8", "phr-hq/wide"] {
        assert!(made(unknown).unwrap_err().contains(&format!("trace and cost of {unknown}")));
    }
}

/// The numbers of a configuration by the names of their fields, extensions that are off left out.
fn numbers(config: &serde_json::Value, path: &str, found: &mut BTreeMap<String, f64>) {
    for (name, value) in config.as_object().into_iter().flatten() {
        // `phr-best` is a PHR and what optimises its tree, whose costs are those of the collapse of others.
        let path = match name.as_str() {
            "phr" | "optimise" => String::new(),
            "costs" => "collapse.".into(),
            name if value.is_object() => format!("{path}{name}."),
            name => format!("{path}{name}"),
        };
        match value.as_f64() {
            Some(number) => drop(found.insert(path, number)),
            None => numbers(value, &path, found),
        }
    }
}

#[test]
fn every_constant_of_a_preset_is_listed_with_its_scenes() {
    let of = |name: &str| {
        let mut found = BTreeMap::new();
        numbers(&phr::builders::by_name::<4>(name).unwrap().config(), "", &mut found);
        found
    };
    let list = concat!(env!("CARGO_MANIFEST_DIR"), "/results/constants/chosen.csv");
    let lines: Vec<[String; 3]> = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(list)
        .unwrap()
        .records()
        .map(|line| std::array::from_fn(|i| line.as_ref().unwrap()[i].into()))
        .collect();
    let number = |text: &str| {
        let (above, below) = text.split_once('/').unwrap_or((text, "1"));
        above.parse::<f64>().unwrap() / below.parse::<f64>().unwrap()
    };
    let papers = of("phr-fast");
    for preset in ["phr-draft", "phr-turbo", "phr-speed", "phr-quality", "phr-best"] {
        let constants = of(preset);
        for (field, value) in constants.iter().filter(|(field, value)| papers.get(*field) != Some(value)) {
            let listed = lines.iter().any(|[of, name, listed]| {
                (of.as_str(), name.as_str()) == (preset, field)
                    && (number(listed) - value).abs() < 1e-6 * value
            });
            assert!(listed, "{list}: no line for {field} of {preset}, {value}; add it");
        }
    }
    for [preset, field, value] in &lines {
        let own = of(preset);
        let is_own = own.get(field).is_some_and(|own| (number(value) - own).abs() < 1e-6 * own);
        assert!(is_own, "{list}: {field} of {preset} is {:?}, not {value}; mend the line", own.get(field));
    }
}
