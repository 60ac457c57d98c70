//! Haas: tool center point control by `G234`, off by `G49`. It needs the machine's rotary zero point (MRZP)
//! set.

use super::{Block, Facts, Words, fanuc, iso};

/// The dialect.
pub(super) struct Haas;

impl Words for Haas {
    fn comment(&self, text: &str) -> String {
        format!("({text})")
    }

    fn head(&self, facts: &Facts, comments: Vec<String>) -> Vec<String> {
        // With a decimal point P is in seconds.
        let dwell = format!("G4 P{:.1}", facts.machine.spindle.start_seconds);
        let on = if facts.machine.tcp { "G234" } else { "G43" };
        fanuc::head(facts, comments, &format!("{on} H{}", facts.machine.setup.tool_number), &dwell)
    }

    fn mark(&self, run: usize, text: &str) -> String {
        format!("N{run} ({text})")
    }

    fn block(&self, block: &Block) -> String {
        iso::block(block, "")
    }

    fn foot(&self, facts: &Facts) -> Vec<String> {
        fanuc::foot(facts)
    }
}
