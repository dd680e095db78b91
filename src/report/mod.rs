//! Reports from the rows of a run.
//!
//! * [`figures`] looks up the figures of a scene and tree, [`means`] averages them over scenes,
//!   [`interval`](figures::interval) tells how sure they are, [`paper`] has the paper's own; [`grid`] lays out a table;
//! * [`table`] is the document of a run: [`table1`](table::table1) in the paper's arrangement, means,
//!   [`details`](table::details) of every scene;
//! * [`verdict`] answers in three sentences which tree to take;
//! * [`summary`], [`evidence`], [`targets`], [`ablation`], [`kernels`] and [`scaling`] are tables of their own,
//!   [`compare`] judges one run against another, [`by_turns`](compare::by_turns) one program;
//!   [`machines`](compare::machines) has unlike ones side by side;
//! * [`advice`] tells which builder for a scene and a number of rays, and with which parameters;
//! * [`readme`] keeps the tables within Markdown pages up to date; [`plot`] draws, and [`page`] makes a page of it all.

pub mod ablation;
pub mod advice;
pub mod compare;
pub mod evidence;
pub mod figures;
pub mod grid;
pub mod kernels;
pub mod means;
pub mod page;
pub mod paper;
pub mod plot;
pub mod readme;
pub mod table;
pub mod targets;
pub mod verdict;

pub use evidence::{scaling, summary};
