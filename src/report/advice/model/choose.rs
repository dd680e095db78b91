//! Chooses facts and ridge by the loss of advice for scenes left out, and fits the model of a run.

use super::Model;
use super::facts::Fact;
use super::fit::{fit, weights};
use super::judge::{leave_one_out, loss};
use super::observed::{Observed, observed};
use crate::bench::row::Row;

/// Strengths that are tried.
const RIDGES: [f64; 5] = [0.1, 0.3, 1.0, 3.0, 10.0];

/// What a model is made with.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The facts.
    pub facts: Vec<Fact>,
    /// The ridge.
    pub ridge: f64,
}

/// The choice of least loss, of equal ones that of fewer facts.
pub fn choose(scenes: &[Observed]) -> Choice {
    let subset = |bits: usize| -> Vec<Fact> {
        Fact::ALL.into_iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1).map(|(_, fact)| fact).collect()
    };
    let mut subsets: Vec<Vec<Fact>> = (0..1 << Fact::ALL.len()).map(subset).collect();
    subsets.sort_by_key(Vec::len);
    let mut best = (f64::INFINITY, Choice { facts: Vec::new(), ridge: 1.0 });
    for facts in subsets {
        for ridge in RIDGES {
            let found = loss(&leave_one_out(scenes, &|others| weights(others, &facts, ridge)));
            if found < best.0 - 1e-9 {
                best = (found, Choice { facts: facts.clone(), ridge });
            }
        }
    }
    best.1
}

/// The model of a run.
///
/// # Errors
/// Too few scenes, in one line.
pub fn model_of(rows: &[Row]) -> Result<Model, String> {
    let scenes = observed(rows);
    if scenes.len() < 3 || scenes.iter().any(|scene| scene.trees.is_empty()) {
        let count = scenes.len();
        return Err(format!(
            "{count} scenes with lbvh and all trees under embree-grafted; a model needs 3, run `phr bench` with more"
        ));
    }
    let Choice { facts, ridge } = choose(&scenes);
    let model = fit(&scenes.iter().collect::<Vec<_>>(), &facts, ridge);
    let run_id = rows.first().map_or_else(String::new, |row| row.run_id.clone());
    let threads = rows.iter().map(|row| row.threads).max().unwrap_or_default();
    Ok(Model { run_id, threads, ..model })
}
