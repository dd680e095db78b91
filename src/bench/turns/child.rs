//! A program that builds when told to: `phr turns SCENE` loads the scene and answers each line `BUILDER WIDTH` on its
//! standard input by a line with the build's milliseconds, or `error REASON`, and `revision` by `revision REVISION`.

#![cfg_attr(not(test), warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use crate::bench::cell::Cell;
use crate::bench::contender::{BuildRequest, Contender};
use crate::bench::environment::Program;
use crate::bench::pools::Pools;
use crate::bench::statistics::median;
use crate::scene::Scene;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};

/// Begins the first line, before the hash of the scene.
const READY: &str = "ready ";
const ERROR: &str = "error ";
/// The question for a program's revision, and what its answer begins with.
const REVISION: &str = "revision";

/// Why two programs could not be measured by turns.
#[derive(Debug, thiserror::Error)]
pub enum ChildError {
    /// The program does not start.
    #[error("{}: {source}; give a build of this program", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// It ended, or says something else.
    #[error("{}: does not build by turns; give a build of this program that has `phr turns`", .0.display())]
    Silent(PathBuf),
    /// Its builder failed.
    #[error("{}: {reason}", program.display())]
    Failed {
        /// The program.
        program: PathBuf,
        /// Its message.
        reason: String,
    },
    /// The programs make another geometry of the same scene.
    #[error("{}: has another scene {scene}; give a scene file, which both read alike", program.display())]
    OtherScene {
        /// The second program.
        program: PathBuf,
        /// The scene.
        scene: String,
    },
}

/// A running program.
pub struct Child {
    program: PathBuf,
    process: std::process::Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    sha: String,
}

impl Child {
    /// Starts `program` and waits until it has loaded `scene`.
    ///
    /// # Errors
    /// Those of [`ChildError`].
    pub fn start(program: &Path, scene: &str, threads: usize) -> Result<Self, ChildError> {
        let mut command = Command::new(program);
        command.args(["turns", scene, "--threads", &threads.to_string()]);
        let failed = |source| ChildError::Start { program: program.to_owned(), source };
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
        let (Some(input), Some(output)) = (process.stdin.take(), process.stdout.take()) else {
            // Both were asked for.
            return Err(failed(std::io::ErrorKind::BrokenPipe.into()));
        };
        let output = BufReader::new(output);
        let mut child = Self { program: program.to_owned(), process, input, output, sha: String::new() };
        let line = child.line()?;
        child.sha = line.strip_prefix(READY).ok_or_else(|| child.silent())?.to_owned();
        Ok(child)
    }

    /// Hash of its scene.
    pub fn sha(&self) -> &str {
        &self.sha
    }

    /// Its revision; empty of older programs, which do not know the question.
    ///
    /// # Errors
    /// Its end.
    pub fn revision(&mut self) -> Result<String, ChildError> {
        let line = self.asked(REVISION)?;
        Ok(line.strip_prefix(REVISION).unwrap_or_default().trim_start().to_owned())
    }

    /// Has it build `cell`; milliseconds.
    ///
    /// # Errors
    /// Its builder's, or its end.
    pub fn build(&mut self, cell: &Cell) -> Result<f64, ChildError> {
        let line = self.asked(&format!("{} {}", cell.made_by(), cell.width))?;
        match line.strip_prefix(ERROR) {
            Some(reason) => {
                Err(ChildError::Failed { program: self.program.clone(), reason: reason.to_owned() })
            }
            None => line.parse().ok().filter(|ms| *ms > 0.0).ok_or_else(|| self.silent()),
        }
    }

    /// Its answer to a line.
    fn asked(&mut self, question: &str) -> Result<String, ChildError> {
        let asked = writeln!(self.input, "{question}").and_then(|()| self.input.flush());
        asked.map_err(|_| self.silent())?;
        self.line()
    }

    fn line(&mut self) -> Result<String, ChildError> {
        let mut line = String::new();
        match self.output.read_line(&mut line) {
            Ok(bytes) if bytes > 0 => Ok(line.trim_end().to_owned()),
            _ => Err(self.silent()),
        }
    }

    fn silent(&self) -> ChildError {
        ChildError::Silent(self.program.clone())
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The other side: answers each line of `input` on `output` until `input` ends.
///
/// # Errors
/// A closed pipe.
pub fn answer(
    scene: &Scene,
    pools: &Pools,
    input: impl BufRead,
    mut output: impl Write,
) -> std::io::Result<()> {
    writeln!(output, "{READY}{}", scene.sha)?;
    output.flush()?;
    for line in input.lines() {
        let line = line?;
        if line == REVISION {
            writeln!(output, "{REVISION} {}", Program::this().git_rev)?;
            output.flush()?;
            continue;
        }
        match build(scene, pools, &line) {
            Ok(ms) => writeln!(output, "{ms}")?,
            Err(reason) => writeln!(output, "{ERROR}{reason}")?,
        }
        output.flush()?;
    }
    Ok(())
}

/// The median of some builds, each by a new builder in new memory, ms.
fn build(scene: &Scene, pools: &Pools, line: &str) -> Result<f64, String> {
    let words = line.split_once(' ').and_then(|(builder, width)| Some((builder, width.parse().ok()?)));
    let (builder, width) = words.ok_or_else(|| format!("{line}: write BUILDER WIDTH"))?;
    let mut contender = Contender::of(&Cell::new(builder, width, &[]))?;
    let request =
        BuildRequest { mesh: &scene.mesh, pools, kernels: &[], wants_facts: false, fresh_only: true };
    let built = contender.build(&request)?;
    median(&built.times.fresh.ms).ok_or_else(|| format!("{builder}: not built"))
}
