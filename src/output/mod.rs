//! Writers: each turns values into the bytes of one format, and decides nothing.

pub mod layout_fault;

mod bulge_arc;

pub mod dxf;

pub mod svg;

mod json_rows;

pub mod design_json;

pub mod partial_json;

pub mod hinge_report;

pub mod preview;

pub mod report;

pub mod stretch_map;

pub mod snap_report;

pub mod toolpath_svg;

pub mod leftover;

pub mod whole_file;

pub mod exchange;

pub mod folder;

pub mod glb;

use crate::fabrication::layout::CutKind;
use crate::profile::Profile;

/// How a layer is called and drawn in machine files.
struct Layer {
    /// DXF layer name.
    name: &'static str,
    /// Class in the SVG.
    class: &'static str,
    /// AutoCAD colour index.
    aci: u8,
    /// The same colour in the SVG.
    rgb: &'static str,
}

const SLIT: Layer = Layer { name: "SLIT", class: "slit", aci: 1, rgb: "#ff0000" };
const RELIEF: Layer = Layer { name: "RELIEF", class: "relief", aci: 5, rgb: "#0000ff" };
const WINDOW: Layer = Layer { name: "WINDOW", class: "window", aci: 3, rgb: "#00ff00" };
// Magenta, not index 7: 7 is black or white by the reader's background.
const BORDER: Layer = Layer { name: "BORDER", class: "border", aci: 6, rgb: "#ff00ff" };
const LEAD: Layer = Layer { name: "LEAD", class: "lead", aci: 4, rgb: "#00ffff" };
/// Not cut through.
const ENGRAVE: Layer = Layer { name: "ENGRAVE", class: "engrave", aci: 30, rgb: "#ff7f00" };
const NOTE: Layer = Layer { name: "NOTE", class: "note", aci: 8, rgb: "#808080" };

fn layer_of(kind: CutKind) -> &'static Layer {
    match kind {
        CutKind::Slit => &SLIT,
        CutKind::Relief => &RELIEF,
        CutKind::Window => &WINDOW,
        CutKind::Border => &BORDER,
        CutKind::Lead => &LEAD,
    }
}

/// One line that no format can take for structure: control characters and line separators become spaces,
/// characters outside the Basic Multilingual Plane and non-characters become question marks.
fn plain_line(text: &str) -> String {
    let plain = |c: char| match c {
        '\u{2028}' | '\u{2029}' => ' ',
        c if c.is_control() => ' ',
        '\u{fffe}' | '\u{ffff}' => '?',
        c if c > '\u{ffff}' => '?',
        c => c,
    };
    text.chars().map(plain).collect()
}

/// What the pages of a result have in common.
#[derive(Debug, Clone, Copy)]
pub struct Heading<'a> {
    /// The job's name, or the design's.
    pub name: &'a str,
    /// The name of its target, or of both.
    pub target: &'a str,
    /// For which it was laid out.
    pub profile: &'a Profile,
    /// Key figures: label and value with its unit, in the order of importance.
    pub figures: &'a [(String, String)],
}
