//! What is wrong with a changed builder, in one line with the remedy.

use crate::builders::registry::NAMES;

/// Why a builder cannot be changed so.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RecipeError {
    /// Not one of ours.
    #[error("no builder of ours is called {}; there are {known}", .0.escape_debug(), known = known())]
    NoSuchBuilder(String),
    /// Neither `BUILDER.FIELD=VALUE` nor `BUILDER[FIELD=VALUE]`.
    #[error("{}: write BUILDER.FIELD=VALUE, or as a name BUILDER[FIELD=VALUE+FIELD=VALUE]", .0.escape_debug())]
    Malformed(String),
    /// No field of that name, or several.
    #[error("{builder} has no single field {}; {}", field.escape_debug(), has(builder, known))]
    Field {
        /// The builder.
        builder: &'static str,
        /// The name given.
        field: String,
        /// The builder's fields.
        known: String,
    },
    /// A value of another kind, or out of range.
    #[error("{builder}.{}: {}", on_a_line(change), on_a_line(reason))]
    Value {
        /// The builder.
        builder: &'static str,
        /// The field and its value.
        change: String,
        /// What is wrong, and what it may be.
        reason: String,
    },
}

/// `text`, which may quote a value, without line breaks and the like.
fn on_a_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

fn known() -> String {
    format!("{}, and variants of these", NAMES.join(", "))
}

fn has(builder: &str, known: &str) -> String {
    if known.is_empty() { format!("{builder} has none") } else { format!("its fields are {known}") }
}
