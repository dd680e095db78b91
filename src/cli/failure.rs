//! Why a command did not succeed, and the exit code that says so.

use super::note::note;
use std::process::ExitCode;

/// Why a command did not succeed.
#[derive(Debug)]
pub enum Failure {
    /// The input cannot be used, or the output not be written: exit code 2.
    Bad(String),
    /// Hits are wrong, a builder failed, a comparison or a check did: exit code 1.
    Wrong(String),
    /// A comparison decides nothing: exit code 3.
    Inconclusive(String),
    /// Stopped by the user: exit code 130.
    Interrupted(String),
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Bad(error.to_string())
    }
}

impl Failure {
    /// Prints the reason in one line on stderr.
    pub fn report(self) -> ExitCode {
        let (text, code) = match self {
            Self::Bad(text) => (text, 2),
            Self::Wrong(text) => (text, 1),
            Self::Inconclusive(text) => (text, 3),
            Self::Interrupted(text) => (text, 130),
        };
        // One line, whatever a library wrote into its message.
        note(&text.split_whitespace().collect::<Vec<_>>().join(" "));
        ExitCode::from(code)
    }
}
