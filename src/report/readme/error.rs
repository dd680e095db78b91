//! Why a page cannot be brought up to date.

use crate::bench::files::RecordsError;

/// Why a text cannot be regenerated.
#[derive(Debug, thiserror::Error)]
pub enum ReadmeError {
    /// The rows cannot be read.
    #[error("line {line}: {source}")]
    Records {
        /// Line of the marker.
        line: usize,
        /// The cause.
        source: RecordsError,
    },
    /// A marker cannot be understood.
    #[error("line {line}: {reason}")]
    Marker {
        /// Its line.
        line: usize,
        /// The mistake, and the remedy.
        reason: String,
    },
    /// No marker at all: there would be nothing to check.
    #[error("no marker; write `<!-- table1: RESULTS -->` and `<!-- end -->` around the generated text")]
    None,
}
