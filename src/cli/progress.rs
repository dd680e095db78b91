//! A progress bar with the time left, on stderr and at a terminal only.

use super::note::note;
use super::output::say;
use crate::bench::row::Row;
use crate::bench::run::Progress;
use crate::report::table::{brief, details};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Shows the progress of a run; prints each scene's table to standard output when the scene is done.
pub struct Bar {
    bar: ProgressBar,
    scene: fn(&[Row], &str) -> String,
}

impl Bar {
    /// A bar, hidden in a pipe; with `all_columns`, scenes' tables have every regime and kernel.
    pub fn new(all_columns: bool) -> Self {
        let scene = if all_columns { details::scene } else { brief::scene };
        if !std::io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden(), scene };
        }
        let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr());
        let template = "{elapsed_precise} [{bar:24}] {percent:>3} %, {eta} left; {wide_msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.enable_steady_tick(Duration::from_secs(1));
        Self { bar, scene }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&mut self, total: u64) {
        self.bar.set_length(total);
    }

    fn at(&mut self, doing: &str) {
        self.bar.set_message(doing.to_owned());
    }

    fn advance(&mut self, units: u64) {
        self.bar.inc(units);
    }

    fn note(&mut self, text: &str) {
        self.bar.suspend(|| note(text));
    }

    fn scene(&mut self, rows: &[Row]) {
        // The table is also written to table1.md: a closed standard output does not end a long run.
        let Some(row) = rows.first() else { return };
        self.bar.suspend(|| say(&((self.scene)(rows, &row.scene) + "\n")).unwrap_or_default());
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
