//! What is told of an open state without a target.

use crate::kirigami::quality::Quality;

/// What it covers and how near its guides were reached: label and value; nothing where the open state has a target.
pub fn figures(quality: &Quality) -> Vec<(String, String)> {
    let Some(open) = &quality.open_state else { return Vec::new() };
    let size = open.bounds[1] - open.bounds[0];
    let covers = format!("{:.0} mm2, {:.1} x {:.1} x {:.1} mm", open.area, size.x, size.y, size.z);
    let guides = open.guides.iter().enumerate();
    let reached =
        guides.map(|(i, reach)| (format!("guide {}", i + 1), format!("off {:.3} mm", reach.distance)));
    std::iter::once((String::from("open state covers"), covers)).chain(reached).collect()
}
