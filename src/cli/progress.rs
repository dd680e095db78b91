//! A progress bar with the time left, on stderr and at a terminal only.

use super::output::say;
use crate::bench::row::Row;
use crate::bench::run::Progress;
use crate::report::table;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Shows the progress of a run; prints each scene's table to standard output when the scene is done.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar, hidden in a pipe.
    pub fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr());
        let template = "{elapsed_precise} [{bar:24}] {percent:>3} %, {eta} left; {wide_msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.enable_steady_tick(Duration::from_secs(1));
        Self(bar)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&mut self, total: u64) {
        self.0.set_length(total);
    }

    fn at(&mut self, doing: &str) {
        self.0.set_message(doing.to_owned());
    }

    fn advance(&mut self, units: u64) {
        self.0.inc(units);
    }

    fn note(&mut self, text: &str) {
        self.0.suspend(|| eprintln!("phr: {text}"));
    }

    fn scene(&mut self, rows: &[Row]) {
        // The table is also written to table1.md: a closed standard output does not end a long run.
        let Some(row) = rows.first() else { return };
        self.0.suspend(|| say(&(table::scene(rows, &row.scene) + "\n")).unwrap_or_default());
    }
}

/// Shows what a command is doing, in a line on stderr and at a terminal only.
pub struct Steps {
    bar: ProgressBar,
    of: String,
}

impl Steps {
    /// The steps of something, hidden in a pipe.
    pub fn new(of: &str) -> Self {
        let bar =
            if std::io::stderr().is_terminal() { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, of: of.into() }
    }

    /// Now doing this.
    pub fn at(&self, doing: &str) {
        self.bar.set_message(format!("{}: {doing}", self.of));
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
