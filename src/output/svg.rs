//! `cut.svg`: millimetres, true arcs, one `<path>` per cut in cutting order; notes are `<text>`, and so is what the
//! DXF holds as strokes to engrave: every shape is cut through.
//!
//! The sheet's y axis points up and the picture's down, so y is flipped in the numbers (not by a transform,
//! which some laser programs drop): the picture shows the sheet as it lies on the machine. Coordinates have at
//! most six decimals. The same layout gives the same bytes.

use std::fmt::Write as _;
use std::io::{self, Write};

use svg::node::Comment;
use svg::node::element::{Path, Text};

use crate::fabrication::layout::{CutLayout, CutPath, Note};

use super::bulge_arc::BulgeArc;
use super::layout_fault::{self, LayoutFault};
use super::{ENGRAVE, Layer, NOTE, layer_of, plain_line};

/// Why no SVG was written.
#[derive(Debug, thiserror::Error)]
pub enum WriteSvgError {
    /// The layout holds something that cannot be drawn.
    #[error(transparent)]
    Layout(#[from] LayoutFault),
    /// The output refused the bytes.
    #[error("cannot write the SVG: {0}")]
    Io(#[from] io::Error),
}

/// Width of the drawn line, millimetres: laser programs take so thin a line for a cut, not for an engraving.
const HAIRLINE: f64 = 0.01;

/// Arcs that leave their chord by less than this are drawn straight, millimetres: the last printed digit.
const FLAT: f64 = 1e-6;

/// Height of capital letters over the font size in the usual sans-serif fonts.
const CAP_HEIGHT: f64 = 0.7;

/// Writes a layout as SVG, with the comments at its head.
///
/// # Errors
/// A layout fault, before anything is written, or the error of `out`.
pub fn write<W: Write>(layout: &CutLayout, comments: &[String], mut out: W) -> Result<(), WriteSvgError> {
    layout_fault::check(layout)?;
    let [width, height] = layout.sheet;
    let mut document = ::svg::Document::new()
        .set("width", format!("{}mm", decimal(width)))
        .set("height", format!("{}mm", decimal(height)))
        .set("viewBox", format!("0 0 {} {}", decimal(width), decimal(height)));
    for comment in comments {
        document = document.add(Comment::new(comment_text(comment)));
    }
    for engraving in &layout.engravings {
        document = document.add(text_element(&engraving.label, &ENGRAVE, height));
    }
    for path in &layout.paths {
        document = document.add(path_element(path, height));
    }
    for note in &layout.notes {
        document = document.add(text_element(note, &NOTE, height));
    }
    ::svg::write(&mut out, &document)?;
    out.write_all(b"\n")?;
    Ok(out.flush()?)
}

fn path_element(path: &CutPath, sheet_height: f64) -> Path {
    let layer = layer_of(path.kind);
    Path::new()
        .set("class", layer.class)
        .set("fill", "none")
        .set("stroke", layer.rgb)
        .set("stroke-width", HAIRLINE)
        .set("d", path_data(path, sheet_height))
}

fn text_element(note: &Note, layer: &Layer, sheet_height: f64) -> Text {
    Text::new(plain_line(&note.text))
        .set("class", layer.class)
        .set("fill", layer.rgb)
        .set("font-family", "sans-serif")
        .set("font-size", decimal(note.height / CAP_HEIGHT))
        .set("x", decimal(note.position.x))
        .set("y", decimal(sheet_height - note.position.y))
}

/// The `d` attribute: the svg crate's own path data holds f32, so the string is made here.
fn path_data(path: &CutPath, sheet_height: f64) -> String {
    let at = |p: kurbo::Point| format!("{},{}", decimal(p.x), decimal(sheet_height - p.y));
    let vertices = &path.vertices;
    let mut data = format!("M{}", at(vertices[0].point));
    let next = vertices.iter().skip(1).chain(path.closed.then_some(&vertices[0]));
    for (from, to) in vertices.iter().zip(next) {
        match BulgeArc::new(from.point, to.point, from.bulge, FLAT) {
            None => _ = write!(data, " L{}", at(to.point)),
            Some(arc) => push_arc(&mut data, &arc, at, to.point),
        }
    }
    if path.closed {
        data.push_str(" Z");
    }
    data
}

/// Appends an arc in parts of at most a quarter turn: near a half turn the centre that a reader computes from
/// rounded ends and radius is off by the square root of the rounding, and the large-arc flag hangs on it.
fn push_arc(data: &mut String, arc: &BulgeArc, at: impl Fn(kurbo::Point) -> String, end: kurbo::Point) {
    // A quarter turn whose bulge is rounded up stays one part.
    let parts = (arc.sweep.abs() / std::f64::consts::FRAC_PI_2 - 1e-9).ceil().max(1.0) as usize;
    // Counter-clockwise with y up is against the positive angle direction of SVG, where y points down.
    let sweep_flag = if arc.sweep > 0.0 { 0 } else { 1 };
    let radius = decimal(arc.radius);
    for part in 1..=parts {
        let to = if part == parts { end } else { arc.point(part as f64 / parts as f64) };
        _ = write!(data, " A{radius},{radius} 0 0 {sweep_flag} {}", at(to));
    }
}

/// A number with at most six decimals, without exponent, trailing zeros or negative zero.
fn decimal(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// XML forbids two hyphens in a row inside a comment.
fn comment_text(comment: &str) -> String {
    let mut text = plain_line(comment);
    while text.contains("--") {
        text = text.replace("--", "- -");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::layout::{CutKind, PathVertex};
    use kurbo::Point;

    fn vertex(x: f64, y: f64, bulge: f64) -> PathVertex {
        PathVertex { point: Point::new(x, y), bulge }
    }

    #[test]
    fn numbers_have_no_exponent_no_trailing_zeros_and_no_negative_zero() {
        let shown = [0.0, -0.0, -1e-9, 1e-7, 10.0, 100.5, 0.1234564, 0.1234566, -2.5, 1e9, 10.123456789];
        let texts: Vec<String> = shown.iter().map(|&v| decimal(v)).collect();
        let expected =
            ["0", "0", "0", "0", "10", "100.5", "0.123456", "0.123457", "-2.5", "1000000000", "10.123457"];
        assert_eq!(texts, expected);
    }

    #[test]
    fn lines_and_arcs_with_y_flipped() {
        // On a sheet 100 mm high: along x, then a quarter turn to the left up to (12, 7), radius 2.
        let vertices = vec![
            vertex(1.0, 5.0, 0.0),
            vertex(10.0, 5.0, (std::f64::consts::PI / 8.0).tan()),
            vertex(12.0, 7.0, 0.0),
        ];
        let mut path = CutPath { kind: CutKind::Slit, vertices, closed: false };
        assert_eq!(path_data(&path, 100.0), "M1,95 L10,95 A2,2 0 0 0 12,93");
        path.closed = true;
        assert_eq!(path_data(&path, 100.0), "M1,95 L10,95 A2,2 0 0 0 12,93 L1,95 Z");
    }

    #[test]
    fn half_turns_are_split_and_clockwise_sets_the_flag() {
        let vertices = vec![vertex(0.0, 0.0, -1.0), vertex(2.0, 0.0, 0.0)];
        let path = CutPath { kind: CutKind::Slit, vertices, closed: false };
        // Clockwise from (0, 0) to (2, 0) about (1, 0): over (1, 1), which is at picture y = 9.
        assert_eq!(path_data(&path, 10.0), "M0,10 A1,1 0 0 1 1,9 A1,1 0 0 1 2,10");
    }

    #[test]
    fn comments_cannot_end_early() {
        assert_eq!(comment_text("a --> b\n---"), "a - -> b - - -");
    }
}
