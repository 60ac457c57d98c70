//! A journal of minimisations, from which interrupted work goes on as if nothing had happened.
//!
//! Work that runs several minimisations in a row, and computes the start of each from the results before it,
//! runs them all through one [`Journal`]. Broken off, the journal holds what is needed to do the same work
//! again without its cost: results that it knows are taken from it, the minimisation that was broken off is
//! continued with the same steps, and the rest follows. The result is the same, bit by bit, as without the
//! interruption.

use super::levenberg_marquardt::active;
use super::{Options, Report, System, Termination, Watch, Weighted};

/// What minimisations in a row share: their journal, and who watches them.
pub struct Run<'a> {
    /// Results so far, and those of earlier work.
    pub journal: &'a mut Journal,
    /// Called at the start of each minimisation and after each step.
    pub watch: &'a mut Watch<'a>,
}

/// One minimisation: finished, or broken off ([`Termination::Interrupted`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Name of the stage that it belongs to.
    pub stage: String,
    /// How far it came.
    pub report: Report,
    /// The unknowns there. Empty where the stage can do without, see [`Journal`].
    pub unknowns: Vec<f64>,
}

/// Minimisations in their order.
///
/// Each one of a stage begins where the one before it ended, and depends on nothing else of the stage: so
/// only the last two of each stage keep their unknowns.
#[derive(Debug, Clone, Default)]
pub struct Journal {
    entries: Vec<Entry>,
    /// How many of the entries were done, or taken over, by the work that runs now.
    done: usize,
    fault: Option<String>,
}

impl Journal {
    /// A journal of earlier work, to be done again.
    pub fn resumed(entries: Vec<Entry>) -> Self {
        Self { entries, done: 0, fault: None }
    }

    /// What was done so far.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Why the earlier work is not the present one; the minimisation that found it out says that it was
    /// interrupted.
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// Minimises as [`System::minimize`] does, or takes the result over from earlier work. `terms` is called only
    /// where there is something to compute.
    pub fn minimize<'a>(
        &mut self,
        stage: &str,
        system: &mut System,
        terms: impl FnOnce() -> Vec<Weighted<'a>>,
        x: &mut [f64],
        options: &Options,
        watch: &mut Watch,
    ) -> Report {
        let report = match self.entries.get(self.done) {
            None => system.minimize(&mut terms(), x, options, watch),
            Some(known) => {
                if known.stage != stage || !(known.unknowns.is_empty() || known.unknowns.len() == x.len()) {
                    return self.refuse(stage, x.len());
                }
                // Without unknowns x stays what it was: a later entry of the stage replaces it.
                if !known.unknowns.is_empty() {
                    x.copy_from_slice(&known.unknowns);
                }
                if known.report.termination == Termination::Interrupted {
                    let mut terms = terms();
                    if !active(&terms).map(|weighted| weighted.term.name()).eq(&known.report.terms) {
                        return self.refuse(stage, x.len());
                    }
                    system.go_on(&mut terms, x, known.report.clone(), options, watch)
                } else {
                    known.report.clone()
                }
            }
        };
        self.record(stage, x, &report);
        report
    }

    fn record(&mut self, stage: &str, x: &[f64], report: &Report) {
        let known = self.entries.get(self.done);
        if known.is_none_or(|known| known.report.termination == Termination::Interrupted) {
            self.entries.truncate(self.done);
            self.entries.push(Entry {
                stage: stage.to_owned(),
                report: report.clone(),
                unknowns: x.to_vec(),
            });
            if let [.., old, _, _] = &mut self.entries[..]
                && old.stage == stage
            {
                old.unknowns = Vec::new();
            }
        }
        self.done += 1;
    }

    fn refuse(&mut self, stage: &str, unknowns: usize) -> Report {
        self.fault = Some(format!(
            "minimisation {} of the saved state is not the one of this job ({stage}, {unknowns} unknowns)",
            self.done
        ));
        Report {
            terms: Vec::new(),
            iterations: Vec::new(),
            next_damping: 0.0,
            termination: Termination::Interrupted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Coupling, Step, Term};
    use super::*;
    use std::ops::ControlFlow;

    /// A valley that bends: slow enough to be interrupted.
    struct Valley;

    impl Term for Valley {
        fn name(&self) -> &'static str {
            "valley"
        }
        fn blocks(&self) -> usize {
            1
        }
        fn rows(&self, _: usize) -> usize {
            2
        }
        fn unknowns(&self, _: usize) -> &[usize] {
            &[0, 1]
        }
        fn evaluate(&self, _: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
            residuals.copy_from_slice(&[10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
            jacobian.copy_from_slice(&[-20.0 * x[0], 10.0, -1.0, 0.0]);
        }
    }

    /// Three minimisations of stage "a" and one of "b", each from where the last one ended; stops when
    /// `watch` says so. Returns the end.
    fn work(journal: &mut Journal, mut watch: impl FnMut() -> ControlFlow<()>) -> Option<Vec<f64>> {
        let mut x = vec![-1.2, 1.0];
        for (stage, weight) in [("a", 1.0), ("a", 2.0), ("a", 3.0), ("b", 1.0)] {
            let terms = || vec![Weighted { term: Box::new(Valley), weight, coupling: Coupling::Full }];
            let mut system = System::new(vec![[0.0; 2]; 2]);
            let options = Options { iterations: 6, ..Options::default() };
            let report =
                journal.minimize(stage, &mut system, terms, &mut x, &options, &mut |_: &Step| watch());
            if report.termination == Termination::Interrupted {
                return None;
            }
            // What lies between: not exactly undone by its inverse.
            x.iter_mut().for_each(|value| *value = *value / 3.0 * 3.0);
        }
        Some(x)
    }

    #[test]
    fn interrupted_work_ends_at_the_same_bits() {
        let mut whole = Journal::default();
        let mut steps = 0;
        let end = work(&mut whole, || {
            steps += 1;
            ControlFlow::Continue(())
        });
        assert!(steps > 8 && end.is_some());
        for stop_at in 1..=steps {
            let mut journal = Journal::default();
            let mut step = 0;
            let stop = || {
                step += 1;
                if step == stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            assert_eq!(work(&mut journal, stop), None, "{stop_at}");
            let mut again = Journal::resumed(journal.entries().to_vec());
            assert_eq!(work(&mut again, || ControlFlow::Continue(())), end, "{stop_at}");
            assert_eq!(again.entries(), whole.entries(), "{stop_at}");
        }
        let kept: Vec<bool> = whole.entries().iter().map(|entry| !entry.unknowns.is_empty()).collect();
        assert_eq!(kept, [false, true, true, true]);
    }

    #[test]
    fn another_jobs_journal_is_refused() {
        let mut journal = Journal::default();
        work(&mut journal, || ControlFlow::Continue(()));
        let mut wrong_stage = journal.entries().to_vec();
        wrong_stage[3].stage = "c".into();
        let mut wrong_count = journal.entries().to_vec();
        wrong_count[1].unknowns.push(0.0);
        let mut wrong_term = journal.entries().to_vec();
        wrong_term[3].report.termination = Termination::Interrupted;
        wrong_term[3].report.terms = vec!["hill".into()];
        for entries in [wrong_stage, wrong_count, wrong_term] {
            let mut journal = Journal::resumed(entries);
            assert_eq!(work(&mut journal, || ControlFlow::Continue(())), None);
            assert!(journal.fault().is_some());
        }
    }
}
