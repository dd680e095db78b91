//! The page of a run, in a browser: it loads without an error and asks for nothing, sorts, filters, tells of a
//! point under the pointer, and its numbers are those of the rows. Skipped where Chromium is not installed, unless
//! `PHR_BROWSER` is set.

#![cfg(feature = "harness")]

mod browser;
#[path = "../harness/by_hand.rs"]
mod by_hand;
mod keyboard;
mod large;
mod run;

use browser::{Browser, ENTER};
use phr::bench::row::{ALL, FIRST, REBUILD, Row};
use phr::report::figures::interval::Interval;
use phr::report::figures::{Figure, SceneFigures, Under, tree_name};
use phr::report::grid::short;
use phr::report::means::Ratios;
use phr::report::verdict::field::Field;
use phr::report::verdict::totals::{budgets, totals};
use phr::report::verdict::{rays_in_words, verdict};
use serde_json::Value;

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

/// A ratio with the interval that it has.
fn with_interval(value: f64, interval: Interval) -> String {
    let [low, high] = [interval.low, interval.high].map(|end| format!("{end:.4e}"));
    if low == high { format!("{value:.2}") } else { format!("{value:.2} {}", interval.shown(2)) }
}

#[test]
fn it_loads_without_an_error_or_a_request() {
    let Some(browser) = Browser::start() else { return };
    let folder = run::folder(&run::small());
    run::attach(folder.path());
    let page = run::report(folder.path());
    browser.requests();
    for (width, scheme) in [1400, 390].into_iter().flat_map(|width| [(width, "light"), (width, "dark")]) {
        browser.screen(width, 900, scheme);
        browser.open(&page);
        assert_eq!(browser.console(), Vec::<String>::new());
        let wide = browser.script("return document.documentElement.scrollWidth").as_u64().unwrap();
        assert_eq!(wide, u64::from(width), "nothing is cut off");
        assert_eq!(browser.texts("figure#front svg, figure#totals svg").len(), 2, "both plots are drawn");
        assert_eq!(is_dark(&browser), scheme == "dark", "{width} {scheme}");
    }
    for (name, in_dark) in [("light", false), ("dark", true), ("automatic", true)] {
        browser.click("#theme");
        assert_eq!(
            (browser.texts("#theme").concat(), is_dark(&browser)),
            (format!("theme: {name}"), in_dark)
        );
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
    let widths = "return Promise.all([...document.querySelectorAll('img[src^=\"data:\"]')].map(async (image) => { \
                  image.loading = 'eager'; await image.decode(); return image.naturalWidth; }))";
    let widths: Vec<u32> = serde_json::from_value(browser.script(widths)).unwrap();
    assert!(widths.len() == 2 && widths.iter().all(|&width| width > 0), "{widths:?}");
}

fn is_dark(browser: &Browser) -> bool {
    let paper = browser.script("return getComputedStyle(document.body).backgroundColor").to_string();
    paper.contains("22, 22, 21")
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
    let mut compared = 0;
    for line in rows_of(&browser) {
        let tree = run::tree(line[0].split(" 2 of 3").next().unwrap());
        for (cell, figure) in line[1..].iter().zip([Figure::Build, Figure::Cost, Figure::Trace]) {
            let mean = Ratios::of(&rows, tree, figure, &under);
            let shown = with_interval(mean.geometric().unwrap(), mean.interval(mean.over()).unwrap());
            assert_eq!(*cell, shown, "{tree:?} {figure:?}");
            compared += usize::from(shown.contains('['));
        }
    }
    assert!(compared >= 6, "intervals are shown");
    let sentences: Vec<String> =
        verdict(&Field::of(&rows).unwrap(), &under).iter().map(|sentence| sentence.text()).collect();
    assert_eq!(browser.texts(".verdict p"), sentences);
    // 12.125 of 20.7 ms; 11.5 of 12.3456 ms.
    for (sentence, part) in sentences.iter().zip([
        "phr-hq traces fastest: in 0.59 [",
        "embree-sah / 8 builds fastest: in 0.93 [",
        "embree-sah / 8 takes least time up to ",
    ]) {
        assert!(sentence.contains(part), "{sentence}");
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
        let of_yard = SceneFigures::of(&rows, "yard");
        for (at, figure) in [(2, Figure::Build), (4, Figure::Cost), (7, Figure::Trace)] {
            let ratio = of_yard.ratio((&row.builder, row.width), figure, &under).unwrap();
            assert_eq!(line[at], with_interval(ratio.value, ratio.interval()), "{figure:?} {line:?}");
        }
        assert_eq!(cell(8), short(row.peak_bytes.unwrap() as f64 / row.triangles as f64));
    }
    // Builds of other regimes.
    for (choice, regime) in [("1", FIRST), ("2", REBUILD)] {
        browser.click(&format!("#regime option[value='{choice}']"));
        let shown = rows_of(&browser);
        let of_regime = rows.iter().filter(|row| row.scene == "yard" && row.regime == regime);
        let pairs = of_regime.map(|row| {
            let line = shown.iter().find(|line| run::tree(&line[0]) == (&row.builder, row.width)).unwrap();
            (line[1].clone(), short(row.build_ms_median.unwrap()))
        });
        let (shown, wanted): (Vec<String>, Vec<String>) = pairs.unzip();
        assert_eq!((shown.len(), shown), (3, wanted));
    }
    // And the data behind them, to the last digit.
    let data: Value = serde_json::from_str(&browser.texts("#data")[0]).unwrap();
    let names: Vec<&str> =
        data["trees"].as_array().unwrap().iter().map(|tree| tree["name"].as_str().unwrap()).collect();
    compared = 0;
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
fn a_tooltip_has_the_figures_of_the_rows() {
    let Some(browser) = Browser::start() else { return };
    let rows = run::small();
    let (folder, under) = (run::folder(&rows), Under::best(&rows));
    browser.open(&run::report(folder.path()));
    // Lines begin with a space of no width.
    let told_at = |figure: &str, mark: &str| -> Vec<String> {
        let tip = || browser.texts(&format!("{figure} [aria-label=tip]")).concat();
        assert_eq!(tip(), "");
        browser.script(&format!("document.querySelector('{figure}').scrollIntoView({{ block: 'center' }})"));
        browser.point_at(&format!("{figure} {mark}"));
        tip().split('\u{200b}').map(|line| line.trim().to_owned()).filter(|line| !line.is_empty()).collect()
    };

    let told = told_at("#totals", "[aria-label=text] text");
    let (count, value) = told[1].split_once(": ").unwrap();
    let rays = budgets(4).into_iter().find(|&rays| rays_in_words(rays) == count).unwrap();
    let field = Field::of(&rows).unwrap();
    let all = totals(&field, Figure::Build, &under).into_iter();
    let all: Vec<(String, f64)> = all.map(|total| (tree_name(total.tree), total.at(rays))).collect();
    let of_tree = all.iter().find(|(name, _)| *name == told[0]).unwrap();
    let least = all.iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    assert_eq!(
        (value, &told[2]),
        (&*format!("{:.2}", of_tree.1), &format!("least: {}, {:.2}", least.0, least.1))
    );

    browser.click("#place option[value='3']");
    let told = told_at("#front", "[aria-label=dot] path:last-child");
    let yard = SceneFigures::of(&rows, "yard");
    let ratio = |figure| yard.ratio(("phr-hq", 4), figure, &under).unwrap();
    let timed = |figure| with_interval(ratio(figure).value, ratio(figure).interval());
    let row = yard.trace(("phr-hq", 4), "embree-grafted").value().unwrap();
    let [build, speed] = [row.build_ms_median, row.mrays_s].map(|value| short(value.unwrap()));
    let wanted = [
        "phr-hq".to_owned(),
        format!("build {}", timed(Figure::Build)),
        format!("trace {}", timed(Figure::Trace)),
        format!("SAH cost {:.2}", ratio(Figure::Cost).value),
        format!("{build} ms, {speed} million rays/s"),
    ];
    assert_eq!(told, wanted);
}
