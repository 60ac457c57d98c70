//! Siemens 840D: `TRAORI` holds the tip, `TRAFOOF` lets it go. With angles the machine's axes are turned
//! evenly (`ORIMKS ORIAXES`), with vectors the tool in a plane (`ORIWKS ORIVECT`). The work offset is said
//! again after `TRAORI`, which resets frames.

use super::{Block, Facts, Words, iso};

/// The dialect.
pub(super) struct Siemens {
    /// Vectors in place of angles.
    pub vectors: bool,
}

impl Words for Siemens {
    fn comment(&self, text: &str) -> String {
        format!("; {text}")
    }

    fn head(&self, facts: &Facts, comments: Vec<String>) -> Vec<String> {
        let setup = &facts.machine.setup;
        let [xy, z] = iso::home(facts);
        let mut lines = comments;
        lines.push(format!("G17 G40 G710 G90 G94 G{}", setup.work_offset));
        lines.push("M5".to_owned());
        lines.push(format!("SUPA G0 {} D0", iso::home_z(facts)));
        lines.extend(iso::upright(facts, "="));
        lines.push(format!("T{}", setup.tool_number));
        lines.push("M6".to_owned());
        lines.push("D1".to_owned());
        lines.push(format!("S{:.0} M3", facts.header.spindle_rpm));
        lines.extend(iso::coolant(facts).map(str::to_owned));
        lines.push(format!("G4 F{:.1}", facts.machine.spindle.start_seconds));
        lines.push(format!("G0 {xy}"));
        lines.push(format!("G0 {z}"));
        if facts.machine.tcp {
            lines.push("TRAORI".to_owned());
            lines.push(format!("G{}", setup.work_offset));
            lines.push(if self.vectors { "ORIWKS ORIVECT" } else { "ORIMKS ORIAXES" }.to_owned());
        }
        lines
    }

    fn mark(&self, run: usize, text: &str) -> String {
        format!("N{run} ; {text}")
    }

    fn block(&self, block: &Block) -> String {
        iso::block(block, "=")
    }

    fn foot(&self, facts: &Facts) -> Vec<String> {
        let mut lines = Vec::new();
        if facts.machine.tcp {
            lines.push("TRAFOOF".to_owned());
        }
        lines.push(format!("SUPA G0 {} D0", iso::home_z(facts)));
        lines.extend(iso::upright(facts, "="));
        lines.extend(["M5", "M9", "M30"].map(str::to_owned));
        lines
    }
}
