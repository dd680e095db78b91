//! Errors in a builder's configuration.

use std::fmt::{Debug, Display};
use std::ops::RangeInclusive;

/// A parameter out of its range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} = {value} is out of range; give {}", range(.least, .most))]
pub struct ConfigError {
    /// The parameter, by its path in the configuration: `optimise.costs.leaf`.
    pub field: String,
    /// Its value.
    pub value: String,
    /// The least value that it may have.
    pub least: String,
    /// The greatest.
    pub most: String,
}

impl ConfigError {
    /// The same of a parameter that lies in the field `outer`.
    pub(crate) fn within(self, outer: &str) -> Self {
        Self { field: format!("{outer}.{}", self.field), ..self }
    }
}

fn range(least: &str, most: &str) -> String {
    if least == most { least.into() } else { format!("{least} to {most}") }
}

/// Refuses a value outside of `range`; NaN is outside of every range.
pub(crate) fn check<T: PartialOrd + Display + Debug>(
    field: &'static str,
    value: T,
    range: RangeInclusive<T>,
) -> Result<(), ConfigError> {
    if range.contains(&value) {
        return Ok(());
    }
    let text = |value: &T| format!("{value:?}");
    Err(ConfigError {
        field: field.into(),
        value: text(&value),
        least: text(range.start()),
        most: text(range.end()),
    })
}

/// As [`check`], of a parameter that may be absent.
pub(crate) fn check_option<T: PartialOrd + Display + Debug>(
    field: &'static str,
    value: Option<T>,
    range: RangeInclusive<T>,
) -> Result<(), ConfigError> {
    value.map_or(Ok(()), |value| check(field, value, range))
}
