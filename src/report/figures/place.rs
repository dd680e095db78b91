//! A place in a table: a figure, or why there is none.

/// A place in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place<T> {
    /// A figure.
    Value(T),
    /// The builder failed, its hits were wrong, or the kernel could not have the tree: the row says why.
    Failed,
    /// Not measured.
    Missing,
}

impl<T> Place<T> {
    /// The figure.
    pub fn value(self) -> Option<T> {
        match self {
            Self::Value(value) => Some(value),
            Self::Failed | Self::Missing => None,
        }
    }

    /// Another figure of the same place; missing if there is none.
    pub fn and_then<U>(self, figure: impl FnOnce(T) -> Option<U>) -> Place<U> {
        match self {
            Self::Value(value) => figure(value).map_or(Place::Missing, Place::Value),
            Self::Failed => Place::Failed,
            Self::Missing => Place::Missing,
        }
    }

    /// As a cell: the figure, `error` or `-`.
    pub fn cell(self, show: impl FnOnce(T) -> String) -> String {
        match self {
            Self::Value(value) => show(value),
            Self::Failed => "error".into(),
            Self::Missing => "-".into(),
        }
    }
}
