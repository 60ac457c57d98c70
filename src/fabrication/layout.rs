//! The cut layout: what the machine is told to cut, in order.

use kurbo::Point;

/// What a cut is for; also its layer in the machine file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CutKind {
    /// An open path between two pieces.
    Slit,
    /// The bar of a T at a slit's end that frees the ligament.
    Relief,
    /// A closed cut around a hole of the sheet.
    Window,
    /// The closed outer cut, or a stretch of it between two tabs. Cut last.
    Border,
    /// An open path in scrap, from where the beam pierces to where the closed cut or stretch after it begins.
    Lead,
}

/// A vertex of a cut path and the shape of the segment that leaves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathVertex {
    /// Position on the sheet, millimetres.
    pub point: Point,
    /// tan(sweep/4) of the arc to the next vertex, positive counter-clockwise, 0 for a straight line (the DXF
    /// convention). The last vertex of an open path has 0.
    pub bulge: f64,
}

/// One cut: the centre line of the kerf.
#[derive(Debug, Clone, PartialEq)]
pub struct CutPath {
    /// Purpose and layer.
    pub kind: CutKind,
    /// Vertices in cutting direction; at least two.
    pub vertices: Vec<PathVertex>,
    /// Whether a last segment leads from the last vertex back to the first.
    pub closed: bool,
}

/// A text that is drawn but not cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Left end of the base line, millimetres.
    pub position: Point,
    /// Letter height, millimetres.
    pub height: f64,
    /// One line of text.
    pub text: String,
}

/// A text that is engraved but not cut through.
#[derive(Debug, Clone, PartialEq)]
pub struct Engraving {
    /// The text where it stands.
    pub label: Note,
    /// What the beam follows, millimetres: open paths of straight segments.
    pub strokes: Vec<Vec<Point>>,
}

/// What holds the part in the sheet after its border is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabs {
    /// The middle of each tab of the first copy, on the border's centre line, millimetres, in the border's sense.
    pub places: Vec<Point>,
    /// Width of the material that is left between the burned ends of the border's stretches, millimetres.
    pub width: f64,
}

/// All cuts of one sheet, in the order in which they are to be cut. The kerf is already applied: paths are
/// centre lines of the burned groove.
#[derive(Debug, Clone, PartialEq)]
pub struct CutLayout {
    /// Stock size in x and y, millimetres; the lower left corner is the origin.
    pub sheet: [f64; 2],
    /// Width of the burned groove, millimetres.
    pub kerf: f64,
    /// Texts that are engraved, before anything is cut.
    pub engravings: Vec<Engraving>,
    /// Cuts in cutting order: inner before outer, border last.
    pub paths: Vec<CutPath>,
    /// Texts on the non-cut layer.
    pub notes: Vec<Note>,
}

impl CutPath {
    /// The path as points on it whose chords stay within `tolerance` (> 0, millimetres) of its arcs. A closed
    /// path's first point is not repeated.
    pub fn flatten(&self, tolerance: f64) -> Vec<Point> {
        let mut points = Vec::with_capacity(self.vertices.len());
        for (i, vertex) in self.vertices.iter().enumerate() {
            points.push(vertex.point);
            let last = i + 1 == self.vertices.len();
            if vertex.bulge != 0.0 && (self.closed || !last) {
                let next = self.vertices[(i + 1) % self.vertices.len()].point;
                points.extend(arc_points(vertex.point, next, vertex.bulge, tolerance));
            }
        }
        points
    }

    /// The straight segments of [`CutPath::flatten`], with the closing one of a closed path.
    pub fn segments(&self, tolerance: f64) -> Vec<[Point; 2]> {
        let points = self.flatten(tolerance);
        let mut segments: Vec<_> = points.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        if self.closed && points.len() > 2 {
            segments.push([points[points.len() - 1], points[0]]);
        }
        segments
    }

    /// Length of the centre line, arcs as they are, millimetres.
    pub fn length(&self) -> f64 {
        let count = self.vertices.len();
        let segments = if self.closed { count } else { count.saturating_sub(1) };
        let segment = |i: usize| {
            let (from, to) = (self.vertices[i], self.vertices[(i + 1) % count].point);
            let (chord, bulge) = (from.point.distance(to), from.bulge.abs());
            // Radius times sweep; a quarter of the sweep is the bulge's arc tangent.
            if bulge < 1e-6 { chord } else { chord * (1.0 + bulge * bulge) / bulge * bulge.atan() }
        };
        (0..segments).map(segment).sum()
    }
}

/// Points strictly inside the arc from `from` to `to`.
fn arc_points(from: Point, to: Point, bulge: f64, tolerance: f64) -> Vec<Point> {
    let sweep = 4.0 * bulge.atan();
    let chord = to - from;
    // The rise of an arc over its chord c is |bulge| c/2. The centre of one that is next to straight is too far away to
    // be reckoned with.
    if 0.5 * bulge.abs() * chord.hypot() <= tolerance {
        return Vec::new();
    }
    // The centre lies to the left of the chord for a counter-clockwise arc of less than a half turn.
    let centre = from.midpoint(to) + (0.5 / (0.5 * sweep).tan()) * chord.turn_90();
    let radius = centre.distance(from);
    // A chord over the angle a leaves the arc by radius (1 - cos(a/2)).
    let step = 2.0 * (1.0 - (tolerance / radius).min(1.0)).acos();
    let count = (sweep.abs() / step).ceil().clamp(1.0, 1e4) as usize;
    let start = (from - centre).atan2();
    (1..count)
        .map(|i| centre + radius * kurbo::Vec2::from_angle(start + sweep * i as f64 / count as f64))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(from: Point, to: Point, bulge: f64) -> Vec<Point> {
        let vertices = [(from, bulge), (to, 0.0)].map(|(point, bulge)| PathVertex { point, bulge });
        CutPath { kind: CutKind::Border, vertices: vertices.into(), closed: false }.flatten(1e-4)
    }

    /// A damaged file had a bulge of 1e-300: the points lay beyond all numbers, and offsetting them panicked.
    #[test]
    fn an_arc_next_to_straight_is_its_chord() {
        let (from, to) = (Point::new(300.0, 200.0), Point::new(310.0, 201.0));
        for bulge in [5e-324, 1e-300, 1e-17, -1e-12, 1e-6] {
            assert_eq!(arc(from, to, bulge), [from, to], "{bulge}");
        }
        assert!(arc(from, to, 1e-3).len() > 2);
    }

    #[test]
    fn arcs_follow_the_dxf_convention() {
        let unit = |degrees: f64| kurbo::Vec2::from_angle(degrees.to_radians()).to_point();
        // From angle, to angle, counter-clockwise positive; around the origin with radius 1.
        for (from, to) in [(0.0, 90.0), (0.0, 180.0), (0.0, 300.0), (90.0, 0.0), (30.0, -200.0)] {
            let sweep: f64 = to - from;
            let points = arc(unit(from), unit(to), (sweep.to_radians() / 4.0).tan());
            assert!(points.len() > 10);
            for (i, point) in points.iter().enumerate() {
                // Equal steps on the unit circle, to rounding.
                let expected = unit(from + sweep * i as f64 / (points.len() - 1) as f64);
                assert!(point.distance(expected) < 1e-12, "{point:?} {expected:?}");
            }
            // The chord's sagitta stays within the tolerance.
            let step = sweep.to_radians().abs() / (points.len() - 1) as f64;
            assert!(1.0 - (0.5 * step).cos() <= 1e-4 * (1.0 + 1e-9));
        }
    }

    #[test]
    fn closed_paths_have_a_closing_segment() {
        let points = [(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)];
        let vertices = points.map(|(x, y)| PathVertex { point: Point::new(x, y), bulge: 0.0 });
        let mut path = CutPath { kind: CutKind::Window, vertices: vertices.into(), closed: true };
        let length = |path: &CutPath| path.segments(1e-3).iter().map(|[a, b]| a.distance(*b)).sum::<f64>();
        assert_eq!((path.flatten(1e-3).len(), length(&path)), (3, 12.0));
        path.closed = false;
        assert_eq!((path.flatten(1e-3).len(), length(&path)), (3, 7.0));
    }
}
