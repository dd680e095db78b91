//! A run of hundreds of scenes: little of its table is in the document at once, all of it within reach.

use super::browser::Browser;
use super::{head, rows_of, run};
use phr::bench::row::Row;
use phr::report::figures::tree_name;
use phr::report::grid::short;

#[test]
fn a_run_of_500_scenes_is_shown_page_by_page() {
    let Some(browser) = Browser::start() else { return };
    let mut rows = run::large(500);
    let folder = run::folder(&rows);
    let page = run::report(folder.path());
    assert!(page.metadata().unwrap().len() < 4 << 20);
    browser.open(&page);
    let elements = || browser.script("return document.querySelectorAll('*').length").as_u64().unwrap();
    let count = || browser.texts("#count").concat();
    // Every scene is an option of the choice, no more.
    assert!((500..2000).contains(&elements()), "{}", elements());
    browser.click("#place option[value='all']");
    assert!((500..4000).contains(&elements()), "{}", elements());
    assert_eq!((rows_of(&browser).len(), count()), (100, "100 of 4 000 rows".into()));

    browser.click("#more");
    assert_eq!((rows_of(&browser).len(), count()), (200, "200 of 4 000 rows".into()));
    // Paper has all of them, once each.
    browser.script("dispatchEvent(new Event('beforeprint'))");
    rows.retain(|row| row.kernel == "embree-grafted");
    let name = |row: &Row| (row.scene.clone(), tree_name((&row.builder, row.width)));
    let mut wanted: Vec<_> = rows.iter().map(name).collect();
    let mut shown: Vec<_> = rows_of(&browser).iter().map(|row| (row[0].clone(), row[1].clone())).collect();
    wanted.sort();
    shown.sort();
    assert_eq!((shown.len(), count()), (4_000, "4 000 rows".into()));
    assert!(shown == wanted, "a row is missing or there twice");
    browser.script("dispatchEvent(new Event('afterprint'))");
    assert_eq!((rows_of(&browser).len(), count()), (200, "200 of 4 000 rows".into()));

    // The first page has the least of all, then the greatest.
    rows.sort_by(|a, b| a.trace_ms_median.unwrap().total_cmp(&b.trace_ms_median.unwrap()));
    let traces: Vec<String> = rows.iter().map(|row| short(row.trace_ms_median.unwrap())).collect();
    let first = || rows_of(&browser).iter().map(|row| row[6].clone()).collect::<Vec<_>>();
    browser.click("[data-by='trace ms']");
    assert_eq!((head(&browser, "trace ms"), first()), ("\"ascending\"".into(), traces[..100].to_vec()));
    browser.click("[data-by='trace ms']");
    let greatest: Vec<String> = traces.into_iter().rev().take(100).collect();
    assert_eq!((head(&browser, "trace ms"), first()), ("\"descending\"".into(), greatest));

    browser.keys("#filter", "scene-499");
    assert_eq!((rows_of(&browser).len(), count()), (8, "8 rows".into()));
    assert!(rows_of(&browser).iter().all(|row| row[0] == "scene-499"));
    assert_eq!(browser.console(), Vec::<String>::new());
}
