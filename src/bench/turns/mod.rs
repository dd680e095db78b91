//! Two programs measured by turns: each runs in a process of its own ([`child`]) and builds when told to, so that a
//! pair of builds follows each other within a second and drift hits both. After a few rounds both processes start
//! anew, in a new session: what a process keeps for its life (where its memory lies) is drawn again, and counts as
//! noise ([`paired`]).

pub mod child;
pub mod paired;

use crate::bench::cell::Cell;
use crate::random::SplitMix64;
use child::{Child, ChildError};
use paired::{Log, PairedMean};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Rounds of a session; their median is the session's sample.
const ROUNDS: usize = 5;
/// Sessions per scene before intervals are looked at.
const LEAST_SESSIONS: usize = 5;

/// What is measured.
pub struct Turns<'a> {
    /// The programs: that before, and that after.
    pub programs: [&'a Path; 2],
    /// Scenes as a command line takes them.
    pub scenes: &'a [String],
    /// The name of each in tables and messages.
    pub names: &'a [String],
    /// What both build.
    pub cells: &'a [Cell],
    /// Threads of the builds.
    pub threads: usize,
    /// Sessions are added until every interval is no wider than this on either side, relative to the ratio.
    pub precision: f64,
    /// Or until this has passed.
    pub limit: Duration,
}

/// Samples of a cell in a scene: for each session the logarithm of the time after over the time before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OfScene {
    /// By session.
    pub logs: Vec<Log>,
    /// Medians of the times in the last session, ms: before, after.
    pub ms: [f64; 2],
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// By cell, then by scene.
    pub samples: Vec<Vec<OfScene>>,
    /// False if the time was over before the precision was reached.
    pub is_precise: bool,
    /// Sessions per scene.
    pub sessions: usize,
    /// Time spent.
    pub spent: Duration,
}

impl Turns<'_> {
    /// Measures; `told` hears of each step and of the seconds spent.
    ///
    /// # Errors
    /// A child that cannot be started, fails, or has another scene than the other.
    pub fn measure(&self, told: &mut dyn FnMut(&str, Duration)) -> Result<Measured, ChildError> {
        let start = Instant::now();
        let mut samples = vec![vec![OfScene::default(); self.scenes.len()]; self.cells.len()];
        let mut sessions = 0;
        let is_precise = loop {
            for (index, (scene, name)) in self.scenes.iter().zip(self.names).enumerate() {
                told(&format!("{name}, session {}", sessions + 1), start.elapsed());
                let of_cells = self.session(scene, name, sessions)?;
                for (of_cell, (log, ms)) in samples.iter_mut().zip(of_cells) {
                    of_cell[index].logs.push(log);
                    of_cell[index].ms = ms;
                }
            }
            sessions += 1;
            let is_narrow = |of_cell: &Vec<OfScene>| {
                PairedMean::of(of_cell.iter().map(|scene| &scene.logs[..])).half_width() <= self.precision
            };
            if sessions >= LEAST_SESSIONS && samples.iter().all(is_narrow) {
                break true;
            }
            // Another session takes as long as those before.
            let next = start.elapsed() / sessions as u32;
            if sessions >= LEAST_SESSIONS && start.elapsed() + next > self.limit {
                break false;
            }
        };
        Ok(Measured { samples, is_precise, sessions, spent: start.elapsed() })
    }

    /// One session in `scene`: for each cell the median of its rounds.
    fn session(&self, scene: &str, name: &str, session: usize) -> Result<Vec<(Log, [f64; 2])>, ChildError> {
        let start = |side: usize| Child::start(self.programs[side], scene, self.threads);
        let mut children = [start(0)?, start(1)?];
        if children[0].sha() != children[1].sha() {
            return Err(ChildError::OtherScene {
                program: PathBuf::from(self.programs[1]),
                scene: name.into(),
            });
        }
        let mut rounds: Vec<[Vec<f64>; 3]> = vec![Default::default(); self.cells.len()];
        for round in 0..ROUNDS {
            let mut order: Vec<usize> = (0..self.cells.len()).collect();
            SplitMix64::new((session * ROUNDS + round) as u64).shuffle(&mut order);
            for cell in order {
                let mut ms = [0.0; 2];
                // Who is first alternates.
                for turn in 0..2 {
                    let side = (turn + round + session) % 2;
                    ms[side] = children[side].build(&self.cells[cell])?;
                }
                rounds[cell][0].push(ms[0]);
                rounds[cell][1].push(ms[1]);
                rounds[cell][2].push((ms[1] / ms[0]).ln());
            }
        }
        let median = |values: &[f64]| crate::bench::statistics::median(values).unwrap_or(f64::NAN);
        Ok(rounds.iter().map(|[a, b, logs]| (median(logs), [median(a), median(b)])).collect())
    }
}
