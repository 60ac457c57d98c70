//! Heidenhain conversational: `FUNCTION TCPM` or `M128` holds the tip. Angles are axis positions, turned
//! evenly; `M127` keeps the control from taking the shorter way round. Machine coordinates (`M91`) only while
//! the tip is free.

use super::{Block, Facts, Words, iso, lengths, number};

/// The dialect.
pub(super) struct Heidenhain {
    /// `M128` in place of `FUNCTION TCPM`.
    pub m128: bool,
}

/// A number with its sign.
fn signed(value: &str) -> String {
    if value.starts_with('-') { value.to_owned() } else { format!("+{value}") }
}

fn upright(facts: &Facts) -> Option<String> {
    let rotary = facts.machine.rotary.as_ref()?;
    let [tilt, turn] = rotary.table.letters();
    Some(format!("L {tilt}+0.0 {turn}+0.0 R0 FMAX"))
}

fn home_z(facts: &Facts) -> String {
    let z = number(facts.machine.setup.home_z, facts.machine.output.decimals);
    format!("L Z{} R0 FMAX M91", signed(&z))
}

impl Heidenhain {
    /// The program's name, that of its file.
    fn name(facts: &Facts) -> String {
        if facts.files > 1 { format!("MILL{:02}", facts.file + 1) } else { "MILL".to_owned() }
    }
}

impl Words for Heidenhain {
    fn comment(&self, text: &str) -> String {
        format!("; {text}")
    }

    fn head(&self, facts: &Facts, comments: Vec<String>) -> Vec<String> {
        let setup = &facts.machine.setup;
        let [x, y, z] = lengths(facts.machine, &facts.home).map(|value| signed(&value));
        let mut lines = vec![format!("BEGIN PGM {} MM", Self::name(facts))];
        lines.extend(comments);
        let [low, high] =
            facts.stats.bounds.map(|corner| [corner.x, corner.y].map(|v| signed(&number(v, 3))));
        let below = signed(&number(-facts.toolpath.thickness, 3));
        lines.push(format!("BLK FORM 0.1 Z X{} Y{} Z{below}", low[0], low[1]));
        lines.push(format!("BLK FORM 0.2 X{} Y{} Z+0.0", high[0], high[1]));
        lines.push("M5".to_owned());
        lines.push("M127".to_owned());
        lines.push(home_z(facts));
        lines.extend(upright(facts));
        lines.push(format!("TOOL CALL {} Z S{:.0}", setup.tool_number, facts.header.spindle_rpm));
        lines.push("CYCL DEF 247 DATUM SETTING ~".to_owned());
        lines.push(format!("  Q339=+{} ;DATUM NUMBER", setup.work_offset));
        lines.push("M3".to_owned());
        lines.extend(iso::coolant(facts).map(str::to_owned));
        lines.push("CYCL DEF 9.0 DWELL TIME".to_owned());
        lines.push(format!("CYCL DEF 9.1 DWELL {:.1}", facts.machine.spindle.start_seconds));
        lines.push(format!("L X{x} Y{y} R0 FMAX"));
        lines.push(format!("L Z{z} R0 FMAX"));
        if facts.machine.tcp {
            let on = if self.m128 { "M128" } else { "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS" };
            lines.push(on.to_owned());
        }
        lines
    }

    fn mark(&self, _run: usize, text: &str) -> String {
        format!("; {text}")
    }

    fn block(&self, block: &Block) -> String {
        let mut line = "L".to_owned();
        for (axis, value) in &block.xyz {
            line.push_str(&format!(" {axis}{}", signed(value)));
        }
        for (axis, value) in &block.turns {
            line.push_str(&format!(" {axis}{}", signed(value)));
        }
        if block.rapid {
            line.push_str(" R0 FMAX");
        } else if let Some(feed) = &block.feed {
            line.push_str(&format!(" F{feed}"));
        }
        line
    }

    fn foot(&self, facts: &Facts) -> Vec<String> {
        let mut lines = Vec::new();
        if facts.machine.tcp {
            lines.push(if self.m128 { "M129" } else { "FUNCTION RESET TCPM" }.to_owned());
        }
        lines.push(home_z(facts));
        lines.extend(upright(facts));
        lines.extend(["M5", "M9", "M30"].map(str::to_owned));
        lines.push(format!("END PGM {} MM", Self::name(facts)));
        lines
    }

    fn feed_decimals(&self) -> usize {
        1
    }

    fn numbers_lines(&self) -> bool {
        true
    }
}
