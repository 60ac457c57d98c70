//! What is printed: a table of what was measured, and the faults.

use super::agreement::APART;
use super::fault::{Check, Fault};
use super::ligaments::{CENTRE_TOLERANCE, WIDTH_TOLERANCE};
use super::paths::SHORTEST;
use super::pieces;
use super::{Figures, Wanted};

/// The table: what was checked, what was measured, the limit.
pub fn table(figures: &Figures, wanted: Wanted) -> String {
    let profile = wanted.profile;
    let width = profile.ligament.width;
    let pieces = wanted.copies.len() * wanted.design.pieces.len();
    let [least, most, neck] = figures.ligament_widths;
    let [shortest, longest] = figures.ligament_lengths;
    let [off, forced] = figures.ligament_centre;
    let row = |label: &str, value: String, limit: String| [label.to_owned(), value, limit];
    let mut rows = vec![row("checked", "measured".to_owned(), "limit".to_owned())];
    for (layer, count, length) in &figures.cuts {
        rows.push(row(layer, format!("{count} cuts, {length:.1} mm"), String::new()));
    }
    if let (count @ 1.., length) = figures.engraved {
        rows.push(row("engraved", format!("{count} strokes, {length:.1} mm"), String::new()));
    }
    if let (Some([least, most]), Some(tabs)) = (figures.tab_widths, wanted.tabs) {
        let limit = format!("{} mm", tabs.width);
        rows.push(row("tab width", format!("{least:.4} to {most:.4} mm"), limit));
    }
    rows.extend([
        row("two files apart", format!("{:.1e} mm", figures.files_apart), format!("{APART:.0e} mm")),
        row(
            "from the stock's edge",
            millimetres(figures.stock_distance),
            format!(">= {} mm", profile.sheet.margin),
        ),
        row("shortest segment", millimetres(figures.shortest_segment), format!(">= {SHORTEST} mm")),
        row("bodies", figures.bodies.to_string(), wanted.copies.len().to_string()),
        row("pieces held", figures.pieces_held.to_string(), pieces.to_string()),
        row(
            "piece off its sides",
            millimetres(figures.piece_deviation),
            format!("{:.3} mm", pieces::DEVIATION),
        ),
        row(
            "ligament width",
            format!("{least:.4} to {most:.4} mm"),
            format!("{width} +- {WIDTH_TOLERANCE} mm"),
        ),
        row("ligament neck", millimetres(neck), format!(">= {:.3} mm", width - WIDTH_TOLERANCE)),
        row(
            "ligament length",
            format!("{shortest:.4} to {longest:.4} mm"),
            "what its angle needs".to_owned(),
        ),
        row("ligament off its hinge", millimetres(off), format!("{:.3} mm", forced + CENTRE_TOLERANCE)),
        row("web between cuts", millimetres(figures.web), format!(">= {} mm", profile.cut.min_web)),
        row("gap between cuts' ends", millimetres(figures.end_gap), String::new()),
        row("safe join tolerance", join_tolerance(figures), String::new()),
    ]);
    let widths = [0, 1].map(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0));
    let line = |[label, value, limit]: &[String; 3]| {
        format!("  {label:<0$}  {value:<1$}  {limit}", widths[0], widths[1]).trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

fn millimetres(value: f64) -> String {
    if value.is_finite() { format!("{value:.4} mm") } else { "none".to_owned() }
}

fn join_tolerance(figures: &Figures) -> String {
    match figures.join_tolerance() {
        tolerance if tolerance.is_finite() => format!("up to {tolerance:.3} mm"),
        _ => "any: every cut is closed".to_owned(),
    }
}

/// The faults, those of one check together with what to do; at most `shown` of each.
pub fn faults(faults: &[Fault], shown: usize) -> String {
    let mut checks: Vec<Check> = faults.iter().map(|fault| fault.check).collect();
    checks.sort();
    checks.dedup();
    let mut text = String::new();
    for check in checks {
        let of_check: Vec<&Fault> = faults.iter().filter(|fault| fault.check == check).collect();
        for fault in of_check.iter().take(shown) {
            text += &format!("  {fault}\n");
        }
        if of_check.len() > shown {
            text += &format!("  and {} more like these\n", of_check.len() - shown);
        }
        text += &format!("    -> {}\n", check.remedy());
    }
    text
}
