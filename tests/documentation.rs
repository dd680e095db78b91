//! The pages: their figures are those of the committed rows, the committed plots are drawn from them, the README is
//! short and every relative link leads to a file or heading.

#![cfg(feature = "harness")]

use std::path::{Path, PathBuf};
use std::process::Command;

fn phr(arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_phr"))
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "phr {}: {}{}",
        arguments.join(" "),
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn figures_in_the_text_are_those_of_the_rows() {
    let has_markers = |page: &PathBuf| {
        let text = std::fs::read_to_string(page).unwrap();
        prose(&text).any(|(_, line)| line.contains("<!-- end -->"))
    };
    let pages: Vec<PathBuf> = pages().into_iter().filter(has_markers).collect();
    assert!(pages.len() >= 2, "{pages:?}");
    let names = pages.iter().map(|page| page.to_str().unwrap());
    phr(&["readme", "--check"].into_iter().chain(names).collect::<Vec<_>>());
}

/// A run that git leaves out is there where the page was written, and nowhere else.
#[test]
fn runs_behind_the_figures_are_kept_by_git() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let texts: Vec<String> = pages().iter().map(|page| std::fs::read_to_string(page).unwrap()).collect();
    let lines = texts.iter().flat_map(|text| prose(text));
    let markers = lines
        .flat_map(|(_, line)| line.split("<!-- ").skip(1))
        .filter_map(|marker| marker.split("-->").next());
    let mut runs: Vec<&str> =
        markers.flat_map(|marker| marker.split(' ')).filter(|word| word.starts_with("results/")).collect();
    runs.sort_unstable();
    runs.dedup();
    assert!(runs.len() >= 10, "{runs:?}");
    let ignored = |path: &str| {
        let git = Command::new("git").args(["check-ignore", "--quiet", path]).current_dir(root).status();
        // Neither outside a repository nor without git is anything left out.
        git.is_ok_and(|status| status.success())
    };
    for run in runs {
        let rows = format!("{run}/rows.csv");
        assert!(
            !ignored(&rows),
            "a page has figures of {run}, which .gitignore leaves out; add !/{run}/ there"
        );
    }
}

#[test]
fn the_readme_is_short() {
    let lines = include_str!("../README.md").lines().count();
    assert!(
        lines <= 130,
        "README.md has {lines} lines, at most 130 are wanted; move details to another page"
    );
}

#[test]
fn the_examples_are_short() {
    let entries = |folder: &Path| -> Vec<PathBuf> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
    };
    let check = |path: &Path, most: usize| {
        let lines = std::fs::read_to_string(path).unwrap().lines().count();
        assert!(lines <= most, "{} has {lines} lines, at most {most} are wanted", path.display());
    };
    for path in entries(&Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")) {
        if path.is_dir() {
            let sources =
                entries(&path).into_iter().filter(|path| path.extension().is_some_and(|x| x == "rs"));
            sources.for_each(|path| check(&path, 80));
        } else {
            check(&path, 40);
        }
    }
}

/// Files below `results` in a folder; none where there is no such folder.
fn results(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("results").join(folder);
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    entries.map(|entry| entry.unwrap().path()).collect()
}

/// Runs whose figures are kept; one of which none is kept yet is left out.
#[test]
fn plots_are_drawn_from_the_rows() {
    let has_figures =
        |run: &str| results(run).iter().any(|file| file.extension().is_some_and(|ending| ending == "svg"));
    let runs = [
        "reference",
        "reference/growth",
        "reference/threads",
        "paper-protocol",
        "experiments/phases",
        "scaling",
    ];
    let runs: Vec<&str> = runs.into_iter().filter(|run| has_figures(run)).collect();
    assert!(runs.len() >= 5, "{runs:?}");
    for run in runs {
        phr(&["plot", &format!("results/{run}"), "--check"]);
    }
}

#[test]
fn heat_maps_are_drawn_from_their_counts() {
    let mut records = results("experiments/heatmap");
    records.retain(|file| file.extension().is_some_and(|ending| ending == "csv"));
    assert!(!records.is_empty());
    for records in records {
        phr(&["heatmap", "--check", "-o", records.with_extension("png").to_str().unwrap()]);
    }
}

#[test]
fn the_animation_is_drawn_and_told_from_its_frames() {
    phr(&["animate", "--check"]);
}

#[test]
fn figures_of_experiments_are_drawn_from_their_records() {
    let all = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/experiments");
    let names = std::fs::read_dir(&all).unwrap().map(|it| it.unwrap().file_name().into_string().unwrap());
    // Heat maps are made by a verb of their own, phases by a run.
    let names: Vec<String> = names.filter(|name| !["heatmap", "phases"].contains(&name.as_str())).collect();
    assert!(!names.is_empty());
    let check = |name: &String| {
        // Those over stand-ins for the paper's scenes have folders of their own.
        let experiment = name.strip_suffix("-paper").unwrap_or(name);
        let folder = format!("results/experiments/{name}");
        // Those of the paper's methods are told from the fullest run, or from the paper's protocol.
        let has_records =
            ["rows.csv", &format!("{name}.csv")].iter().any(|file| all.join(name).join(file).is_file());
        let runs: &[&str] = match (has_records, experiment == name) {
            (true, _) => &[],
            (false, true) => &["--rows", "results/reference-avx512"],
            (false, false) => &["--rows", "results/paper-protocol", "--rows", "results/paper-steps"],
        };
        phr(&[&["experiment", experiment, "--check", "--out", &folder], runs].concat());
    };
    // Two at a time: each draws its pixels on one thread.
    let check = &check;
    std::thread::scope(|scope| {
        for half in names.chunks(names.len().div_ceil(2)) {
            scope.spawn(move || half.iter().for_each(check));
        }
    });
}

#[test]
fn the_table_beside_the_rows_is_theirs() {
    let output = Command::new(env!("CARGO_BIN_EXE_phr"))
        .args(["table", "results/reference"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let committed = std::fs::read_to_string("results/reference/table1.md").unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), committed.trim_end());
}

/// The pages that readers see, relative to the repository.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages = Vec::new();
    for folder in ["", "docs", "results"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "md") {
                pages.push(path);
            }
        }
    }
    pages
}

/// Lines of a page outside code, counted from 1.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        (!is_code && !is_fence).then_some((index + 1, line))
    })
}

#[test]
fn the_makefile_hands_on_what_scripts_are_told() {
    // Make gives what runs below it its own value of a variable that the caller set.
    let makefile = concat!(include_str!("../Makefile"), include_str!("../results/runs.mk"));
    let is_assigned = |name: &str| {
        let words = makefile.lines().filter_map(|line| line.strip_prefix(name)?.split_whitespace().next());
        words.into_iter().any(|word| matches!(word, "=" | ":=" | "+="))
    };
    assert!(is_assigned("FULL") && !is_assigned("RESULTS"));
    let mut told = 0;
    for script in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".ci")).unwrap() {
        let script = script.unwrap().path();
        let text = std::fs::read_to_string(&script).unwrap();
        for name in text.split("${").skip(1).filter_map(|rest| Some(rest.split_once(":-")?.0)) {
            assert!(!is_assigned(name), "{}: {name} is the Makefile's; rename one", script.display());
            told += 1;
        }
    }
    assert!(told > 0, "no script has ${{NAME:-...}}");
}

/// Anchors of the headings of a page: lower case, words joined by hyphens, without punctuation.
fn anchors(text: &str) -> Vec<String> {
    let headings = prose(text).filter(|(_, line)| line.starts_with('#'));
    let kept = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    headings
        .map(|(_, line)| line.trim_start_matches('#').trim().to_lowercase())
        .map(|heading| heading.chars().filter(|&c| kept(c)).collect::<String>().replace(' ', "-"))
        .collect()
}

/// The relative links of a page that lead nowhere, each with its line.
fn broken_links(text: &str, page: &Path) -> Vec<String> {
    let mut broken = Vec::new();
    for (line, content) in prose(text) {
        for target in content.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if target.contains("://") {
                continue;
            }
            let (path, anchor) = target.split_once('#').map_or((target, None), |(path, a)| (path, Some(a)));
            let file = if path.is_empty() { page.to_owned() } else { page.with_file_name("").join(path) };
            let has_anchor = |anchor: &str| {
                let text = std::fs::read_to_string(&file).unwrap_or_default();
                anchors(&text).iter().any(|heading| heading == anchor)
            };
            if !file.exists() || anchor.is_some_and(|anchor| !has_anchor(anchor)) {
                broken.push(format!("{}:{line}: {target}", page.display()));
            }
        }
    }
    broken
}

#[test]
fn every_link_leads_somewhere() {
    let pages = pages();
    assert!(pages.len() >= 8, "{pages:?}");
    let broken = |page: &PathBuf| broken_links(&std::fs::read_to_string(page).unwrap(), page);
    let broken: Vec<String> = pages.iter().flat_map(broken).collect();
    assert!(broken.is_empty(), "links to nothing; correct them:\n{}", broken.join("\n"));
}

#[test]
fn broken_links_and_anchors_are_found() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let text = "[a](LICENSE) [b](nowhere.rs)\n```\n[c](nowhere.rs)\n```\n[d](BIAS.md#what-remains)\n\
                [e](BIAS.md#nothing) [f](https://example.org/none)\n";
    let found: Vec<String> = broken_links(text, &page);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found[0].ends_with("README.md:1: nowhere.rs") && found[1].ends_with("README.md:6: BIAS.md#nothing")
    );
}
