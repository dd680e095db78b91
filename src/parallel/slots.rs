//! Values for tasks: each is put in once and taken once, by any thread.

use std::sync::Mutex;

/// Places of values.
pub(crate) struct Slots<T>(Vec<Mutex<Option<T>>>);

impl<T> Slots<T> {
    /// So many without a value.
    pub fn empty(len: usize) -> Self {
        Self((0..len).map(|_| Mutex::new(None)).collect())
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Takes the value at `index`, which nobody has taken yet.
    pub fn take(&self, index: usize) -> T {
        self.0[index].lock().expect("no task panics").take().expect("each value is taken once")
    }

    /// Puts a value at `index`.
    pub fn put(&self, index: usize, value: T) {
        *self.0[index].lock().expect("no task panics") = Some(value);
    }

    /// All values, each of which is there.
    pub fn into_values(self) -> impl Iterator<Item = T> {
        let value = |slot: Mutex<Option<T>>| slot.into_inner().expect("no task panics");
        self.0.into_iter().map(move |slot| value(slot).expect("there is a value in each place"))
    }
}

impl<T> FromIterator<T> for Slots<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Self(values.into_iter().map(|value| Mutex::new(Some(value))).collect())
    }
}
