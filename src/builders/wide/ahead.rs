//! Binary splits made ahead of the wide nodes that they belong to.
//!
//! Which child of a wide node is opened next (paper 4.5) is known only when the last one has been split. If wide nodes
//! were made from the root down, one thread alone would make the splits of the topmost ones, which are those of the
//! longest cuts. But a part that is too large for a task is split whatever node it ends in. So all such parts are split
//! first, both sides in parallel, and then collapsed.

use super::open_largest::{Priority, open_largest, replace};
use super::parallel::ParallelBuild;
use super::top_down::BinarySplits;
use crate::parallel;
use crate::parallel::task_tree::{Division, TaskTree};
use arrayvec::ArrayVec;

/// An unbuilt subtree, a `T`, split as long as it is too large for a task.
struct Ahead<T> {
    /// As a child of a wide node.
    priority: Priority,
    state: State<T>,
}

enum State<T> {
    /// Too large for a task.
    Unsplit(T),
    /// The sides of its split: two, or fewer where one was clipped away or the part turned out to be a leaf.
    Split(Vec<Ahead<T>>),
    /// A task.
    Task(T),
}

impl<T: BinarySplits> ParallelBuild<'_, T> {
    /// The tasks below `root`, collapsed to nodes of up to `N` children: the largest is split first (paper 4.5).
    pub fn split_tasks<const N: usize>(&self, root: T::Task) -> TaskTree<T::Task> {
        let root = self.with_part(root, |part, worker| self.ahead(part, &worker.scratch));
        TaskTree::grow(self.split_ahead(root), &|Ahead { priority, state }| {
            if let State::Task(task) = state {
                return Division::Task(task);
            }
            let mut children = ArrayVec::<_, N>::new();
            children.push(Ahead { priority, state });
            open_largest(
                &mut children,
                |child| child.priority,
                |children, next| {
                    let mut sides = self.sides(&mut children[next].state).into_iter();
                    match [sides.next(), sides.next()] {
                        [Some(left), Some(right)] => replace(children, next, [left, right]),
                        [Some(only), _] => children[next] = only,
                        [None, _] => drop(children.remove(next)),
                    }
                    Some(())
                },
            );
            Division::Parts(children.into_iter().collect())
        })
    }

    /// A part as it is before it is split.
    fn ahead(&self, part: &T::Part, scratch: &T::Scratch) -> Ahead<T::Task> {
        let task = self.builder.export(part, scratch);
        Ahead {
            priority: Priority::new(self.builder.kind(part), self.builder.half_area(part)),
            state: if self.is_task(part) { State::Task(task) } else { State::Unsplit(task) },
        }
    }

    /// Splits a part down to tasks, both sides in parallel.
    fn split_ahead(&self, Ahead { priority, mut state }: Ahead<T::Task>) -> Ahead<T::Task> {
        if let State::Unsplit(_) = state {
            let sides = self.sides(&mut state);
            state = State::Split(parallel::map(sides, |side| self.split_ahead(side)));
        }
        Ahead { priority, state }
    }

    /// Takes the sides of a split, which is made now if it has not been.
    fn sides(&self, state: &mut State<T::Task>) -> Vec<Ahead<T::Task>> {
        match std::mem::replace(state, State::Split(Vec::new())) {
            State::Split(sides) => sides,
            State::Unsplit(task) | State::Task(task) => self.with_part(task, |part, worker| {
                let sides = self.builder.split(part, &mut worker.scratch);
                sides.iter().flatten().map(|side| self.ahead(side, &worker.scratch)).collect()
            }),
        }
    }
}
