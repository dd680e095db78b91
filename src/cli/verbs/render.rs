//! `phr render`: a path-traced image of a scene.

use crate::bench::cell::Cell;
use crate::bench::chosen::Chosen;
use crate::bench::contender::saved::{check, offer};
use crate::bench::contender::{BuildRequest, Contender, TreeUnderKernel};
use crate::bench::planned_scene::PlannedScene;
use crate::cli::failure::Failure;
use crate::cli::options::{self, all_threads, held, pools, traceable};
use crate::cli::output::say;
use crate::cli::place::{FileKind, check_place};
use crate::trace::{self, Image, PathSettings};
use std::path::{Path, PathBuf};
use std::slice::from_ref;

/// Render a view of a scene through a builder's tree to a PNG file
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scene file or name of a generated scene
    scene: String,
    /// Builder [default: phr-hq]
    #[arg(long, value_name = "NAME")]
    builder: Option<String>,
    /// The builder with this field of its configuration changed (repeatable): BUILDER.FIELD=VALUE, as phr-hq.delta=8;
    /// it is called phr-hq[delta=8]
    #[arg(long = "set", value_name = "CHANGE")]
    changes: Vec<String>,
    /// The builder of this file: {"name": NAME, "base": BUILDER, "fields": {"FIELD": VALUE}}
    #[arg(long = "config", value_name = "FILE")]
    configs: Vec<PathBuf>,
    /// Children per node, 4 or 8 [default: 4, or the one width that the builder has]
    #[arg(long, value_name = "N")]
    width: Option<u32>,
    /// A tree of the scene that `phr build -o` saved, in place of a builder's
    #[arg(long, value_name = "FILE", conflicts_with_all = ["builder", "changes", "configs", "width"])]
    tree: Option<PathBuf>,
    /// PNG file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// View, from 0
    #[arg(long, default_value_t = 0, value_name = "K")]
    view: usize,
    /// Pixels across and down
    #[arg(long, default_value_t = 1024, value_name = "PIXELS")]
    size: u32,
    /// Paths per pixel
    #[arg(long, default_value_t = 16, value_name = "N")]
    samples: u32,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pools = pools(arguments.threads.unwrap_or_else(all_threads))?;
    for (option, value) in [("size", arguments.size), ("samples", arguments.samples)] {
        if value == 0 || value > 1 << 14 {
            return Err(Failure::Bad(format!("--{option} {value}: give 1 to {}", 1 << 14)));
        }
    }
    let cell = cell(arguments)?;
    check_place(&arguments.output, FileKind::Png)?;
    if !arguments.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
        return Err(Failure::Bad(format!(
            "{}: images are PNG; end the name in .png",
            arguments.output.display()
        )));
    }
    let scene = traceable(&PlannedScene::find(&arguments.scene)?)?;
    check(&scene.mesh)?;
    let view = options::view(&scene, arguments.view)?;
    let kernel = *cell.kernels.first().ok_or_else(|| Failure::Bad(format!("{}: no kernel", cell.builder)))?;
    let request = BuildRequest {
        mesh: &scene.mesh,
        pools: &pools,
        kernels: from_ref(&kernel),
        wants_facts: false,
        fresh_only: true,
    };
    let mut contender = Contender::of(&cell).map_err(Failure::Wrong)?;
    let built = contender.build(&request).map_err(Failure::Wrong)?;
    let threads = pools.all.current_num_threads();
    let tree = TreeUnderKernel::new(&built, kernel, threads).map_err(Failure::Wrong)?;
    let tracer = tree.tracer().map_err(|reason| Failure::Wrong(reason.to_owned()))?;
    let mut image = Image::new(arguments.size, arguments.size);
    for sample in 0..arguments.samples {
        let seed = 1 + u64::from(sample);
        let settings = PathSettings { width: arguments.size, height: arguments.size, max_depth: 8, seed };
        let frame = pools.all.install(|| trace::render(tracer, &scene.mesh, view, &settings));
        image.add(&frame, 1.0 / arguments.samples as f32);
    }
    image.write_png(&arguments.output)?;
    let (file, view, size) = (arguments.output.display(), arguments.view, arguments.size);
    let (name, Cell { builder, width, .. }) = (&scene.name, &cell);
    let held = held(&scene);
    say(&format!("{file}: {name} view {view}, {held}, {size} x {size}, {builder} / {width}"))
}

/// The one builder or saved tree asked for; a changed builder may be named beside its changes.
fn cell(arguments: &Arguments) -> Result<Cell, Failure> {
    let none: [&Path; 0] = [];
    let saved = Chosen::new(&offer(arguments.tree.as_slice())?, &[], &none)?;
    if !saved.is_empty() {
        return one(saved.single_cells(None)?);
    }
    let changed = Chosen::new(&[], &arguments.changes, &arguments.configs)?;
    let named = arguments
        .builder
        .iter()
        .filter(|name| !arguments.changes.iter().any(|change| change.starts_with(&format!("{name}."))));
    let named = Chosen::new(&named.cloned().collect::<Vec<_>>(), &[], &none)?;
    match (changed.is_empty(), named.is_empty()) {
        (true, _) => one(named.or("phr-hq").single_cells(arguments.width)?),
        (false, true) => one(changed.single_cells(arguments.width)?),
        (false, false) => one(Vec::new()),
    }
}

fn one(cells: Vec<Cell>) -> Result<Cell, Failure> {
    match cells.as_slice() {
        [cell] => Ok(cell.clone()),
        _ => Err(Failure::Bad("--builder, --set and --config name several builders; give one".into())),
    }
}
