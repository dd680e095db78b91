//! Verbs that print or renew what pages show.

pub mod readme;
pub mod table;
