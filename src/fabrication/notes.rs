//! Texts beside the part: what it is made of, that the kerf is applied, and a measure of scale.

use kurbo::{Point, Rect};

use super::layout::Note;
use crate::profile::{Process, Profile};

/// Letter height of plain notes, millimetres.
const LETTER: f64 = 3.0;
/// Letter height of the scale mark, millimetres: the mark is its own height.
const SCALE_MARK: f64 = 10.0;
/// Free space around notes, millimetres.
const SPACE: f64 = 2.0;
/// Width of an average letter in units of its height, on the safe side for common stroke fonts.
const LETTER_WIDTH: f64 = 0.9;

/// That the groove's width is already in the paths.
pub fn applied_words(profile: &Profile) -> String {
    let kerf = profile.cut.kerf;
    match profile.process {
        Process::Laser => format!("kerf {kerf} mm already applied: cut on the line"),
        Process::Milling => format!("tool diameter {kerf} mm already applied: mill on the line"),
    }
}

/// The notes of a part whose burned box is `part`: above it or else to its right, within the sheet. Lines that
/// have no room outside the part are left out. `more`: what else the workshop must know, one line each.
pub fn notes(profile: &Profile, part: Rect, more: &[String]) -> Vec<Note> {
    let sheet = &profile.sheet;
    let mut lines = vec![
        (LETTER, format!("{}: {}, {} mm thick", profile.name, profile.material.name, sheet.thickness)),
        (LETTER, format!("sheet {} x {} mm, millimetres", sheet.width, sheet.height)),
        (LETTER, applied_words(profile)),
    ];
    lines.extend(more.iter().map(|line| (LETTER, line.clone())));
    lines.push((SCALE_MARK, "I = 10 mm".to_string()));
    let width_of = |(height, text): &(f64, String)| height * LETTER_WIDTH * text.chars().count() as f64;
    let height: f64 = lines.iter().map(|(height, _)| height + SPACE).sum();
    let width = lines.iter().map(width_of).fold(0.0, f64::max);
    let limit = Point::new(sheet.width - sheet.margin, sheet.height - sheet.margin);
    let above = Point::new(part.x0, part.y1 + SPACE);
    let right = Point::new(part.x1 + SPACE, part.y0);
    let fits = |at: &Point| at.x + width <= limit.x && at.y + height <= limit.y;
    let start = [above, right].into_iter().find(fits).unwrap_or(above);
    let mut notes = Vec::new();
    let mut at = start;
    for (height, text) in lines.into_iter().rev() {
        let fits = at.x + width_of(&(height, text.clone())) <= limit.x && at.y + height <= limit.y;
        if fits {
            notes.push(Note { position: at, height, text });
            at.y += height + SPACE;
        }
    }
    notes.reverse();
    notes
}
