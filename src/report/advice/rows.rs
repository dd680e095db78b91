//! Advice as CSV: one row per tree.

use super::Advice;
use crate::bench::files::{RecordsError, write_whole};
use serde::Serialize;
use std::path::Path;

/// Version of the columns.
const SCHEMA: u32 = 1;
/// The file.
pub const ADVICE: &str = "advice.csv";

/// One tree, figures with the ends of their 95 % intervals.
#[derive(Debug, Serialize)]
struct AdviceRow<'a> {
    schema: u32,
    scene: &'a str,
    triangles: usize,
    origin: &'a str,
    builder: &'a str,
    width: u32,
    rounds: usize,
    build_ms: Option<f64>,
    build_ms_low: Option<f64>,
    build_ms_high: Option<f64>,
    ns_per_ray: Option<f64>,
    ns_per_ray_low: Option<f64>,
    ns_per_ray_high: Option<f64>,
    rays: f64,
    total_ms: Option<f64>,
    total_ms_low: Option<f64>,
    total_ms_high: Option<f64>,
    best_from_rays: Option<f64>,
    note: &'a str,
}

/// Writes the advice to `folder`, whole or not at all.
///
/// # Errors
/// An unwritable place.
pub fn write(folder: &Path, advice: &Advice) -> Result<(), RecordsError> {
    let path = folder.join(ADVICE);
    let malformed = |source| RecordsError::Malformed { path: path.clone(), source };
    let winners = advice.winners();
    let mut writer = csv::Writer::from_writer(Vec::new());
    for known in &advice.trees {
        // An end that nothing is known of is empty.
        let finite = |value: f64| Some(value).filter(|value| value.is_finite() && *value > 0.0);
        let figures = |estimate: Option<crate::bench::quick::line::Estimate>| {
            let ends =
                |of: fn(crate::bench::quick::line::Estimate) -> f64| estimate.and_then(|it| finite(of(it)));
            (ends(|it| it.value), ends(|it| it.low), ends(|it| it.high))
        };
        let (build_ms, build_ms_low, build_ms_high) = figures(known.line.map(|line| line.build_ms));
        let (ns_per_ray, ns_per_ray_low, ns_per_ray_high) = figures(known.line.map(|line| line.ns_per_ray));
        let (total_ms, total_ms_low, total_ms_high) =
            figures(known.line.map(|line| line.estimate_at(advice.rays)));
        let is_this = |other: &&(&super::Known, f64)| std::ptr::eq(other.0, known);
        let row = AdviceRow {
            schema: SCHEMA,
            scene: &advice.scene,
            triangles: advice.triangles,
            origin: &advice.origin,
            builder: &known.builder,
            width: known.width,
            rounds: known.rounds,
            build_ms,
            build_ms_low,
            build_ms_high,
            ns_per_ray,
            ns_per_ray_low,
            ns_per_ray_high,
            rays: advice.rays,
            total_ms,
            total_ms_low,
            total_ms_high,
            best_from_rays: winners.iter().find(is_this).map(|(_, from)| *from),
            note: &known.note,
        };
        writer.serialize(row).map_err(malformed)?;
    }
    let bytes = writer.into_inner().map_err(|error| malformed(error.into_error().into()))?;
    write_whole(&path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::advice::tests::advice;

    #[test]
    fn a_row_per_tree_with_what_is_known() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &advice()).unwrap();
        let mut reader = csv::Reader::from_path(folder.path().join(ADVICE)).unwrap();
        let header = reader.headers().unwrap().clone();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let cell = |row: usize, column: &str| {
            let at = header.iter().position(|name| name == column).unwrap();
            rows[row][at].to_owned()
        };
        assert_eq!(rows.len(), 5);
        assert_eq!(cell(0, "builder"), "lbvh");
        assert!((cell(0, "total_ms").parse::<f64>().unwrap() - 10_010.0).abs() < 1e-6);
        assert_eq!(
            (cell(1, "best_from_rays"), cell(3, "best_from_rays")),
            ("500000.0".into(), String::new())
        );
        assert_eq!((cell(4, "build_ms"), cell(4, "note")), (String::new(), "no time".into()));
    }
}
