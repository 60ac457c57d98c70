//! What a machine file cannot hold: checked before the first byte is written, so that a fault leaves nothing
//! behind. Whether the cuts make sense (duplicates, overlaps, order) is not asked here.

use crate::fabrication::layout::{CutLayout, CutPath, Note};

use super::layer_of;

/// Shortest segment that is written, millimetres: the last digit of the SVG. A shorter one would be written as
/// two equal points, on which machines dwell and burn.
pub const MIN_SEGMENT: f64 = 1e-6;

/// Largest |bulge| that is written: beyond it an arc is a full circle but for 0.004 rad, which no cut of ours
/// is, and readers differ in what they make of it.
pub const MAX_BULGE: f64 = 1e3;

/// A layout that cannot be written. Indices count from 0 in cutting order.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LayoutFault {
    /// The stock has no area.
    #[error("sheet size {width} x {height} mm: both must be finite and above 0; check the profile's sheet")]
    Sheet {
        /// Size in x, millimetres.
        width: f64,
        /// Size in y, millimetres.
        height: f64,
    },
    /// A path without a segment.
    #[error("cut {path} ({layer}): {count} vertices; a cut needs at least 2")]
    TooFewVertices {
        /// Index of the cut.
        path: usize,
        /// Its layer.
        layer: &'static str,
        /// Number of vertices.
        count: usize,
    },
    /// NaN or infinite coordinate or bulge.
    #[error("cut {path} ({layer}), vertex {vertex}: ({x}, {y}) mm with bulge {bulge} is not finite")]
    NotFinite {
        /// Index of the cut.
        path: usize,
        /// Its layer.
        layer: &'static str,
        /// Index of the vertex.
        vertex: usize,
        /// x, millimetres.
        x: f64,
        /// y, millimetres.
        y: f64,
        /// Bulge.
        bulge: f64,
    },
    /// Two vertices in one place.
    #[error(
        "cut {path} ({layer}), segment {segment}: {length} mm long, the least is {MIN_SEGMENT} mm; merge its two vertices"
    )]
    ShortSegment {
        /// Index of the cut.
        path: usize,
        /// Its layer.
        layer: &'static str,
        /// Index of the segment's first vertex.
        segment: usize,
        /// Distance between its ends, millimetres.
        length: f64,
    },
    /// An arc that is nearly a full circle.
    #[error(
        "cut {path} ({layer}), vertex {vertex}: |bulge| {bulge} must be below {MAX_BULGE}; split the arc in two"
    )]
    LargeBulge {
        /// Index of the cut.
        path: usize,
        /// Its layer.
        layer: &'static str,
        /// Index of the vertex.
        vertex: usize,
        /// The bulge.
        bulge: f64,
    },
    /// A bulge that leads nowhere.
    #[error(
        "cut {path} ({layer}): the last vertex of an open path has bulge {bulge} but no segment; set it to 0"
    )]
    DanglingBulge {
        /// Index of the cut.
        path: usize,
        /// Its layer.
        layer: &'static str,
        /// The bulge.
        bulge: f64,
    },
    /// A text that cannot be placed.
    #[error(
        "note {note}: position ({x}, {y}) mm must be finite and letter height {height} mm finite and above 0"
    )]
    BadNote {
        /// Index of the note.
        note: usize,
        /// x, millimetres.
        x: f64,
        /// y, millimetres.
        y: f64,
        /// Letter height, millimetres.
        height: f64,
    },
}

/// Checks every number of a layout against what machine files can hold.
///
/// # Errors
/// The first fault, in cutting order.
pub fn check(layout: &CutLayout) -> Result<(), LayoutFault> {
    let [width, height] = layout.sheet;
    if !(width.is_finite() && height.is_finite() && width > 0.0 && height > 0.0) {
        return Err(LayoutFault::Sheet { width, height });
    }
    for (index, path) in layout.paths.iter().enumerate() {
        check_path(index, path)?;
    }
    let labels = layout.engravings.iter().map(|engraving| &engraving.label);
    for (note, Note { position, height, .. }) in layout.notes.iter().chain(labels).enumerate() {
        if !(position.is_finite() && height.is_finite() && *height > 0.0) {
            return Err(LayoutFault::BadNote { note, x: position.x, y: position.y, height: *height });
        }
    }
    Ok(())
}

fn check_path(path: usize, cut: &CutPath) -> Result<(), LayoutFault> {
    let layer = layer_of(cut.kind).name;
    let vertices = &cut.vertices;
    let count = vertices.len();
    if count < 2 {
        return Err(LayoutFault::TooFewVertices { path, layer, count });
    }
    for (vertex, v) in vertices.iter().enumerate() {
        let (x, y, bulge) = (v.point.x, v.point.y, v.bulge);
        if !(x.is_finite() && y.is_finite() && bulge.is_finite()) {
            return Err(LayoutFault::NotFinite { path, layer, vertex, x, y, bulge });
        }
        if bulge.abs() >= MAX_BULGE {
            return Err(LayoutFault::LargeBulge { path, layer, vertex, bulge });
        }
    }
    let segments = if cut.closed { count } else { count - 1 };
    for segment in 0..segments {
        let length = vertices[segment].point.distance(vertices[(segment + 1) % count].point);
        if length < MIN_SEGMENT {
            return Err(LayoutFault::ShortSegment { path, layer, segment, length });
        }
    }
    let bulge = vertices[count - 1].bulge;
    if !cut.closed && bulge != 0.0 {
        return Err(LayoutFault::DanglingBulge { path, layer, bulge });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::layout::{CutKind, PathVertex};
    use kurbo::Point;

    fn layout(closed: bool, vertices: &[(f64, f64, f64)]) -> CutLayout {
        let vertices = vertices.iter().map(|&(x, y, bulge)| PathVertex { point: Point::new(x, y), bulge });
        let path = CutPath { kind: CutKind::Slit, vertices: vertices.collect(), closed };
        CutLayout { sheet: [10.0, 10.0], kerf: 0.05, engravings: vec![], paths: vec![path], notes: vec![] }
    }

    #[test]
    fn names_the_fault_and_the_place() {
        let fault = |closed, vertices| check(&layout(closed, vertices)).unwrap_err().to_string();
        assert!(fault(false, &[(0.0, 0.0, 0.0)]).starts_with("cut 0 (SLIT): 1 vertices"));
        assert!(fault(false, &[(0.0, 0.0, 0.0), (f64::NAN, 1.0, 0.0)]).contains("vertex 1: (NaN, 1) mm"));
        assert!(fault(false, &[(0.0, 0.0, f64::INFINITY), (1.0, 1.0, 0.0)]).contains("bulge inf"));
        assert!(fault(false, &[(1.0, 1.0, 0.0), (1.0, 1.0, 0.0)]).contains("segment 0: 0 mm"));
        assert!(fault(false, &[(0.0, 0.0, -1000.0), (1.0, 1.0, 0.0)]).contains("|bulge| -1000"));
        assert!(fault(false, &[(0.0, 0.0, 0.0), (1.0, 1.0, 0.5)]).contains("last vertex of an open path"));
    }

    #[test]
    fn the_closing_segment_counts_only_on_closed_paths() {
        let vertices = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)];
        assert_eq!(check(&layout(false, &vertices)), Ok(()));
        assert!(matches!(check(&layout(true, &vertices)), Err(LayoutFault::ShortSegment { segment: 2, .. })));
    }

    #[test]
    fn refuses_a_sheet_without_area_and_a_note_without_place() {
        let good = layout(false, &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]);
        for sheet in [[0.0, 1.0], [1.0, -1.0], [f64::NAN, 1.0], [1.0, f64::INFINITY]] {
            let bad = CutLayout { sheet, ..good.clone() };
            assert!(matches!(check(&bad), Err(LayoutFault::Sheet { .. })));
        }
        for (x, height) in [(f64::NAN, 3.0), (0.0, 0.0), (0.0, f64::NAN)] {
            let note = Note { position: Point::new(x, 0.0), height, text: "a".into() };
            let bad = CutLayout { notes: vec![note], ..good.clone() };
            assert!(matches!(check(&bad), Err(LayoutFault::BadNote { note: 0, .. })));
        }
    }
}
