//! `phr build`: one scene, one builder, its phases and its tree.

use crate::bench::contender::{self, BuildRequest, BuiltTree, Contender, Saving};
use crate::bench::memory;
use crate::bench::planned_scene::PlannedScene;
use crate::bench::statistics::Summary;
use crate::cli::failure::Failure;
use crate::cli::note::note;
use crate::cli::options::{Made, all_threads, held, loaded, pools};
use crate::cli::output::say;
use crate::cli::place::{FileKind, check_place};
use crate::report::grid::short;
use std::path::PathBuf;

/// Build a scene and print the phases and the tree's statistics
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file or name of a generated scene
    scene: String,
    /// Builder (repeatable) [default: all]
    #[arg(long = "builder", value_name = "NAME")]
    builders: Vec<String>,
    #[command(flatten)]
    made: Made,
    /// Children per node, 4 or 8 [default: 4, or the one width that the builder has; of all builders, every width]
    #[arg(long, value_name = "N")]
    width: Option<u32>,
    /// File into which to save the tree, of one builder and width, which are told; `phr::Bvh::load` and `phr bench
    /// --tree` read it
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pools = pools(arguments.threads.unwrap_or_else(all_threads))?;
    let chosen = arguments.made.chosen(&arguments.builders)?;
    let cells = if chosen.is_empty() {
        let all = contender::cells(true);
        all.into_iter().filter(|cell| arguments.width.is_none_or(|width| cell.width == width)).collect()
    } else {
        chosen.single_cells(arguments.width)?
    };
    if cells.is_empty() {
        let width = arguments.width.unwrap_or_default();
        return Err(Failure::Bad(format!("--width {width}: no builder builds such trees; give 4 or 8")));
    }
    if let (Some(output), true) = (&arguments.output, cells.len() > 1) {
        let remedy = "holds one tree; give --builder and --width";
        return Err(Failure::Bad(format!("--output {}: {remedy}", output.display())));
    }
    if let Some(output) = &arguments.output {
        check_place(output, FileKind::Tree)?;
    }
    let scene = loaded(&PlannedScene::find(&arguments.scene)?)?;
    say(&format!("{}: {} ({})", scene.name, held(&scene), scene.source))?;
    let request =
        BuildRequest { mesh: &scene.mesh, pools: &pools, kernels: &[], wants_facts: true, fresh_only: false };
    let program = std::env::current_exe()?;
    let mut failed = Vec::new();
    for cell in cells {
        let built = Contender::of(&cell).and_then(|mut contender| contender.build(&request));
        let built = match built {
            Ok(built) => built,
            // The others may be built all the same.
            Err(reason) => {
                failed.push(format!("{}, width {}: {reason}", cell.builder, cell.width));
                continue;
            }
        };
        let mut text = describe(&built);
        if let Some(output) = &arguments.output {
            let tree = built.tree().map_err(|reason| Failure::Wrong(reason.to_owned()))?;
            let Saving { saved_ms, loaded_ms, bytes } =
                tree.save(&scene.mesh, &cell.builder, output, &pools.all)?;
            text += &line("saved", format!("{} in {} ms", mebibytes(bytes), short(saved_ms)));
            text += &line(
                "loaded again",
                loaded_ms.map_or("no memory for it".into(), |ms| format!("{} ms", short(ms))),
            );
        }
        match memory::measure(&program, &scene.mesh, &cell, pools.all.current_num_threads()) {
            Ok(memory) => {
                text += &line("resident, peak of build", mebibytes(memory.peak_bytes));
                text += &line("resident, after it", mebibytes(memory.live_bytes));
            }
            Err(reason) => note(&format!("no resident bytes: {reason}")),
        }
        say(&format!("\n{}, width {}\n{text}", cell.builder, cell.width))?;
    }
    if failed.is_empty() { Ok(()) } else { Err(Failure::Wrong(failed.join("; "))) }
}

fn describe(built: &BuiltTree<'_>) -> String {
    let times = &built.times;
    let mut text = String::new();
    let mut line = |name: &str, value: String| text += &self::line(name, value);
    let dynamic = times.dynamic_rebuild.as_ref();
    let regimes = [
        ("build (new memory)", Some(&times.fresh)),
        ("rebuild (memory reused)", Some(&times.rebuild)),
        ("rebuild (dynamic scene)", dynamic),
    ];
    for (name, times) in regimes {
        if let Some(build) = times.and_then(|times| Summary::of(&times.ms)) {
            let (median, min) = (short(build.median), short(build.min));
            line(name, format!("{median} ms (median of {}, least {min})", build.count));
        }
    }
    line("first build (new builder, once)", format!("{} ms", short(times.first_ms)));
    for (name, ms) in &times.phases {
        line(&format!("  {name}"), format!("{} ms", short(*ms)));
    }
    let facts = built.facts.clone().unwrap_or_default();
    let mut figure = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            line(name, value);
        }
    };
    figure("tree", facts.bytes.map(mebibytes));
    figure("SAH cost", facts.sah.map(|x| format!("{x:.4}")));
    figure("EPO", facts.epo.map(|x| format!("{x:.4}")));
    figure("nodes", facts.nodes.map(|n| n.to_string()));
    figure("leaves", facts.leaves.map(|n| n.to_string()));
    figure("depth", facts.depth.map(|n| n.to_string()));
    figure("leaf fill", facts.leaf_fill.map(|x| format!("{:.1} %", 100.0 * x)));
    figure("references per triangle", facts.refs_per_tri.map(|x| format!("{x:.4}")));
    figure("built by", Some(facts.engine));
    figure("parameters", Some(facts.config));
    text
}

fn line(name: &str, value: String) -> String {
    format!("  {name:<33} {value}\n")
}

fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / (1 << 20) as f64)
}
