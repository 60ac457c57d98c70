//! What `--json` prints on standard output: one JSON object per line, each with its "event".
//!
//! "stage" (its "state" is "start" or "end", then with "seconds"), "step" (where the solver stands; energies
//! in the solver's units, in which the mean edge is 1), and at last "result" or "error". Lines are written as
//! things happen.

use serde_json::{Map, Value, json};

use super::print;
use crate::pipeline::{Event, Progress};

/// Tells where the work stands; `seconds` since its start.
pub fn progress(progress: &Progress, seconds: f64) {
    let stage = progress.stage;
    tell(&match progress.event {
        Event::Start => json!({ "event": "stage", "stage": stage, "state": "start" }),
        Event::End(took) => json!({ "event": "stage", "stage": stage, "state": "end", "seconds": took }),
        Event::Step(step) => {
            let energies: Map<String, Value> =
                step.terms.iter().cloned().zip(step.energies.iter().map(|&energy| energy.into())).collect();
            json!({
                "event": "step", "stage": stage, "phase": step.phase, "iteration": step.iteration,
                "limit": step.limit, "most_steps_left": step.limit - step.iteration + step.later,
                "energy": step.energies.iter().sum::<f64>(), "energies": energies, "seconds": seconds,
            })
        }
    });
}

/// Tells why there is no result; `kind` is "error", "refused" or "interrupted".
pub fn error(kind: &str, message: &str, status: u8) {
    tell(&json!({ "event": "error", "kind": kind, "status": status, "message": message }));
}

/// Prints one event.
pub fn tell(event: &Value) {
    print(&format!("{event}\n"));
}
