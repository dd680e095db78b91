//! Fits a model with given facts: ridge regression of logarithms, the constant left free.

use super::facts::Fact;
use super::observed::{KERNEL, Observed};
use super::{Fitted, Model, SCHEMA, Scale, TreeModel};
use crate::bench::quick::line::TotalTime;
use crate::bench::statistics::{arithmetic_mean, figures, student95};

/// A model of some scenes, one at least, by `facts`; its errors are those in each scene left out in its turn.
pub fn fit(scenes: &[&Observed], facts: &[Fact], ridge: f64) -> Model {
    let mut model = weights(scenes, facts, ridge);
    let residuals: Vec<Vec<[f64; 2]>> = (0..scenes.len())
        .map(|out| {
            let others: Vec<&Observed> =
                scenes.iter().enumerate().filter(|(i, _)| *i != out).map(|(_, scene)| *scene).collect();
            let lines = weights(&others, facts, ridge).lines(&scenes[out].facts);
            let pairs = lines.iter().zip(&scenes[out].lines);
            pairs
                .map(|(of_model, seen)| FIGURES.map(|figure| (figure(of_model) / figure(seen)).ln()))
                .collect()
        })
        .collect();
    let reach = student95(scenes.len().saturating_sub(1));
    for (i, tree) in model.trees.iter_mut().enumerate() {
        let error = |figure: usize| {
            let squares: Vec<f64> = residuals.iter().map(|scene| scene[i][figure].powi(2)).collect();
            figures(reach * arithmetic_mean(&squares).unwrap_or(f64::INFINITY).sqrt())
        };
        (tree.build.error, tree.ray.error) = (error(0), error(1));
    }
    model
}

const FIGURES: [fn(&TotalTime) -> f64; 2] = [|line| line.build_ms.value, |line| line.ns_per_ray.value];

/// The weights alone; errors are 0.
pub fn weights(scenes: &[&Observed], facts: &[Fact], ridge: f64) -> Model {
    let logs = |fact: Fact| -> Vec<f64> { scenes.iter().map(|scene| scene.facts.log(fact)).collect() };
    let scale = |&fact: &Fact| {
        let logs = logs(fact);
        let mean = arithmetic_mean(&logs).unwrap_or_default();
        let squares: Vec<f64> = logs.iter().map(|log| (log - mean).powi(2)).collect();
        let deviation = arithmetic_mean(&squares).unwrap_or_default().sqrt().max(1e-3);
        Scale { fact, mean: figures(mean), deviation: figures(deviation) }
    };
    let scales: Vec<Scale> = facts.iter().map(scale).collect();
    let mut model = Model {
        schema: SCHEMA,
        run_id: String::new(),
        kernel: KERNEL.into(),
        threads: 0,
        scenes: scenes.len(),
        ridge,
        facts: scales,
        size: Some(scale(&Fact::Triangles)),
        trees: Vec::new(),
    };
    let inputs: Vec<Vec<f64>> = scenes.iter().map(|scene| model.scaled(&scene.facts)).collect();
    let fitted = |value: &dyn Fn(&Observed) -> f64| {
        let outputs: Vec<f64> = scenes.iter().map(|scene| value(scene).ln()).collect();
        Fitted { weights: solve(&inputs, &outputs, ridge).into_iter().map(figures).collect(), error: 0.0 }
    };
    let Some(first) = scenes.first() else { return model };
    let tree = |(i, (builder, width)): (usize, &(String, u32))| TreeModel {
        builder: builder.clone(),
        width: *width,
        build: fitted(&|scene| 1e6 * scene.lines[i].build_ms.value / scene.facts.triangles),
        ray: fitted(&|scene| scene.lines[i].ns_per_ray.value),
    };
    model.trees = first.trees.iter().enumerate().map(tree).collect();
    model
}

/// The weights of least squared error plus `ridge` per scene times the squares of all weights but the first: the normal
/// equations, by elimination.
fn solve(inputs: &[Vec<f64>], outputs: &[f64], ridge: f64) -> Vec<f64> {
    let n = inputs.first().map_or(0, Vec::len);
    let held = ridge * inputs.len() as f64;
    let sum = |f: &dyn Fn(usize) -> f64| (0..inputs.len()).map(f).sum::<f64>();
    let mut matrix: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut line: Vec<f64> = (0..n).map(|j| sum(&|s| inputs[s][i] * inputs[s][j])).collect();
            line[i] += if i > 0 { held } else { 0.0 };
            line.push(sum(&|s| inputs[s][i] * outputs[s]));
            line
        })
        .collect();
    // Positive definite for a positive ridge: no pivot is zero.
    for pivot in 0..n {
        for row in 0..n {
            if row != pivot {
                let (factor, eliminated) = (matrix[row][pivot] / matrix[pivot][pivot], matrix[pivot].clone());
                matrix[row].iter_mut().zip(&eliminated).skip(pivot).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    (0..n).map(|i| matrix[i][n] / matrix[i][i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_found_and_held_down() {
        let inputs: Vec<Vec<f64>> =
            (0..9).map(|i| vec![1.0, f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0]).collect();
        let outputs: Vec<f64> = inputs.iter().map(|x| 5.0 + 2.0 * x[1] - 3.0 * x[2]).collect();
        let near = |found: Vec<f64>, expected: [f64; 3]| {
            found.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-6, "{found:?}"));
        };
        near(solve(&inputs, &outputs, 1e-9), [5.0, 2.0, -3.0]);
        // The inputs' mean square is 2 / 3: a ridge of 2 / 3 halves the weights, and leaves the constant.
        near(solve(&inputs, &outputs, 2.0 / 3.0), [5.0, 1.0, -1.5]);
    }
}
