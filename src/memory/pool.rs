//! Buffers kept from build to build: fresh memory costs page faults.

use std::sync::Mutex;

/// A pool of buffers that tasks borrow.
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Default> Pool<T> {
    /// A buffer used before, or a new one.
    pub fn take(&self) -> T {
        self.0.lock().expect("no task panics").pop().unwrap_or_default()
    }

    /// Keeps `buffer` for the next task.
    pub fn put(&self, buffer: T) {
        self.0.lock().expect("no task panics").push(buffer);
    }

    /// Calls `f` on every buffer in the pool.
    pub fn for_each(&self, f: impl FnMut(&mut T)) {
        self.0.lock().expect("no task panics").iter_mut().for_each(f);
    }
}
