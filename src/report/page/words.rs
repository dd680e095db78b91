//! What was measured, on what machine, and how far to believe it, in words.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]

use crate::bench::environment::{Environment, State, UNKNOWN};
use crate::bench::moment::Moment;
use crate::bench::row::{NO_KERNEL, Row};
use crate::bench::settings::Settings;

use crate::report::table::{counted_rounds, warned};
use serde::Serialize;

/// A heading and what it says.
#[derive(Debug, Serialize)]
pub struct Item {
    name: String,
    text: String,
}

fn item(name: &str, text: String) -> Item {
    Item { name: name.into(), text }
}

/// The surroundings of a run.
pub fn environment(environment: &Environment) -> Vec<Item> {
    let Environment { machine, program, library, .. } = environment;
    let mut items = Vec::new();
    if environment.state != State::Complete {
        items.push(item("State", "The run was stopped before all rounds of all scenes were done.".into()));
    }
    let shards = environment.plan.get("shards").and_then(|shards| shards.as_array()).map_or(0, Vec::len);
    let first = if shards > 1 {
        format!("{shards} shards on machines of this kind, of which the first is told: ")
    } else {
        String::new()
    };
    items.push(item(
        "Machine",
        first
            + &known(&[
                (machine.cpu.as_str(), ""),
                (&format!("{} processors", machine.processors), ""),
                (&format!("{:.0} GiB of memory", machine.memory_mib as f64 / 1024.0), ""),
                (&machine.cpu_features.join(" "), "instruction sets "),
            ]),
    ));
    items.push(item(
        "System",
        known(&[
            (machine.os.as_str(), ""),
            (&machine.kernel, "kernel "),
            (&machine.libc, ""),
            (&machine.governor, "frequency governor "),
            (&machine.huge_pages, "huge pages "),
            (if machine.cpu_quota == "max" { "" } else { &machine.cpu_quota }, "processor quota "),
        ]),
    ));
    items.push(item(
        "Program",
        known(&[
            (&format!("phr {}", program.version), ""),
            (&program.git_rev, "revision "),
            (&program.rustc, ""),
            (&program.profile, ""),
            (&program.rustflags, "flags "),
            (&isa(environment, &["phr", "phr_builders"]), ""),
        ]),
    ));
    if !library.embree.is_empty() {
        items.push(item(
            "Embree",
            known(&[
                (&library.embree, ""),
                (&library.embree_package, ""),
                (&library.tbb_package, ""),
                (&library.note, ""),
                (&isa(environment, &["embree", "embree_builders"]), ""),
            ]),
        ));
    }
    items.extend(settings(environment));
    items.extend(load(environment));
    if !environment.notes.is_empty() {
        items.push(item("Notes", environment.notes.join("; ")));
    }
    items
}

/// The texts that the system told, each behind its name, as one.
fn known(texts: &[(&str, &str)]) -> String {
    let told = texts.iter().filter(|(text, _)| !text.is_empty() && *text != UNKNOWN);
    told.map(|(text, name)| format!("{name}{text}")).collect::<Vec<_>>().join(", ")
}

/// `kernel avx512, builders avx512`.
fn isa(environment: &Environment, [kernel, builders]: &[&str; 2]) -> String {
    let of = |key: &str| environment.isa.get(key).and_then(|isa| isa.as_str()).unwrap_or_default().to_owned();
    known(&[(&of(kernel), "kernel with "), (&of(builders), "builders with ")])
}

fn settings(environment: &Environment) -> Option<Item> {
    let settings = environment.plan.get("settings")?.clone();
    let Settings { width, height, views, max_depth, rounds, seed, threads, build_only, frames, .. } =
        serde_json::from_value(settings).ok()?;
    let rays = if build_only {
        "builds only".into()
    } else {
        let frames = if frames { ", whole frames too" } else { "" };
        format!(
            "up to {views} views of {width} x {height} pixels, paths of at most {max_depth} segments{frames}"
        )
    };
    let rounds = counted_rounds(&rounds.to_string());
    Some(item("Measured", format!("{rounds} or more, {threads} threads on each side, {rays}, seed {seed}")))
}

fn load(environment: &Environment) -> Option<Item> {
    let moments: Vec<&Moment> = environment.before.iter().chain(&environment.after).collect();
    let others = moments
        .iter()
        .filter_map(|moment| moment.others)
        .fold(None, |most: Option<f64>, share| Some(most.map_or(share, |most| most.max(share))));
    let least = moments.iter().map(|moment| moment.spin.efficiency).reduce(f64::min)?;
    let threads = moments.first()?.spin.threads;
    let others = others.map_or_else(String::new, |share| {
        format!("other programs used at most {:.0} % of the processors, ", 100.0 * share)
    });
    let from = moments.first().map_or("", |moment| &moment.utc);
    let until = environment.after.as_ref().map_or_else(String::new, |moment| format!(" to {}", moment.utc));
    Some(item(
        "Load",
        format!(
            "{from}{until}; before and after, {others}{threads} threads together reached {least:.2} of their speed alone"
        ),
    ))
}

/// Each defect that rows have: its name, how many rows, and what to do.
pub fn warnings(rows: &[Row]) -> Vec<Item> {
    let found = warned(rows).into_iter();
    found
        .map(|(warning, count, of)| {
            item(warning.name(), format!("{count} of {of} rows: {}.", warning.advice()))
        })
        .collect()
}

/// Each row without figures: what it is, and why.
pub fn errors(rows: &[Row]) -> Vec<Item> {
    let of_row = |row: &Row| {
        let kernel = if row.kernel == NO_KERNEL { String::new() } else { format!(" under {}", row.kernel) };
        let wrong = if row.verified == Some(false) { "wrong hits: " } else { "" };
        item(
            &format!("{}, {} / {}{kernel}", row.scene, row.builder, row.width),
            format!("{wrong}{}", row.error),
        )
    };
    rows.iter().filter(|row| !row.error.is_empty()).map(of_row).collect()
}
