//! All trees of a scene within a time limit: rounds in which each is visited once, without those that surely win
//! nowhere. After every round it is decided anew from all visits who goes on, so that a tree that was left out comes
//! back when the others turn out slower than they looked.

use super::QuickVisit;
use super::line::{TotalTime, competing};
use crate::bench::cell::Cell;
use crate::bench::warnings::ENOUGH_SAMPLES;
use crate::random::SplitMix64;
use std::time::Duration;

/// Numbers of rays over which a tree may win.
pub const BUDGETS: [f64; 11] = [1e5, 3e5, 1e6, 3e6, 1e7, 3e7, 1e8, 3e8, 1e9, 3e9, 1e10];
/// Visits before a tree with a prospect may be dropped, and rounds before those without one have their turn.
pub const LEAST_ROUNDS: usize = ENOUGH_SAMPLES;
/// The share of the time after which only trees that compete are measured, however few visits others had.
const LAST: f64 = 0.75;
/// The note of a tree that was visited often enough and surely wins nowhere.
pub const DROPPED: &str = "dropped";

/// A tree to be measured.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Builder and width.
    pub cell: Cell,
    /// Build time to be expected, ms; 0 if nothing is known.
    pub expected_ms: f64,
    /// Whether it may be the best for some number of rays, as far as is known.
    pub has_prospect: bool,
}

impl Candidate {
    /// Visits before it may be dropped: where nothing is expected of it, one that bears that out is enough.
    fn least_visits(&self) -> usize {
        if self.has_prospect { LEAST_ROUNDS } else { 1 }
    }
}

/// What a survey found of a tree.
#[derive(Clone, Debug)]
pub struct Surveyed {
    /// Builder and width.
    pub cell: Cell,
    /// The visits.
    pub visits: Vec<QuickVisit>,
    /// Inner nodes that a ray visits, where they could be counted.
    pub nodes_per_ray: Option<f64>,
    /// Why there are no more: dropped, failed, no time.
    pub note: String,
}

/// Visits trees, and has the clock.
pub trait Visitor {
    /// Visits a tree in a round; with `counts` also counts the inner nodes that a ray visits, where that can be.
    ///
    /// # Errors
    /// Why the tree has no times, in one line.
    fn visit(&mut self, round: usize, cell: &Cell, counts: bool)
    -> Result<(QuickVisit, Option<f64>), String>;

    /// The time since the start.
    fn elapsed(&self) -> Duration;
}

/// How long trees compete, and for what.
pub struct Contest<'a> {
    /// When to stop, from the start on.
    pub limit: Duration,
    /// The numbers of rays for which a tree may be the best.
    pub budgets: Vec<f64>,
    /// The total time of each tree from all visits so far; `None` for one that has none.
    pub estimate: &'a dyn Fn(&[Surveyed]) -> Vec<Option<TotalTime>>,
}

impl Contest<'_> {
    /// Which trees may be the best for some number of rays, as far as is known. One without a visit may.
    fn competing(&self, found: &[Surveyed]) -> Vec<bool> {
        let lines = (self.estimate)(found);
        let known: Vec<TotalTime> = lines.iter().flatten().copied().collect();
        let mut competes = competing(&known, &self.budgets).into_iter();
        lines.iter().map(|line| line.is_none() || competes.next().unwrap_or(true)).collect()
    }
}

/// Measures `candidates` by turns until the time is over: first those with a prospect, the best first, the others
/// after [`LEAST_ROUNDS`] rounds of these. The first visit is made whatever the time.
pub fn survey(visitor: &mut dyn Visitor, candidates: &[Candidate], contest: &Contest<'_>) -> Vec<Surveyed> {
    let none = |candidate: &Candidate| Surveyed {
        cell: candidate.cell.clone(),
        visits: Vec::new(),
        nodes_per_ray: None,
        note: String::new(),
    };
    let mut found: Vec<Surveyed> = candidates.iter().map(none).collect();
    let mut competes = vec![true; found.len()];
    let mut random = SplitMix64::new(1);
    let mut is_first = true;
    for round in 0.. {
        let has_turn = round >= LEAST_ROUNDS;
        let is_last = visitor.elapsed() > contest.limit.mul_f64(LAST);
        let takes_part = |&i: &usize| {
            let is_hardly_known = found[i].visits.len() < candidates[i].least_visits();
            found[i].note.is_empty()
                && (has_turn || candidates[i].has_prospect)
                && (competes[i] || (is_hardly_known && !is_last))
        };
        let mut order: Vec<usize> = (0..found.len()).filter(takes_part).collect();
        if round > 0 {
            random.shuffle(&mut order);
        }
        let mut visited = 0;
        for i in order {
            let left = contest.limit.saturating_sub(visitor.elapsed());
            let known = found[i].visits.first().map(|visit| visit.build_ms);
            // What is built in more than 60 ms is built once in a visit, unless others disturb it.
            let expected =
                Duration::from_secs_f64(1.2e-3 * known.unwrap_or(candidates[i].expected_ms).max(0.0));
            if !is_first && (left.is_zero() || expected > left) {
                continue;
            }
            is_first = false;
            let is_new = found[i].visits.is_empty();
            let surveyed = &mut found[i];
            match visitor.visit(round, &surveyed.cell, is_new) {
                Ok((visit, nodes)) => {
                    surveyed.visits.push(visit);
                    surveyed.nodes_per_ray = surveyed.nodes_per_ray.or(nodes);
                }
                Err(reason) => {
                    surveyed.visits.clear();
                    surveyed.note = reason;
                }
            }
            visited += 1;
        }
        competes = contest.competing(&found);
        if visited == 0 && has_turn || visitor.elapsed() >= contest.limit {
            break;
        }
    }
    // By the last estimates, which the advice is made of: what is the best there is never called dropped.
    for ((surveyed, candidate), competes) in found.iter_mut().zip(candidates).zip(competes) {
        if !surveyed.note.is_empty() {
            continue;
        }
        if surveyed.visits.is_empty() {
            surveyed.note = "no time".into();
        } else if !competes && surveyed.visits.len() >= candidate.least_visits() {
            surveyed.note = DROPPED.into();
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Visits of a tenth of a second each that find what `of` says of a builder and its earlier visits.
    struct Scripted {
        of: fn(&str, usize) -> Result<QuickVisit, String>,
        told: Vec<(usize, String)>,
    }

    impl Visitor for Scripted {
        fn visit(
            &mut self,
            round: usize,
            cell: &Cell,
            counts: bool,
        ) -> Result<(QuickVisit, Option<f64>), String> {
            let earlier = self.told.iter().filter(|(_, builder)| *builder == cell.builder).count();
            self.told.push((round, cell.builder.clone()));
            Ok(((self.of)(&cell.builder, earlier)?, counts.then_some(20.0)))
        }

        fn elapsed(&self) -> Duration {
            Duration::from_millis(100 * self.told.len() as u64)
        }
    }

    fn students(found: &[Surveyed]) -> Vec<Option<TotalTime>> {
        found.iter().map(|one| TotalTime::of(&one.visits)).collect()
    }

    /// The survey of so many visits to these builders, and who was visited in which round.
    fn surveyed(
        of: fn(&str, usize) -> Result<QuickVisit, String>,
        builders: &[&str],
        visits: u64,
    ) -> (Vec<Surveyed>, Vec<(usize, String)>) {
        let candidate = |builder: &&str| Candidate {
            cell: Cell::new(builder, 4, &[]),
            expected_ms: if *builder == "late" { 1e6 } else { 0.0 },
            has_prospect: *builder != "bad",
        };
        let candidates: Vec<Candidate> = builders.iter().map(candidate).collect();
        let mut visitor = Scripted { of, told: Vec::new() };
        let limit = Duration::from_millis(100 * visits);
        let contest = Contest { limit, budgets: BUDGETS.to_vec(), estimate: &students };
        (survey(&mut visitor, &candidates, &contest), visitor.told)
    }

    #[test]
    fn what_is_surely_behind_is_dropped_after_the_least_rounds() {
        let of = |builder: &str, earlier: usize| -> Result<QuickVisit, String> {
            let (build_ms, ns_per_ray) = match builder {
                "quick" => (10.0, 200.0),
                "good" => (100.0, 100.0),
                "near" => (11.0, 201.0),
                "slow" | "bad" => (400.0, 300.0),
                _ => return Err("wrong hits".to_owned()),
            };
            let noise = [0.9, 1.0, 1.1][earlier % 3];
            Ok(QuickVisit { build_ms: noise * build_ms, ns_per_ray: noise * ns_per_ray })
        };
        let (found, _) = surveyed(of, &["quick", "good", "near", "slow", "bad", "failed", "late"], 40);
        let notes: Vec<&str> = found.iter().map(|one| one.note.as_str()).collect();
        assert_eq!(notes, ["", "", "", DROPPED, DROPPED, "wrong hits", "no time"]);
        let visits: Vec<usize> = found.iter().map(|one| one.visits.len()).collect();
        assert!(visits[..3].iter().all(|&count| count > 2 * LEAST_ROUNDS), "{visits:?}");
        // Of the bad one nothing was expected: the first interval, after two visits, is enough.
        assert_eq!(visits[3..], [LEAST_ROUNDS, 2, 0, 0]);
        assert_eq!(found[0].nodes_per_ray, Some(20.0));
    }

    #[test]
    fn a_tree_that_was_left_out_comes_back() {
        let of = |builder: &str, earlier: usize| -> Result<QuickVisit, String> {
            let ns_per_ray = match builder {
                "lucky" if earlier < LEAST_ROUNDS => 100.0,
                "lucky" => 200.0,
                _ => 150.0,
            };
            Ok(QuickVisit { build_ms: 10.0, ns_per_ray })
        };
        let (found, told) = surveyed(of, &["lucky", "steady"], 20);
        let is_in = |round: usize| told.contains(&(round, "steady".to_owned()));
        assert!(is_in(2) && !is_in(3) && is_in(4), "{told:?}");
        assert!(found[1].visits.len() > LEAST_ROUNDS && found[1].note.is_empty(), "{found:?}");
    }

    #[test]
    fn before_the_least_rounds_nothing_is_called_dropped() {
        let of = |builder: &str, _: usize| -> Result<QuickVisit, String> {
            let ns_per_ray = if builder == "slow" { 1000.0 } else { 100.0 };
            Ok(QuickVisit { build_ms: 0.01 * ns_per_ray, ns_per_ray })
        };
        for visits in 2..=4 {
            let (found, _) = surveyed(of, &["fast", "slow"], visits);
            assert!(found.iter().all(|one| !one.visits.is_empty() && one.note.is_empty()), "{found:?}");
        }
        let (found, _) = surveyed(of, &["fast", "slow"], 7);
        assert_eq!((found[1].visits.len(), found[1].note.as_str()), (LEAST_ROUNDS, DROPPED));
    }
}
