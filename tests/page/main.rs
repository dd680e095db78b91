//! The page of a run, in a browser: it loads without an error and asks for nothing, sorts, filters, tells of a point under
//! the pointer, and its numbers are those of the rows. Skipped where Chromium is not installed.

#![cfg(feature = "harness")]

mod browser;
#[path = "../harness/by_hand.rs"]
mod by_hand;
mod run;

use browser::{Browser, ENTER};
use phr::bench::row::{ALL, Row};
use phr::report::figures::{Figure, Under};
use phr::report::grid::short;
use phr::report::means::Ratios;
use serde_json::Value;
use std::path::Path;

fn rows_of(browser: &Browser) -> Vec<Vec<String>> {
    let cells = browser.script(
        "return [...document.querySelectorAll('#table tbody tr')].map((row) => \
         [...row.cells].map((cell) => cell.textContent.replace(/\\s+/g, ' ').trim()))",
    );
    serde_json::from_value(cells).unwrap()
}

fn head(browser: &Browser, column: &str) -> String {
    browser
        .script(&format!("return document.querySelector('[data-by=\"{column}\"]').closest('th').ariaSort"))
        .to_string()
}

#[test]
fn it_loads_without_an_error_or_a_request() {
    let Some(browser) = Browser::start() else { return };
    let folder = run::folder(&run::small());
    run::attach(folder.path());
    let page = run::report(folder.path());
    browser.requests();
    for (width, scheme) in [(1400, "light"), (390, "dark")] {
        browser.screen(width, 900, scheme);
        browser.open(&page);
        assert_eq!(browser.console(), Vec::<String>::new());
        let wide = browser.script("return document.documentElement.scrollWidth").as_u64().unwrap();
        assert_eq!(wide, u64::from(width), "nothing is cut off");
        assert_eq!(browser.texts("figure#front svg, figure#totals svg").len(), 2, "both plots are drawn");
        let dark = browser.script("return getComputedStyle(document.body).backgroundColor").to_string();
        assert_eq!(dark.contains("22, 22, 21"), scheme == "dark", "{dark}");
    }
    // What the browser shows before the page is its own.
    let asked = browser.requests();
    assert!(asked.iter().any(|address| address.starts_with("file://")), "requests are seen: {asked:?}");
    let others: Vec<&String> =
        asked.iter().filter(|url| **url != format!("file://{}", page.display())).collect();
    assert!(
        others
            .iter()
            .all(|url| ["data:", "chrome:", "chrome-untrusted:"].iter().any(|own| url.starts_with(own))),
        "{others:?}"
    );
    // What would ask for something is refused.
    browser
        .script("document.body.append(Object.assign(new Image(), { src: 'https://example.invalid/a.png' }))");
    assert!(browser.console().concat().contains("Content Security Policy"));

    let all = browser.texts("body").concat();
    for text in
        ["a <b>scene</b> & \"more\"", "out of memory", "HighSpread", "Heat maps", "alpha delta", "0.55"]
    {
        assert!(all.contains(text), "no {text}");
    }
    let pictures = "return [...document.images].map((image) => { image.loading = 'eager'; return image.src.slice(0, 15) })";
    let pictures: Vec<String> = serde_json::from_value(browser.script(pictures)).unwrap();
    assert_eq!(pictures.iter().filter(|start| start.starts_with("data:image/")).count(), 2, "{pictures:?}");
}

#[test]
fn the_table_sorts_and_filters() {
    let Some(browser) = Browser::start() else { return };
    let folder = run::folder(&run::small());
    browser.open(&run::report(folder.path()));
    let trees = |rows: Vec<Vec<String>>| rows.into_iter().map(|row| row[0].clone()).collect::<Vec<_>>();
    let order = ["lbvh 2 of 3 scenes", "embree-sah", "embree-sah / 8", "phr-hq"];
    assert_eq!(trees(rows_of(&browser)), order);

    // By a click and by key, up and down.
    browser.click("[data-by='build relative']");
    assert_eq!(head(&browser, "build relative"), "\"ascending\"");
    assert_eq!(trees(rows_of(&browser)), ["lbvh 2 of 3 scenes", "embree-sah / 8", "embree-sah", "phr-hq"]);
    browser.keys("[data-by='build relative']", ENTER);
    assert_eq!(head(&browser, "build relative"), "\"descending\"");
    assert_eq!(trees(rows_of(&browser)), ["phr-hq", "embree-sah", "embree-sah / 8", "lbvh 2 of 3 scenes"]);
    assert_eq!(browser.script("return document.activeElement.dataset.by"), "build relative", "focus stays");
    assert_eq!(head(&browser, "trace relative"), "\"none\"");

    browser.click("#width option[value='8']");
    assert_eq!(trees(rows_of(&browser)), ["embree-sah / 8"]);
    browser.click("#width option[value='']");
    browser.click("#place option[value='all']");
    assert_eq!(browser.texts("#count"), ["12 rows"]);
    browser.keys("#filter", "yard PHR");
    let found = rows_of(&browser);
    assert!(found.len() == 1 && found[0][0] == "yard" && found[0][1] == "phr-hq", "{found:?}");
    // Both plots follow the choice of kernel.
    let front = || browser.texts("#front-about").concat();
    assert!(front().contains("embree-grafted"), "{}", front());
    browser.click("#kernel option[value='1']");
    assert!(front().contains("under the kernel phr"), "{}", front());
}

#[test]
fn its_numbers_are_those_of_the_rows() {
    let Some(browser) = Browser::start() else { return };
    let rows = run::small();
    let folder = run::folder(&rows);
    browser.open(&run::report(folder.path()));

    // Means, as the tables of the command have them.
    let under = Under::best(&rows);
    for line in rows_of(&browser) {
        let tree = run::tree(line[0].split(" 2 of 3").next().unwrap());
        for (cell, figure) in line[1..].iter().zip([Figure::Build, Figure::Cost, Figure::Trace]) {
            let mean = Ratios::of(&rows, tree, figure, &under);
            let mean = format!("{:.2}", mean.geometric().unwrap());
            assert_eq!(cell.split(' ').next().unwrap(), mean, "{tree:?} {figure:?}");
        }
    }
    // Every figure of a scene.
    browser.click("#place option[value='3']");
    let shown = rows_of(&browser);
    let of_yard = |row: &&Row| row.scene == "yard" && row.view == ALL && row.kernel == "embree-grafted";
    let wanted: Vec<&Row> = rows.iter().filter(of_yard).filter(|row| row.is_compared()).collect();
    assert_eq!((shown.len(), wanted.len()), (4, 3), "lbvh failed there");
    for row in wanted {
        let line = shown.iter().find(|line| run::tree(&line[0]) == (&row.builder, row.width)).unwrap();
        let cell = |at: usize| line[at].split(' ').next().unwrap().to_owned();
        let figures = [row.build_ms_median, row.sah, row.trace_ms_median, row.mrays_s];
        assert_eq!(
            [cell(1), cell(3), cell(5), cell(6)],
            figures.map(|value| short(value.unwrap())),
            "{line:?}"
        );
    }
    // And the data behind them, to the last digit.
    let data: Value = serde_json::from_str(&browser.texts("#data")[0]).unwrap();
    let names: Vec<&str> =
        data["trees"].as_array().unwrap().iter().map(|tree| tree["name"].as_str().unwrap()).collect();
    let mut compared = 0;
    for row in rows.iter().filter(|row| row.is_total() && row.is_compared() && row.is_good()) {
        let place = data["places"]
            .as_array()
            .unwrap()
            .iter()
            .find(|place| place["name"] == row.scene.as_str())
            .unwrap();
        let tree = names.iter().position(|name| run::tree(name) == (&row.builder, row.width)).unwrap();
        let kernel = data["kernels"]
            .as_array()
            .unwrap()
            .iter()
            .position(|kernel| kernel["name"] == row.kernel.as_str());
        let entry = &place["entries"][tree];
        assert_eq!(entry["builds"][0][0].as_f64(), row.build_ms_median);
        assert_eq!(entry["traces"][kernel.unwrap()][0].as_f64(), row.trace_ms_median);
        assert_eq!(entry["speeds"][kernel.unwrap()].as_f64(), row.mrays_s);
        compared += 1;
    }
    assert_eq!(compared, 22);
}

#[test]
fn a_tooltip_shows() {
    let Some(browser) = Browser::start() else { return };
    let folder = run::folder(&run::small());
    browser.open(&run::report(folder.path()));
    for (figure, words) in [("#front", ["build", "trace"]), ("#totals", ["rays", "least:"])] {
        let tip = || browser.texts(&format!("{figure} [aria-label=tip]")).concat();
        assert_eq!(tip(), "");
        browser.script(&format!("document.querySelector('{figure}').scrollIntoView({{ block: 'center' }})"));
        let mark = if figure == "#front" {
            "#front [aria-label=dot] path"
        } else {
            "#totals [aria-label=text] text"
        };
        browser.point_at(mark);
        let told = tip();
        assert!(words.iter().all(|word| told.contains(word)), "{figure}: {told:?}");
    }
}

#[test]
fn a_large_run_is_shown_page_by_page() {
    let Some(browser) = Browser::start() else { return };
    let folder = run::folder(&run::large(500));
    let page = run::report(folder.path());
    assert!(is_smaller(&page, 16 << 20));
    browser.open(&page);
    assert_eq!(browser.console(), Vec::<String>::new());
    browser.click("#place option[value='all']");
    assert_eq!(
        (rows_of(&browser).len(), browser.texts("#count").concat()),
        (100, "100 of 10 000 rows".into())
    );
    browser.click("#more");
    assert_eq!(rows_of(&browser).len(), 200);
    browser.keys("#filter", "scene-499");
    assert_eq!((rows_of(&browser).len(), browser.texts("#count").concat()), (20, "20 rows".into()));
}

fn is_smaller(file: &Path, bytes: u64) -> bool {
    file.metadata().unwrap().len() < bytes
}
