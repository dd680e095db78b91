//! Verbs that print or renew what pages show, and write a run as one HTML file.

pub mod readme;
pub mod report;
pub mod table;
