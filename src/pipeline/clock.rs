//! What accompanies a job: times, progress, the wish to stop, and the journal of the optimisation.

use std::ops::ControlFlow;
use std::time::Instant;

use super::{Partial, PipelineError};
use crate::solver::{Journal, Run, Step};

/// Where the work stands.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Name of the stage.
    pub stage: &'static str,
    /// What happens in it.
    pub event: Event<'a>,
}

/// What happens in a stage.
#[derive(Debug, Clone, Copy)]
pub enum Event<'a> {
    /// It begins.
    Start,
    /// The solver stands at a step.
    Step(Step<'a>),
    /// It is over; wall-clock seconds.
    End(f64),
}

/// Follows the work, and may ask it to stop.
pub type Watch<'a> = dyn FnMut(&Progress) -> ControlFlow<()> + 'a;

/// Wall-clock seconds of each stage, in the order they ran.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timings(pub Vec<(&'static str, f64)>);

/// Runs stages: keeps their times, tells of them, and knows whether somebody wants the work to stop.
pub struct Clock<'a> {
    /// Seconds so far.
    pub timings: Timings,
    /// The minimisations of the optimisation: those of earlier work before, all of them afterwards.
    pub journal: Journal,
    /// Bytes of memory that the optimisation may take; `None` where that is not to be checked.
    pub memory: Option<u64>,
    watch: &'a mut Watch<'a>,
    stopping: bool,
}

impl<'a> Clock<'a> {
    /// A clock that reports to `watch` and stops where that says so.
    pub fn new(watch: &'a mut Watch<'a>) -> Self {
        Self {
            timings: Timings::default(),
            journal: Journal::default(),
            memory: None,
            watch,
            stopping: false,
        }
    }

    /// Runs a stage, handing it what its minimisations need.
    pub fn run<T>(&mut self, stage: &'static str, work: impl FnOnce(&mut Run) -> T) -> T {
        let mut stopping = self.stopping;
        let mut tell = |event: Event| {
            let flow = (self.watch)(&Progress { stage, event });
            stopping |= flow.is_break();
            flow
        };
        // The answer is kept: the work is asked by `go_on` whether it has to stop.
        let _ = tell(Event::Start);
        let start = Instant::now();
        let result =
            work(&mut Run { journal: &mut self.journal, watch: &mut |step: &Step| tell(Event::Step(*step)) });
        let seconds = start.elapsed().as_secs_f64();
        let _ = tell(Event::End(seconds));
        self.timings.0.push((stage, seconds));
        self.stopping = stopping;
        result
    }

    /// Nothing, unless the work is to stop: then the error that says so, with what was `reached` until now.
    ///
    /// # Errors
    /// [`PipelineError::Interrupted`], or [`PipelineError::Journal`] where the journal is not of this job.
    pub fn go_on(&self, reached: impl FnOnce() -> Option<Partial>) -> Result<(), PipelineError> {
        if let Some(fault) = self.journal.fault() {
            return Err(PipelineError::Journal(fault.to_owned()));
        }
        if !self.stopping {
            return Ok(());
        }
        let stage = self.timings.0.last().map_or("start", |(stage, _)| stage);
        Err(PipelineError::Interrupted { stage, reached: reached().map(Box::new) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_told_of_in_order_and_stop_once_asked() {
        let mut told = Vec::new();
        let mut watch = |progress: &Progress| {
            let event = match progress.event {
                Event::Start => "start",
                Event::Step(_) => "step",
                Event::End(_) => "end",
            };
            told.push((progress.stage, event));
            if told.len() == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut clock = Clock::new(&mut watch);
        assert_eq!(clock.run("one", |_| 1), 1);
        assert!(clock.go_on(|| None).is_ok());
        assert_eq!(clock.run("two", |_| 2), 2);
        // A later answer does not take the wish back.
        clock.run("three", |_| ());
        assert!(matches!(clock.go_on(|| None), Err(PipelineError::Interrupted { stage: "three", .. })));
        assert_eq!(clock.timings.0.len(), 3);
        drop(clock);
        let events = ["one", "two", "three"].iter().flat_map(|&stage| [(stage, "start"), (stage, "end")]);
        assert_eq!(told, events.collect::<Vec<_>>());
    }
}
