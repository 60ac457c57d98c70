//! Fanuc 30i: tool centre point control type 1 (`G43.4`, angles) and type 2 (`G43.5`, vectors), off by `G49`.

use super::{Block, Facts, Words, iso};

/// The dialect.
pub(super) struct Fanuc {
    /// Type 2.
    pub vectors: bool,
}

impl Words for Fanuc {
    fn comment(&self, text: &str) -> String {
        format!("({text})")
    }

    fn head(&self, facts: &Facts, comments: Vec<String>) -> Vec<String> {
        let tool = facts.machine.setup.tool_number;
        let length = match (facts.machine.tcp, self.vectors) {
            (false, _) => format!("G43 H{tool}"),
            (true, false) => format!("G43.4 H{tool}"),
            // Q leans the tool against its vector: not at all.
            (true, true) => format!("G43.5 H{tool} Q0.0"),
        };
        let dwell = format!("G4 X{:.1}", facts.machine.spindle.start_seconds);
        head(facts, comments, &length, &dwell)
    }

    fn mark(&self, run: usize, text: &str) -> String {
        format!("N{run} ({text})")
    }

    fn block(&self, block: &Block) -> String {
        iso::block(block, "")
    }

    fn foot(&self, facts: &Facts) -> Vec<String> {
        foot(facts)
    }
}

/// The head that Fanuc and Haas share; `length` switches the tool's length on, and the tip's control with it.
pub(super) fn head(facts: &Facts, comments: Vec<String>, length: &str, dwell: &str) -> Vec<String> {
    let setup = &facts.machine.setup;
    let [xy, z] = iso::home(facts);
    let number = facts.machine.output.program_number as usize + facts.file;
    let mut lines = vec!["%".to_owned(), format!("O{number:04} (kirimorph)")];
    lines.extend(comments);
    lines.push(format!("G21 G17 G40 G49 G80 G90 G94 G{}", setup.work_offset));
    lines.push("M5".to_owned());
    lines.push(format!("G53 G0 {}", iso::home_z(facts)));
    lines.extend(iso::upright(facts, ""));
    lines.push(format!("T{} M6", setup.tool_number));
    lines.push(format!("S{:.0} M3", facts.header.spindle_rpm));
    lines.extend(iso::coolant(facts).map(str::to_owned));
    lines.push(dwell.to_owned());
    lines.push(format!("G0 {xy}"));
    lines.push(format!("{length} {z}"));
    lines
}

/// The foot that Fanuc and Haas share.
pub(super) fn foot(facts: &Facts) -> Vec<String> {
    let mut lines = vec!["G49".to_owned(), format!("G53 G0 {}", iso::home_z(facts))];
    lines.extend(iso::upright(facts, ""));
    lines.extend(["M5", "M9", "M30", "%"].map(str::to_owned));
    lines
}
