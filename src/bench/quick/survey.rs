//! All trees of a scene within a time limit: rounds in which each is visited once, without those that cannot win
//! any more.

use super::line::TotalTime;
use super::{Quick, QuickVisit};
use crate::bench::cell::Cell;
use crate::random::SplitMix64;
use std::time::{Duration, Instant};

/// Numbers of rays over which a tree may win.
pub const BUDGETS: [f64; 11] = [1e5, 3e5, 1e6, 3e6, 1e7, 3e7, 1e8, 3e8, 1e9, 3e9, 1e10];
/// A tree whose best visits are nowhere within these factors of the best tree is not measured again: after one
/// visit, which others may have disturbed, and after more.
const HOPELESS: [f64; 2] = [1.6, 1.2];
/// The note of such a tree.
pub const DROPPED: &str = "dropped";
/// Rounds before trees without a prospect have their turn.
const EARLY_ROUNDS: usize = 3;

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

/// Measures `candidates` by turns until `limit` has passed since `start`: first those with a prospect, the best
/// first, the others when there were some rounds of these or half the time is over. Tells `progress` the round and
/// the tree before each visit. The first visit is made whatever the time.
pub fn survey(
    quick: &mut Quick<'_>,
    candidates: &[Candidate],
    (start, limit): (Instant, Duration),
    progress: &mut dyn FnMut(usize, &Cell),
) -> Vec<Surveyed> {
    let none = |candidate: &Candidate| Surveyed {
        cell: candidate.cell.clone(),
        visits: Vec::new(),
        nodes_per_ray: None,
        note: String::new(),
    };
    let mut found: Vec<Surveyed> = candidates.iter().map(none).collect();
    let mut random = SplitMix64::new(1);
    let mut is_first = true;
    for round in 0.. {
        let has_turn = round >= EARLY_ROUNDS || 2 * start.elapsed() > limit;
        let takes_part = |i: &usize| found[*i].note.is_empty() && (has_turn || candidates[*i].has_prospect);
        let mut order: Vec<usize> = (0..found.len()).filter(takes_part).collect();
        if round > 0 {
            random.shuffle(&mut order);
        }
        let mut visited = 0;
        for i in order {
            let left = limit.saturating_sub(start.elapsed());
            let known = found[i].visits.first().map(|visit| visit.build_ms);
            // What is built in more than 60 ms is built once in a visit, unless others disturb it.
            let expected =
                Duration::from_secs_f64(1.2e-3 * known.unwrap_or(candidates[i].expected_ms).max(0.0));
            if !is_first && (left.is_zero() || expected > left) {
                continue;
            }
            is_first = false;
            progress(round, &found[i].cell);
            let is_new = found[i].visits.is_empty();
            let told = if is_new {
                quick.visit_and_count(&found[i].cell)
            } else {
                quick.visit(&found[i].cell).map(|visit| (visit, found[i].nodes_per_ray))
            };
            match told {
                Ok((visit, nodes)) => {
                    found[i].visits.push(visit);
                    found[i].nodes_per_ray = nodes;
                }
                Err(reason) => {
                    found[i].visits.clear();
                    found[i].note = reason;
                }
            }
            visited += 1;
        }
        if visited == 0 && has_turn || start.elapsed() >= limit {
            break;
        }
        drop_hopeless(&mut found);
    }
    for surveyed in found.iter_mut().filter(|one| one.visits.is_empty() && one.note.is_empty()) {
        surveyed.note = "no time".into();
    }
    found
}

/// Notes which trees are not measured again: those that are nowhere near the best. The best everywhere go on.
fn drop_hopeless(found: &mut [Surveyed]) {
    let lines: Vec<TotalTime> = found.iter().filter_map(|surveyed| TotalTime::of(&surveyed.visits)).collect();
    let best = BUDGETS.map(|rays| lines.iter().map(|line| line.at(rays)).fold(f64::INFINITY, f64::min));
    for surveyed in
        found.iter_mut().filter(|surveyed| !surveyed.visits.is_empty() && surveyed.note.is_empty())
    {
        let least =
            |figure: fn(&QuickVisit) -> f64| surveyed.visits.iter().map(figure).fold(f64::INFINITY, f64::min);
        let line = TotalTime::exact(least(|visit| visit.build_ms), least(|visit| visit.ns_per_ray));
        let factor = HOPELESS[surveyed.visits.len().min(HOPELESS.len()) - 1];
        if !BUDGETS.iter().zip(best).any(|(&rays, best)| line.at(rays) <= factor * best) {
            surveyed.note = DROPPED.into();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_without_a_prospect_are_dropped() {
        let of = |builder: &str, build_ms, ns_per_ray| Surveyed {
            cell: Cell::new(builder, 4, &[]),
            visits: vec![QuickVisit { build_ms, ns_per_ray }],
            nodes_per_ray: None,
            note: String::new(),
        };
        let mut found = [
            of("quick", 10.0, 200.0),
            of("good", 100.0, 100.0),
            of("near", 11.0, 201.0),
            of("bad", 400.0, 200.0),
            of("once", 100.0, 150.0),
            Surveyed {
                visits: vec![QuickVisit { build_ms: 100.0, ns_per_ray: 150.0 }; 2],
                ..of("twice", 0.0, 0.0)
            },
            Surveyed { visits: Vec::new(), note: "no time".into(), ..of("late", 0.0, 0.0) },
        ];
        drop_hopeless(&mut found);
        assert_eq!(found.map(|surveyed| surveyed.note), ["", "", "", DROPPED, "", DROPPED, "no time"]);
    }
}
