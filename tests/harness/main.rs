//! The benchmark and its commands as their users meet them: runs, records, reports, advice, experiments. One
//! program, since each takes seconds to link.
#![cfg(feature = "harness")]

mod advice;
mod by_hand;
mod cli;
mod cut_files;
mod experiments;
#[cfg(unix)]
mod faults;
mod fuzzed;
#[cfg(feature = "peers")]
mod peers;
mod reports;
mod shards;
mod targets;
