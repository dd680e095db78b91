//! `phr memory`: the process in which `phr bench` and `phr build` measure the memory of one build.

use crate::bench::memory::answer;
use crate::cli::failure::Failure;
use crate::cli::options::{cell, pools};
use crate::cli::output::say;

/// Build the mesh that comes on standard input once and print the resident bytes; run by bench and build
#[derive(Debug, clap::Args)]
#[command(hide = true)]
pub struct Arguments {
    /// Builder
    #[arg(long, value_name = "NAME")]
    builder: String,
    /// Children per node
    #[arg(long, value_name = "N")]
    width: u32,
    /// Threads
    #[arg(long, value_name = "N")]
    threads: usize,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let cell = cell(&arguments.builder, Some(arguments.width))?;
    let pools = pools(arguments.threads)?;
    let memory = answer(std::io::stdin().lock(), &cell, &pools.all).map_err(Failure::Wrong)?;
    say(&serde_json::json!(memory).to_string())
}
