//! Growth of build times with the scene.

use super::judged;
use super::rows::{growing, rows, with};
use phr::bench::row::Row;
use phr::report::figures::{Place, Under};
use phr::report::plot;
use phr::report::targets::growth::{Growth, growth};
use phr::report::targets::list::Measure;

#[test]
fn growth_is_per_triangle_and_relative_to_the_smallest() {
    let rows = growing();
    let found = Growth::of(&rows);
    assert_eq!(found.sizes, [1_000_000, 4_000_000, 32_000_000]);
    let fast = found.lines.iter().find(|line| line.builder == "phr-fast").unwrap();
    assert_eq!(fast.ns, [100.0, 100.0, 125.0].map(Place::Value));
    assert_eq!(found.relative(fast, 2), Place::Value(1.25));
    let cells = |text: &str, builder: &str| {
        let line = text.lines().find(|line| line.starts_with(&format!("| {builder} "))).unwrap();
        line.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let text = growth(&rows);
    assert_eq!(cells(&text, "phr-fast"), "phr-fast 100 1.000 1.250 [1.25, 1.25] ≤ 1.25 met");
    assert_eq!(cells(&text, "embree-sah"), "embree-sah 200 1.000 1.000 [1.00, 1.00] -");
    assert_eq!(cells(&text, "phr-speed"), "phr-speed - - - ? ≤ 1.25 not measured");
    let worse = with(growing(), |row| row.scene == "scalable-32M", |row| row.build_ms_median = Some(4001.0));
    assert_eq!(cells(&growth(&worse), "phr-fast"), "phr-fast 100 1.000 1.250 [1.25, 1.25] ≤ 1.25 not met");
    let fewer: Vec<Row> = growing().into_iter().filter(|row| row.scene != "scalable-32M").collect();
    assert_eq!(cells(&growth(&fewer), "phr-fast"), "phr-fast 100 1.000 ? ≤ 1.25 not measured");
    // Times of two runs are not mixed; scenes of any size are no part of the targets; others none of growth.
    let mut other = with(growing(), |_| true, |row| row.build_ms_median = Some(1.0));
    other.retain(|row| row.scene == "scalable-1M");
    other.iter_mut().for_each(|row| row.run_id = "another".into());
    other.extend(growing());
    assert_eq!(Growth::of(&other), found);
    assert_eq!(judged(&rows, "phr-fast", Measure::Build("embree-sah")).of_scenes, 0);
    assert_eq!(growth(&super::rows::rows()), "");
}

#[test]
fn growth_is_drawn_from_two_sizes_on() {
    let draw = |rows: &[Row]| plot::figures(rows, &[], &Under::best(rows));
    let drawings = draw(&growing());
    let drawing = drawings.iter().find(|drawing| drawing.name == "growth").unwrap();
    assert!(["phr-fast", "embree-sah"].iter().all(|name| drawing.svg.contains(&format!(">{name}<"))));
    assert_eq!(draw(&growing()), drawings);
    let one: Vec<Row> = growing().into_iter().filter(|row| row.scene == "scalable-1M").collect();
    assert!(draw(&one).iter().chain(&draw(&rows())).all(|drawing| drawing.name != "growth"));
}
