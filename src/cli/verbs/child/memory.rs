//! `phr memory`: the process in which `phr bench` and `phr build` measure the memory of one build.

use crate::bench::memory::answer;
use crate::cli::failure::Failure;
use crate::cli::options::{Made, cells, pools};
use crate::cli::output::say;
use std::slice::from_ref;

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
    let pools = pools(arguments.threads)?;
    for cell in cells(from_ref(&arguments.builder), &Made::default(), &[arguments.width])? {
        let memory = answer(std::io::stdin().lock(), &cell, &pools.all).map_err(Failure::Wrong)?;
        say(&serde_json::json!(memory).to_string())?;
    }
    Ok(())
}
