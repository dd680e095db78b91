//! Two programs measured by turns: each runs in a process of its own ([`child`]) and builds when told to, so that a
//! pair of builds follows each other within a second and drift hits both. After a few rounds both processes start
//! anew, in a new session: what a process keeps for its life (where its memory lies) is drawn again, and counts as
//! noise ([`paired`]). The records ([`row`]) are kept from session to session.

pub mod child;
pub mod paired;
pub mod row;

use crate::bench::cell::Cell;
use crate::bench::environment::Machine;
use crate::bench::environment::moment::utc_now;
use crate::bench::files::RecordsError;
use crate::bench::statistics::median;
use crate::random::SplitMix64;
use child::{Child, ChildError};
use paired::PairedMean;
use row::{SCHEMA, TURNS, TurnRow};
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
    /// The folder that keeps the records.
    pub out: Option<&'a Path>,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Session by session, scene by scene.
    pub rows: Vec<TurnRow>,
    /// False if the time was over before the precision was reached.
    pub is_precise: bool,
}

/// Why two programs were not measured to the end.
#[derive(Debug, thiserror::Error)]
pub enum TurnsError {
    /// A program.
    #[error(transparent)]
    Child(#[from] ChildError),
    /// A place for the records that cannot be written.
    #[error(transparent)]
    Records(#[from] RecordsError),
}

impl Turns<'_> {
    /// Measures; `told` hears of each step and of the seconds spent.
    ///
    /// # Errors
    /// A child that cannot be started, fails, or has another scene than the other; an unwritable folder.
    pub fn measure(&self, told: &mut dyn FnMut(&str, Duration)) -> Result<Measured, TurnsError> {
        let start = Instant::now();
        let about = TurnRow {
            schema: SCHEMA,
            utc: utc_now(),
            cpu: Machine::this("").cpu,
            threads: self.threads as u32,
            ..TurnRow::default()
        };
        let mut rows = Vec::new();
        let mut sessions = 0;
        let is_precise = loop {
            for (scene, name) in self.scenes.iter().zip(self.names) {
                told(&format!("{name}, session {}", sessions + 1), start.elapsed());
                let about = TurnRow { scene: name.clone(), ..about.clone() };
                rows.extend(self.session(scene, sessions, &about)?);
                if let Some(out) = self.out {
                    row::write(&out.join(TURNS), &rows)?;
                }
            }
            sessions += 1;
            let is_narrow = |cell: &Cell| {
                let of_cell = rows.iter().filter(|row| row.tree() == (&cell.builder, cell.width));
                PairedMean::of_rows(of_cell).half_width() <= self.precision
            };
            if sessions >= LEAST_SESSIONS && self.cells.iter().all(is_narrow) {
                break true;
            }
            // Another session takes as long as those before.
            let next = start.elapsed() / sessions as u32;
            if sessions >= LEAST_SESSIONS && start.elapsed() + next > self.limit {
                break false;
            }
        };
        Ok(Measured { rows, is_precise })
    }

    /// One session in `scene`: for each cell the medians of its rounds.
    fn session(&self, scene: &str, session: usize, about: &TurnRow) -> Result<Vec<TurnRow>, ChildError> {
        let start = |side: usize| Child::start(self.programs[side], scene, self.threads);
        let mut children = [start(0)?, start(1)?];
        if children[0].sha() != children[1].sha() {
            return Err(ChildError::OtherScene {
                program: PathBuf::from(self.programs[1]),
                scene: about.scene.clone(),
            });
        }
        let revisions = [children[0].revision()?, children[1].revision()?];
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
                rounds[cell][2].push(ms[1] / ms[0]);
            }
        }
        let of_cell = |(cell, rounds): (&Cell, &[Vec<f64>; 3])| {
            let [before_ms, after_ms, ratio] =
                [0, 1, 2].map(|column: usize| median(&rounds[column]).unwrap_or(f64::NAN));
            let [before_rev, after_rev] = revisions.clone();
            TurnRow {
                before_rev,
                after_rev,
                builder: cell.builder.clone(),
                width: cell.width,
                session: session as u32 + 1,
                before_ms,
                after_ms,
                ratio,
                ..about.clone()
            }
        };
        Ok(self.cells.iter().zip(&rounds).map(of_cell).collect())
    }
}
