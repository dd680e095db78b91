//! How long recorded steps take on so many workers, of which each takes the task that waits longest: a greedy
//! schedule, at most twice as long as the best (Graham, "Bounds on multiprocessing timing anomalies", 1969). Tasks
//! take as long as they took one thread alone: caches, memory and the clock are shared on a real machine.

use crate::parallel::timeline::Step;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// Seconds of work in all.
pub fn work(steps: &[Step]) -> f64 {
    steps
        .iter()
        .map(|step| match step {
            Step::Work(seconds) => *seconds,
            Step::Fork(tasks) => tasks.iter().map(|task| work(task)).sum(),
            Step::Phase(_) => 0.0,
        })
        .sum()
}

/// Seconds of the critical path: what no number of workers shortens.
pub fn span(steps: &[Step]) -> f64 {
    steps
        .iter()
        .map(|step| match step {
            Step::Work(seconds) => *seconds,
            Step::Fork(tasks) => tasks.iter().map(|task| span(task)).fold(0.0, f64::max),
            Step::Phase(_) => 0.0,
        })
        .sum()
}

/// A run that has begun: its next steps, and the run that waits for it.
struct Run<'a> {
    rest: &'a [Step],
    parent: Option<usize>,
    /// Tasks that it waits for.
    awaited: usize,
}

/// Seconds on `workers` workers, at least one.
pub fn schedule(steps: &[Step], workers: usize) -> f64 {
    let mut runs = vec![Run { rest: steps, parent: None, awaited: 0 }];
    let mut ready = VecDeque::from([0]);
    // Bits of non-negative floats are in their order.
    let mut busy: BinaryHeap<Reverse<(u64, usize)>> = BinaryHeap::new();
    let mut now = 0.0;
    loop {
        while busy.len() < workers.max(1)
            && let Some(index) = ready.pop_front()
        {
            advance(&mut runs, index, now, &mut ready, &mut busy);
        }
        let Some(Reverse((end, index))) = busy.pop() else { return now };
        now = f64::from_bits(end);
        // Whoever worked goes on.
        ready.push_front(index);
    }
}

/// Lets a run go on until it works, waits or ends.
fn advance<'a>(
    runs: &mut Vec<Run<'a>>,
    index: usize,
    now: f64,
    ready: &mut VecDeque<usize>,
    busy: &mut BinaryHeap<Reverse<(u64, usize)>>,
) {
    while let Some((first, rest)) = runs[index].rest.split_first() {
        runs[index].rest = rest;
        match first {
            Step::Phase(_) => {}
            Step::Work(seconds) => {
                busy.push(Reverse(((now + seconds).to_bits(), index)));
                return;
            }
            Step::Fork(tasks) if tasks.is_empty() => {}
            Step::Fork(tasks) => {
                runs[index].awaited = tasks.len();
                for task in tasks {
                    ready.push_back(runs.len());
                    runs.push(Run { rest: task, parent: Some(index), awaited: 0 });
                }
                return;
            }
        }
    }
    if let Some(parent) = runs[index].parent {
        runs[parent].awaited -= 1;
        if runs[parent].awaited == 0 {
            ready.push_front(parent);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tasks(seconds: &[f64]) -> Step {
        Step::Fork(seconds.iter().map(|&seconds| vec![Step::Work(seconds)]).collect())
    }

    #[test]
    fn a_fork_takes_as_long_as_its_busiest_worker() {
        let steps = [Step::Work(1.0), tasks(&[2.0, 1.0, 3.0, 2.0]), Step::Phase("a"), Step::Work(0.5)];
        assert_eq!((work(&steps), span(&steps)), (9.5, 4.5));
        assert_eq!(schedule(&steps, 1), 9.5);
        // 2 and 2, 1 and 3.
        assert_eq!(schedule(&steps, 2), 5.5);
        assert_eq!(schedule(&steps, 4), 4.5);
        assert_eq!(schedule(&steps, 64), 4.5);
        assert_eq!(schedule(&[], 3), 0.0);
        assert_eq!(schedule(&[tasks(&[])], 3), 0.0);
    }

    #[test]
    fn forks_in_tasks_share_the_workers() {
        let inner = vec![Step::Work(1.0), tasks(&[1.0, 1.0]), Step::Work(1.0)];
        let steps = [Step::Fork(vec![inner.clone(), inner])];
        assert_eq!((work(&steps), span(&steps)), (8.0, 3.0));
        assert_eq!(schedule(&steps, 1), 8.0);
        // The best takes 4: a greedy worker does not wait for the task that others wait for.
        assert_eq!(schedule(&steps, 2), 5.0);
        assert_eq!(schedule(&steps, 4), 3.0);
    }

    #[test]
    fn no_schedule_beats_the_bounds() {
        let mut random = crate::random::SplitMix64::new(3);
        for _ in 0..200 {
            let steps = grown(&mut random, 4);
            for workers in [1, 2, 3, 16, 1000] {
                let time = schedule(&steps, workers);
                let least = span(&steps).max(work(&steps) / workers as f64);
                let most = span(&steps) + work(&steps) / workers as f64;
                assert!(
                    time >= least * (1.0 - 1e-12) && time <= most * (1.0 + 1e-12),
                    "{least} {time} {most}"
                );
            }
        }
    }

    fn grown(random: &mut crate::random::SplitMix64, levels: usize) -> Vec<Step> {
        let step = |random: &mut crate::random::SplitMix64| match random.below(3) {
            0 if levels > 0 => Step::Fork((0..random.below(4)).map(|_| grown(random, levels - 1)).collect()),
            1 => Step::Phase("p"),
            _ => Step::Work(f64::from(random.unit())),
        };
        (0..random.below(5)).map(|_| step(random)).collect()
    }
}
