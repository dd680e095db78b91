//! Verbs that print or renew what pages show, and write a run as one HTML file.

mod made_of_rows;
pub mod readme;
pub mod report;
pub mod table;

pub use made_of_rows::made_of_rows;
