//! Where the work stands: one line on a terminal, events for machines, or nothing.

use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};

use super::{Failure, events, interrupt};
use crate::pipeline::{Clock, Event, Progress};
use crate::solver::Step;

/// What is told on the way.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Reporting {
    /// Print errors only.
    #[arg(short, long)]
    pub quiet: bool,
    /// Print events for machines on standard output, one JSON object per line: stage, step, result, error.
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
}

/// Does work that tells where it stands, and that a signal asks to stop. Its line is gone from the terminal afterwards.
///
/// # Errors
/// Those of the work.
pub fn watched<T>(
    reporting: &Reporting,
    work: impl FnOnce(&mut Clock) -> Result<T, Failure>,
) -> Result<T, Failure> {
    interrupt::listen();
    let mut reporter = Reporter::new(reporting);
    let mut watch = |progress: &Progress| {
        reporter.show(progress);
        interrupt::flow()
    };
    work(&mut Clock::new(&mut watch))
}

/// Tells where the work stands.
pub struct Reporter {
    json: bool,
    /// Whether there is a line on standard error.
    line: bool,
    start: Instant,
    stage_start: Instant,
    /// Steps of the present stage so far.
    made: usize,
    last_drawn: Option<Instant>,
}

impl Reporter {
    /// A line only on a terminal, and not when quiet or for machines.
    pub fn new(reporting: &Reporting) -> Self {
        let now = Instant::now();
        Self {
            json: reporting.json,
            line: !reporting.quiet && !reporting.json && stderr().is_terminal(),
            start: now,
            stage_start: now,
            made: 0,
            last_drawn: None,
        }
    }

    /// Tells of the progress; the line is redrawn at most ten times a second.
    pub fn show(&mut self, progress: &Progress) {
        if self.json {
            events::progress(progress, self.start.elapsed().as_secs_f64());
        }
        if !self.line {
            return;
        }
        let text = match progress.event {
            Event::End(_) => return,
            Event::Start => {
                self.stage_start = Instant::now();
                self.made = 0;
                progress.stage.to_owned()
            }
            Event::Step(step) => {
                self.made += usize::from(step.iteration > 0);
                if self.last_drawn.is_some_and(|last| last.elapsed() < Duration::from_millis(100)) {
                    return;
                }
                let (stage, so_far) = (self.stage_start.elapsed(), self.start.elapsed());
                let bar = bar(self.made, step.limit - step.iteration + step.later);
                format!("{bar} {}: {}", progress.stage, step_text(&step, self.made, stage, so_far))
            }
        };
        self.draw(&text);
    }

    /// Tells what is being done where no steps are counted.
    pub fn say(&mut self, what: &str) {
        if self.line {
            self.draw(what);
        }
    }

    fn draw(&mut self, text: &str) {
        self.last_drawn = Some(Instant::now());
        // A terminal that has gone away must not stop the work.
        let _ = write!(stderr(), "\r\x1b[K{text}");
    }
}

impl Drop for Reporter {
    fn drop(&mut self) {
        if self.last_drawn.is_some() {
            let _ = write!(stderr(), "\r\x1b[K");
        }
    }
}

/// A bar that is filled when as many steps were made as may be.
fn bar(made: usize, left: usize) -> String {
    let filled = BAR * made / (made + left).max(1);
    format!("[{}{}]", "#".repeat(filled), ".".repeat(BAR - filled))
}

/// Length of the bar, characters.
const BAR: usize = 20;

/// The line at a step: `made` steps took the time `stage`, all so far took `so_far`. What is left is
/// estimated as if every phase needed all the steps that it may make, and each took as long as those of this
/// stage.
fn step_text(step: &Step, made: usize, stage: Duration, so_far: Duration) -> String {
    let energy: f64 = step.energies.iter().sum();
    let mut text = format!("step {} of at most {}", step.iteration, step.limit);
    if step.later > 0 {
        text += &format!(" (then at most {})", step.later);
    }
    text += &format!(", energy {energy:.2e}, {}", duration(so_far.as_secs_f64()));
    if made > 0 {
        let left = (step.limit - step.iteration + step.later) as f64;
        text += &format!(", at most {} left", duration(left * stage.as_secs_f64() / made as f64));
    }
    text
}

/// Seconds in words of a few letters.
fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_that_of_all_steps_that_may_come() {
        let terms = ["a".to_owned(), "b".to_owned()];
        let step =
            Step { phase: 1, iteration: 2, limit: 12, later: 40, terms: &terms, energies: &[0.5, 0.25] };
        let text = step_text(&step, 4, Duration::from_secs(8), Duration::from_secs(71));
        assert_eq!(
            text,
            "step 2 of at most 12 (then at most 40), energy 7.50e-1, 1 min 11 s, at most 1 min 40 s left"
        );
        let first = Step { iteration: 0, later: 0, ..step };
        let text = step_text(&first, 0, Duration::from_secs(8), Duration::from_secs(8));
        assert_eq!(text, "step 0 of at most 12, energy 7.50e-1, 8 s");
        assert_eq!(duration(2.0 * 3600.0 + 65.0), "2 h 1 min");
        assert_eq!([bar(0, 0), bar(1, 3), bar(7, 0)].map(|bar| bar.matches('#').count()), [0, 5, 20]);
        assert_eq!(bar(1, 3).len(), 22);
    }
}
