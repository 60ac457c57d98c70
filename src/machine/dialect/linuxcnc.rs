//! LinuxCNC (RS274/NGC). Kinematics are switched by an analog output that the machine's HAL connects to
//! `motion.switchkins-type`; `M66` waits for the queue, so that the interpreter takes over the new
//! coordinates.

use super::{Block, Facts, Words, inverse_time, iso};

/// The dialect.
pub(super) struct LinuxCnc;

/// Words that switch tool centre point control, where the machine has it.
fn kinematics(facts: &Facts, on: bool) -> Vec<String> {
    if !facts.machine.tcp {
        return Vec::new();
    }
    let [output, tcp_on, tcp_off] = facts.machine.output.switch;
    vec![format!("M68 E{output} Q{}", if on { tcp_on } else { tcp_off }), "M66 E0 L0".to_owned()]
}

impl Words for LinuxCnc {
    fn comment(&self, text: &str) -> String {
        format!("({text})")
    }

    fn head(&self, facts: &Facts, comments: Vec<String>) -> Vec<String> {
        let setup = &facts.machine.setup;
        let [xy, z] = iso::home(facts);
        let mut lines = comments;
        lines.push(format!("G21 G17 G40 G49 G80 G90 G94 G{}", setup.work_offset));
        lines.push("G64 P0.005 Q0".to_owned());
        lines.push("M5".to_owned());
        lines.extend(kinematics(facts, false));
        lines.push(format!("G53 G0 {}", iso::home_z(facts)));
        lines.extend(iso::upright(facts, ""));
        lines.push(format!("T{} M6", setup.tool_number));
        lines.push(format!("G43 H{}", setup.tool_number));
        lines.push(format!("S{:.0} M3", facts.header.spindle_rpm));
        lines.extend(iso::coolant(facts).map(str::to_owned));
        lines.push(format!("G4 P{:.1}", facts.machine.spindle.start_seconds));
        lines.push(format!("G0 {xy}"));
        lines.push(format!("G0 {z}"));
        lines.extend(kinematics(facts, true));
        if inverse_time(facts.machine) {
            lines.push("G93".to_owned());
        }
        lines
    }

    fn mark(&self, run: usize, text: &str) -> String {
        format!("N{run} ({text})")
    }

    fn block(&self, block: &Block) -> String {
        iso::block(block, "")
    }

    fn foot(&self, facts: &Facts) -> Vec<String> {
        let mut lines = kinematics(facts, false);
        if inverse_time(facts.machine) {
            lines.push("G94".to_owned());
        }
        lines.push(format!("G53 G0 {}", iso::home_z(facts)));
        lines.extend(iso::upright(facts, ""));
        lines.extend(["M5", "M9", "M2"].map(str::to_owned));
        lines
    }
}
