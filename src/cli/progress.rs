//! One line of progress on a terminal; silent elsewhere.

use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};

use crate::pipeline::Progress;

/// A progress line on standard error.
pub struct ProgressLine {
    shown: bool,
    last: Option<Instant>,
    drawn: bool,
}

impl ProgressLine {
    /// A line that is shown only on a terminal, and not when quiet.
    pub fn new(quiet: bool) -> Self {
        Self { shown: !quiet && stderr().is_terminal(), last: None, drawn: false }
    }

    /// Shows where the work stands, at most ten times a second.
    pub fn show(&mut self, progress: Progress) {
        let recent = self.last.is_some_and(|last| last.elapsed() < Duration::from_millis(100));
        if !self.shown || (progress.step.is_some() && recent) {
            return;
        }
        self.last = Some(Instant::now());
        self.drawn = true;
        let step =
            progress.step.map_or(String::new(), |(i, energy)| format!(": step {i}, energy {energy:.2e}"));
        // A terminal that has gone away must not stop the work.
        let _ = write!(stderr(), "\r\x1b[K{}{step}", progress.stage);
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if self.drawn {
            let _ = write!(stderr(), "\r\x1b[K");
        }
    }
}
