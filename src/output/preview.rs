//! `preview.svg`: one A3 landscape page that a person looks at before cutting.
//!
//! It shows the sheet as it will be cut, the other state in space, which side is up and what becomes of it, how the
//! pieces turn at a hinge, and the key figures. Page coordinates are millimetres, y down. The page decides nothing:
//! all numbers are those of the [`Fabrication`] and of the lines that the caller passes. The same input gives the
//! same bytes. [`assembly`] draws the page of a design that has no flat state.

pub mod assembly;
mod detail;
mod opened_corner;
pub(super) mod opening;
pub(super) mod page;
mod sheet;
mod space;
mod tables;

use std::io::{self, Write};

use kurbo::{Point, Rect};
use svg::Document;
use svg::node::element::{Group, Rectangle, Title};

use super::layout_fault::{self, LayoutFault};
use super::{Heading, plain_line};
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::geometry::Point3;
use crate::kirigami::design::{Design, Hinge, Piece};
use detail::Corner;
use opening::Opening;
use page::{PAGE, number, shortened, text};
use tables::HingeClass;

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct Preview<'a> {
    /// The checked sheet, its design in sheet coordinates.
    pub fabrication: &'a Fabrication,
    /// What it is called, and its figures.
    pub heading: Heading<'a>,
    /// What the sheet is made from instead of this picture.
    pub made_from: &'a str,
    /// What makes the groove as wide as it is: the kerf or the tool.
    pub groove: &'a str,
}

/// Why no preview was written.
#[derive(Debug, thiserror::Error)]
pub enum WritePreviewError {
    /// The layout holds something that cannot be drawn.
    #[error(transparent)]
    Layout(#[from] LayoutFault),
    /// The lists do not belong to one sheet.
    #[error("the sheet has {found} {what} instead of {expected}: make it anew from its design")]
    Count {
        /// Which list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A piece, hinge or corner that cannot be drawn.
    #[error("{kind} {index} {reason}: make the sheet anew from its design")]
    Item {
        /// What it is.
        kind: &'static str,
        /// Index in its list of the design.
        index: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A length that cannot be drawn.
    #[error(
        "the {what} is {value} mm, it must be finite and not below 0: make the sheet anew from its design"
    )]
    Length {
        /// Which length.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The output refused the bytes.
    #[error("cannot write the preview: {0}")]
    Io(#[from] io::Error),
}

/// Sheets with more pieces are drawn with less detail, so that the file stays below 15 MB at 10,000 pieces.
const DETAILED_PIECES: usize = 3000;

/// Most hinges that are named on the drawing.
const NAMED_HINGES: usize = 5;

const SHEET: Rect = Rect::new(8.0, 24.0, 240.0, 260.0);
const LEGEND: Rect = Rect::new(8.0, 264.0, 240.0, 290.0);
const SPACE: Rect = Rect::new(246.0, 24.0, 412.0, 120.0);
const DETAIL: Rect = Rect::new(246.0, 124.0, 412.0, 218.0);
const FIGURES: Rect = Rect::new(246.0, 222.0, 326.0, 290.0);
const HINGES: Rect = Rect::new(330.0, 222.0, 412.0, 290.0);

/// Writes the page.
///
/// # Errors
/// A fault of the sheet, before anything is written, or the error of `out`.
pub fn write<W: Write>(preview: &Preview<'_>, mut out: W) -> Result<(), WritePreviewError> {
    check(preview.fabrication)?;
    let opening = Opening::new(&preview.fabrication.design);
    let scene = Scene {
        fabrication: preview.fabrication,
        opening: &opening,
        worst: worst(&preview.fabrication.hinges),
        corner: Corner::nearest_to_middle(preview.fabrication),
        groove: preview.groove,
        simplified: preview.fabrication.design.pieces.len() > DETAILED_PIECES,
    };
    let heading = preview.heading;
    let subtitle = format!(
        "target {}   |   profile {}   |   a picture to look at, not to cut from: {}",
        heading.target, heading.profile.name, preview.made_from
    );
    let document = empty_page(heading.name)
        .add(header(heading.name, &subtitle, &preview.fabrication.hinges))
        .add(sheet::panel(&scene, SHEET))
        .add(tables::legend(&scene, LEGEND))
        .add(space::panel(&scene, SPACE))
        .add(detail::panel(&scene, DETAIL))
        .add(tables::figures(heading.figures, FIGURES))
        .add(tables::hinges(&preview.fabrication.hinges, &scene.worst, HINGES));
    ::svg::write(&mut out, &document)?;
    out.write_all(b"\n")?;
    Ok(out.flush()?)
}

/// What all panels draw from.
struct Scene<'a> {
    fabrication: &'a Fabrication,
    opening: &'a Opening,
    /// The hinges to look at first.
    worst: Vec<&'a HingeRow>,
    /// The corner that is shown enlarged.
    corner: Option<Corner<'a>>,
    /// What makes a groove as wide as it is.
    groove: &'a str,
    /// Whether fine detail is left out.
    simplified: bool,
}

/// A white page with its title.
fn empty_page(title: &str) -> Document {
    let [width, height] = PAGE;
    Document::new()
        .set("width", format!("{}mm", number(width, 0)))
        .set("height", format!("{}mm", number(height, 0)))
        .set("viewBox", format!("0 0 {} {}", number(width, 0), number(height, 0)))
        .set("font-family", "sans-serif")
        .add(Title::new(plain_line(&format!("{title}: preview"))))
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "#ffffff"))
}

fn header(title: &str, subtitle: &str, hinges: &[HingeRow]) -> Group {
    let title = shortened(title, page::BOLD * 8.0, 290.0);
    Group::new()
        .add(verdict(hinges))
        .add(text(Point::new(8.0, 13.5), 8.0, &title).set("font-weight", "bold"))
        .add(text(Point::new(8.0, 20.0), 3.6, &shortened(subtitle, 3.6, 400.0)))
}

/// The count of hinges by verdict, in a box whose colour is that of the worst.
fn verdict(rows: &[HingeRow]) -> Group {
    let [ok, warn, fail] = [Verdict::Ok, Verdict::Warn, Verdict::Fail]
        .map(|verdict| page::grouped(rows.iter().filter(|row| row.verdict == verdict).count()));
    let content = format!("hinges: {ok} ok, {warn} warn, {fail} fail");
    let (fill, ink) = match rows.iter().map(|row| row.verdict).max() {
        Some(Verdict::Fail) => (HingeClass::Fail.colour(), "#ffffff"),
        Some(Verdict::Warn) => (HingeClass::Warn.colour(), page::INK),
        _ => ("#e2f2ec", page::INK),
    };
    let area = Rect::new(
        PAGE[0] - 8.0 - page::text_width(&content, page::BOLD * 4.6) - 6.0,
        6.5,
        PAGE[0] - 8.0,
        15.5,
    );
    let label = text(Point::new(area.center().x, 12.7), 4.6, &content).set("fill", ink);
    Group::new()
        .add(page::rectangle(area, fill).set("stroke", page::INK).set("stroke-width", "0.25"))
        .add(label.set("text-anchor", "middle").set("font-weight", "bold"))
}

/// The worst hinges: by verdict, then by strain, then by id.
fn worst(rows: &[HingeRow]) -> Vec<&HingeRow> {
    let mut order: Vec<&HingeRow> = rows.iter().collect();
    order.sort_by(|a, b| b.verdict.cmp(&a.verdict).then(b.strain.total_cmp(&a.strain)).then(a.id.cmp(&b.id)));
    order.truncate(NAMED_HINGES);
    order
}

fn check(fabrication: &Fabrication) -> Result<(), WritePreviewError> {
    layout_fault::check(&fabrication.layout)?;
    let Fabrication { design, layout, hinges, outlines } = fabrication;
    check_length("kerf", layout.kerf)?;
    check_count("outlines", outlines.len(), design.pieces.len())?;
    for (index, outline) in outlines.iter().enumerate() {
        if outline.len() < 3 || !outline.iter().flatten().all(|c| c.is_finite()) {
            let reason = match outline.len() {
                0..3 => "has an outline of fewer than three vertices",
                _ => "has a vertex that is not finite",
            };
            return Err(WritePreviewError::Item { kind: "piece", index, reason });
        }
    }
    check_design(design, hinges)
}

fn check_length(what: &'static str, value: f64) -> Result<(), WritePreviewError> {
    if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(WritePreviewError::Length { what, value }) }
}

fn check_count(what: &'static str, found: usize, expected: usize) -> Result<(), WritePreviewError> {
    if found == expected { Ok(()) } else { Err(WritePreviewError::Count { what, found, expected }) }
}

/// Checks a design and the rows of its hinges.
fn check_design(design: &Design, hinges: &[HingeRow]) -> Result<(), WritePreviewError> {
    check_length("gap", design.gap)?;
    check_count("rows of hinges", hinges.len(), design.hinges.len())?;
    let item = |kind, index, reason| WritePreviewError::Item { kind, index, reason };
    if let Some(index) = design.corners.iter().position(|p| !finite(p)) {
        return Err(item("corner", index, "is not finite"));
    }
    for (index, piece) in design.pieces.iter().enumerate() {
        check_piece(design, piece).map_err(|reason| item("piece", index, reason))?;
    }
    for (index, (hinge, row)) in design.hinges.iter().zip(hinges).enumerate() {
        let reason = check_hinge(design, hinge, row);
        let reason = if row.id == index { reason } else { Err("has the row of another hinge") };
        reason.map_err(|reason| item("hinge", index, reason))?;
    }
    Ok(())
}

fn finite(p: &Point3) -> bool {
    p.iter().all(|c| c.is_finite())
}

fn check_piece(design: &Design, piece: &Piece) -> Result<(), &'static str> {
    let count = piece.corners.len();
    if count < 3 || piece.closed.len() != count || piece.open.len() != count {
        return Err("has fewer than three vertices or not equally many in both states");
    }
    if piece.corners.iter().any(|&corner| corner >= design.corners.len()) {
        return Err("has a corner that the design does not have");
    }
    if !piece.closed.iter().chain(&piece.open).all(finite) {
        return Err("has a vertex that is not finite");
    }
    Ok(())
}

fn check_hinge(design: &Design, hinge: &Hinge, row: &HingeRow) -> Result<(), &'static str> {
    let exists = |side: usize| {
        let piece = design.pieces.get(hinge.pieces[side]);
        piece.is_some_and(|piece| hinge.vertices[side] < piece.corners.len())
    };
    if !(exists(0) && exists(1)) {
        return Err("joins pieces or vertices that the design does not have");
    }
    let lengths = [&hinge.angle, &row.length, &row.width];
    if !hinge.axis.iter().chain(row.point.iter()).chain(lengths).all(|c| c.is_finite()) {
        return Err("has a number that is not finite");
    }
    Ok(())
}
