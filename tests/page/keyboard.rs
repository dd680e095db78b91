//! What a reader without a pointer gets.

use super::browser::Browser;
use super::run;

const LEFT: &str = "\u{e012}";
const UP: &str = "\u{e013}";
const RIGHT: &str = "\u{e014}";
const ESCAPE: &str = "\u{e00c}";

#[test]
fn arrow_keys_take_the_tooltip_from_point_to_point() {
    let Some(browser) = Browser::start() else { return };
    let folder = run::folder(&run::small());
    browser.open(&run::report(folder.path()));
    for figure in ["#front", "#totals"] {
        let tip = || browser.texts(&format!("{figure} [aria-label=tip]")).concat().replace('\u{200b}', "");
        let told = || browser.texts(&format!("{figure} output")).concat();
        let press = |key| browser.keys(&format!("{figure} svg"), key);
        // What is seen is what is told, but for line ends.
        let is_told = || told().replace([' ', ','], "") == tip().replace([' ', ','], "");
        assert_eq!((tip(), told()), (String::new(), String::new()), "{figure}");
        press(RIGHT);
        let first = told();
        assert!(!first.is_empty() && is_told(), "{figure}: {first}, seen: {}", tip());
        press(RIGHT);
        let second = told();
        assert!(second != first && is_told(), "{figure}: {second}, seen: {}", tip());
        press(LEFT);
        assert_eq!(told(), first, "{figure}");
        press(UP);
        assert_eq!((told() != first, is_told()), (figure == "#totals", true), "{figure}: {}", told());
        press(ESCAPE);
        assert_eq!((tip(), told()), (String::new(), String::new()), "{figure}");
    }
    assert_eq!(browser.console(), Vec::<String>::new());
}
