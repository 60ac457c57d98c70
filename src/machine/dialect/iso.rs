//! What the dialects with G and M words share.

use super::{Block, Facts, lengths, number};
use crate::machine::profile::Coolant;

/// A line of G0 or G1. `equals` stands between a rotary word and its number.
pub(super) fn block(block: &Block, equals: &str) -> String {
    let mut line = if block.rapid { "G0" } else { "G1" }.to_owned();
    for (axis, value) in &block.xyz {
        line.push_str(&format!(" {axis}{value}"));
    }
    for (word, value) in &block.turns {
        line.push_str(&format!(" {word}{equals}{value}"));
    }
    if let Some(feed) = &block.feed {
        line.push_str(&format!(" F{feed}"));
    }
    line
}

/// `X.. Y..` and `Z..` of the place above the first run.
pub(super) fn home(facts: &Facts) -> [String; 2] {
    let [x, y, z] = lengths(facts.machine, &facts.home);
    [format!("X{x} Y{y}"), format!("Z{z}")]
}

/// Both rotary axes to zero, with what stands between word and number; `None` for three axes.
pub(super) fn upright(facts: &Facts, equals: &str) -> Option<String> {
    let rotary = facts.machine.rotary.as_ref()?;
    let [tilt, turn] = rotary.table.letters();
    Some(format!("G0 {tilt}{equals}0.0 {turn}{equals}0.0"))
}

/// The height for tool changes.
pub(super) fn home_z(facts: &Facts) -> String {
    format!("Z{}", number(facts.machine.setup.home_z, facts.machine.output.decimals))
}

pub(super) fn coolant(facts: &Facts) -> Option<&'static str> {
    match facts.machine.setup.coolant {
        Coolant::Off => None,
        Coolant::Mist => Some("M7"),
        Coolant::Flood => Some("M8"),
    }
}
