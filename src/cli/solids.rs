//! The thick parts that `make` and `fabricate` write alike, and what is said of them.

use super::Failure;
use crate::fabrication::product::Product;
use crate::pipeline::mill::walls;
use crate::profile::Profile;
use crate::solid::{ThickSheet, thicken};

/// Overlaps of thick pieces below this are not worth a word, millimetres.
const WORTH_TELLING: f64 = 1e-3;

/// The solids of a sheet; `None` for an assembly, whose pieces are made one by one.
///
/// # Errors
/// What cannot be made of thick material.
pub fn solids(product: &Product, profile: &Profile) -> Result<Option<ThickSheet>, Failure> {
    let Product::Sheet(sheet) = product else { return Ok(None) };
    let thick = thicken(sheet, profile.sheet.thickness, walls(profile))
        .map_err(|error| Failure::NotMakeable(error.to_string()))?;
    Ok(Some(thick))
}

/// Lines for the summary.
pub fn summary(solids: &ThickSheet) -> String {
    let mut text = format!(
        "  part of {:.1} cm3; at its faces ligaments stand up to {:.3} mm off their tilted axes\n",
        solids.volume / 1000.0,
        solids.axis_error
    );
    if let Some(clash) = solids.clash.filter(|clash| clash.depth > WORTH_TELLING) {
        text += &format!("  {clash}\n");
    }
    text
}

/// Figures for the result event.
pub fn event(solids: &ThickSheet) -> serde_json::Value {
    serde_json::json!({
        "volume_mm3": solids.volume,
        "axis_error_mm": solids.axis_error,
        "overlap_mm": solids.clash.map_or(0.0, |clash| clash.depth),
        "overlap_limit_mm": solids.clash.map(|clash| clash.limit),
        "overlapping_pieces": solids.clash.map(|clash| clash.pieces),
    })
}
