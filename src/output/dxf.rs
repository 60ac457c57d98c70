//! `cut.dxf`: R2000 with LWPOLYLINE and bulges, or R12 with LINE and ARC for old controllers.
//!
//! The dxf crate writes the bulk; `PairFilter` mends on the way out what readers reject (table heads without
//! handles, subclass markers in R12) and what would differ from run to run (dates and identifiers). Every entity
//! is in cutting order on the layer of its kind: SLIT, RELIEF, WINDOW, BORDER and LEAD are cut, ENGRAVE (which comes
//! first) is not cut through, NOTE is nothing for the machine. LEAD and ENGRAVE are there only where they are used.
//! Coordinates have twelve decimals. The same layout gives the same bytes, in every time zone.

mod pair_filter;

use std::io::{self, Write};

use dxf::entities::{Arc, Entity, EntityType, Line, LwPolyline, Text};
use dxf::enums::{AcadVersion, DrawingUnits, Units};
use dxf::tables::Layer as DxfLayer;
use dxf::{Color, Drawing, Handle, LwPolylineVertex, Point};

use crate::fabrication::layout::{CutKind, CutLayout, CutPath, Note};

use super::bulge_arc::BulgeArc;
use super::layout_fault::{self, LayoutFault};
use super::{BORDER, ENGRAVE, LEAD, NOTE, RELIEF, SLIT, WINDOW, layer_of, plain_line};
use pair_filter::PairFilter;

/// Which DXF is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DxfVersion {
    /// AC1015: millimetres in the header, each cut one LWPOLYLINE, arcs as bulges.
    #[default]
    R2000,
    /// AC1009: each segment one LINE or ARC, without POLYLINE, which some laser programs ignore. It has no place
    /// for units and none for the direction of a clockwise arc.
    R12,
}

/// Why no DXF was written.
#[derive(Debug, thiserror::Error)]
pub enum WriteDxfError {
    /// The layout holds something that cannot be drawn.
    #[error(transparent)]
    Layout(#[from] LayoutFault),
    /// The dxf crate or the output failed.
    #[error("cannot write the DXF: {0}")]
    Dxf(#[from] dxf::DxfError),
    /// The output refused the bytes.
    #[error("cannot write the DXF: {0}")]
    Io(#[from] io::Error),
}

/// Handles kept free for the table heads, of which the crate writes nine.
const TABLE_HANDLES: u64 = 16;

/// In R12, arcs that leave their chord by less than this are LINEs, millimetres: their radius, up to 1e9 mm and
/// more, would lose more in the twelve decimals than the straight line does.
const FLAT: f64 = 1e-6;

/// Longest comment line, bytes; 255 is the limit of R12 readers.
const COMMENT_BYTES: usize = 250;

/// Writes a layout as DXF, with the comments (group 999) at its head.
///
/// # Errors
/// A layout fault, before anything is written, or the error of `out`.
pub fn write<W: Write>(
    layout: &CutLayout,
    version: DxfVersion,
    comments: &[String],
    mut out: W,
) -> Result<(), WriteDxfError> {
    layout_fault::check(layout)?;
    let mut drawing = empty_drawing(layout, version);
    let first_table_handle = drawing.header.next_available_handle.0;
    drawing.header.next_available_handle = Handle(first_table_handle + TABLE_HANDLES);
    for stroke in layout.engravings.iter().flat_map(|engraving| &engraving.strokes) {
        match version {
            DxfVersion::R2000 => add(&mut drawing, ENGRAVE.name, EntityType::LwPolyline(stroke_line(stroke))),
            DxfVersion::R12 => stroke.windows(2).for_each(|pair| {
                add(&mut drawing, ENGRAVE.name, EntityType::Line(Line::new(at(pair[0]), at(pair[1]))));
            }),
        }
    }
    for path in &layout.paths {
        let layer = layer_of(path.kind).name;
        match version {
            DxfVersion::R2000 => add(&mut drawing, layer, EntityType::LwPolyline(polyline(path))),
            DxfVersion::R12 => segments(path).into_iter().for_each(|s| add(&mut drawing, layer, s)),
        }
    }
    for note in layout.notes.iter().filter(|note| !note.text.trim().is_empty()) {
        add(&mut drawing, NOTE.name, EntityType::Text(text(note)));
    }
    for comment in comments {
        write_comment(comment, &mut out)?;
    }
    let mut filter = PairFilter::new(&mut out, version, first_table_handle);
    drawing.save(&mut filter)?;
    filter.finish()?;
    Ok(out.flush()?)
}

/// Header, layers and the view of a drawing; `Drawing::new` alone is R12 in no units.
fn empty_drawing(layout: &CutLayout, version: DxfVersion) -> Drawing {
    let mut drawing = Drawing::new();
    let [width, height] = layout.sheet;
    let header = &mut drawing.header;
    header.version = match version {
        DxfVersion::R2000 => AcadVersion::R2000,
        DxfVersion::R12 => AcadVersion::R12,
    };
    header.default_drawing_units = Units::Millimeters;
    header.drawing_units = DrawingUnits::Metric;
    header.maximum_drawing_limits = Point::new(width, height, 0.0);
    header.maximum_drawing_extents = Point::new(width, height, 0.0);
    let leads = layout.paths.iter().any(|path| path.kind == CutKind::Lead).then_some(&LEAD);
    let engraved = (!layout.engravings.is_empty()).then_some(&ENGRAVE);
    for layer in [&SLIT, &RELIEF, &WINDOW, &BORDER, &NOTE].into_iter().chain(leads).chain(engraved) {
        drawing.add_layer(DxfLayer {
            name: layer.name.to_string(),
            color: Color::from_index(layer.aci),
            is_layer_plotted: layer.name != NOTE.name,
            ..Default::default()
        });
    }
    for view in drawing.view_ports_mut() {
        view.view_center = Point::new(0.5 * width, 0.5 * height, 0.0);
        view.view_height = height;
    }
    drawing
}

fn add(drawing: &mut Drawing, layer: &str, specific: EntityType) {
    let mut entity = Entity::new(specific);
    entity.common.layer = layer.to_string();
    drawing.add_entity(entity);
}

fn stroke_line(points: &[kurbo::Point]) -> LwPolyline {
    let vertex = |p: &kurbo::Point| LwPolylineVertex { x: p.x, y: p.y, ..Default::default() };
    LwPolyline { vertices: points.iter().map(vertex).collect(), ..Default::default() }
}

fn polyline(path: &CutPath) -> LwPolyline {
    let mut polyline = LwPolyline::default();
    polyline.set_is_closed(path.closed);
    polyline.vertices = path
        .vertices
        .iter()
        // Group 42 is left out for 0, as everybody does: where it says 0.0, FreeCAD takes the side for an arc without an
        // end and drops the path.
        .map(|v| LwPolylineVertex { x: v.point.x, y: v.point.y, bulge: v.bulge, ..Default::default() })
        .collect();
    polyline
}

fn segments(path: &CutPath) -> Vec<EntityType> {
    let vertices = &path.vertices;
    let next = vertices.iter().skip(1).chain(path.closed.then_some(&vertices[0]));
    let segment =
        |from: kurbo::Point, to: kurbo::Point, bulge: f64| match BulgeArc::new(from, to, bulge, FLAT) {
            None => EntityType::Line(Line::new(at(from), at(to))),
            Some(arc) => {
                // An ARC is always counter-clockwise.
                let (start, end) = if bulge > 0.0 {
                    (arc.start, arc.start + arc.sweep)
                } else {
                    (arc.start + arc.sweep, arc.start)
                };
                EntityType::Arc(Arc::new(at(arc.center), arc.radius, turn(start), turn(end)))
            }
        };
    vertices.iter().zip(next).map(|(from, to)| segment(from.point, to.point, from.bulge)).collect()
}

fn text(note: &Note) -> Text {
    Text {
        location: at(note.position),
        text_height: note.height,
        value: plain_line(&note.text),
        ..Default::default()
    }
}

fn at(point: kurbo::Point) -> Point {
    Point::new(point.x, point.y, 0.0)
}

/// Degrees in [0, 360).
fn turn(radians: f64) -> f64 {
    radians.to_degrees().rem_euclid(360.0)
}

/// Writes a comment in as many lines as it needs; characters outside ASCII in the DXF's own escape.
fn write_comment<W: Write>(comment: &str, out: &mut W) -> io::Result<()> {
    let mut ascii = String::new();
    for c in plain_line(comment).chars() {
        match c.is_ascii() {
            true => ascii.push(c),
            false => ascii.push_str(&format!("\\U+{:04X}", u32::from(c))),
        }
    }
    for line in ascii.as_bytes().chunks(COMMENT_BYTES) {
        out.write_all(b"999\r\n")?;
        out.write_all(line)?;
        out.write_all(b"\r\n")?;
    }
    Ok(())
}
