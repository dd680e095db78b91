//! The upper part of a recursion, divided in parallel down to tasks that one thread each completes.

use super::slots::Slots;

/// A tree over tasks of type `T`.
pub(crate) enum TaskTree<T> {
    /// What one thread does.
    Task(T),
    /// The parts of a division, in order; there may be none.
    Node(Vec<Self>),
}

/// What becomes of a part of the work, of type `P`.
pub(crate) enum Division<P, T = P> {
    /// It is small enough for one thread.
    Task(T),
    /// It is divided into these.
    Parts(Vec<P>),
}

impl<T: Send> TaskTree<T> {
    /// Divides `root` by `divide` until only tasks are left, parts in parallel.
    pub fn grow<P: Send>(root: P, divide: &(impl Fn(P) -> Division<P, T> + Sync)) -> Self {
        match divide(root) {
            Division::Task(task) => Self::Task(task),
            Division::Parts(parts) => Self::Node(super::map(parts, |part| Self::grow(part, divide))),
        }
    }

    /// Moves the tasks to an array, depth first, and leaves their indices.
    pub fn number(self) -> (TaskTree<usize>, Slots<T>) {
        let mut tasks = Vec::new();
        let tree = self.number_into(&mut tasks);
        (tree, tasks.into_iter().collect())
    }

    fn number_into(self, tasks: &mut Vec<T>) -> TaskTree<usize> {
        match self {
            Self::Task(task) => {
                tasks.push(task);
                TaskTree::Task(tasks.len() - 1)
            }
            Self::Node(parts) => {
                TaskTree::Node(parts.into_iter().map(|part| part.number_into(tasks)).collect())
            }
        }
    }
}

impl TaskTree<usize> {
    /// Joins the results of the tasks bottom-up, parts before what they are part of.
    pub fn fold<R: Copy>(&self, results: &[R], join: &mut impl FnMut(&[R]) -> R) -> R {
        match self {
            Self::Task(index) => results[*index],
            Self::Node(parts) => {
                let parts: Vec<R> = parts.iter().map(|part| part.fold(results, join)).collect();
                join(&parts)
            }
        }
    }
}
