//! What the grooves leave of the sheet around one piece: so that the outlines of all pieces take time in proportion to
//! their number, and every piece can be looked at beside the others.

use kurbo::Rect;
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::cuts::ARC_TOLERANCE;
use super::error::FabricationError;
use super::layout::{CutKind, CutPath};
use super::ligament::MeasuredLigament;
use super::outline::{
    Contour, Shape, area, centroid, contains, contour_box, inner_point, ligament_region, stroke, subtract,
};
use super::states::sheet_vertices;
use crate::kirigami::design::Design;

/// A region that comes this near to the edge of the box in which it was looked for may go on beyond it, millimetres.
const AT_EDGE: f64 = 1e-4;

/// The box of a path or of one of its segments, with the indices of both.
type Segment = GeomWithData<Rectangle<[f64; 2]>, (usize, usize)>;

/// The cuts by place.
struct Cuts<'a> {
    paths: &'a [CutPath],
    /// Every path as points.
    lines: Vec<Contour>,
    /// The grooves of open paths.
    grooves: Vec<Vec<Shape>>,
    /// Boxes of the open paths, and of each segment of the closed ones: the path's index and the segment's.
    tree: RTree<Segment>,
    /// The box of them all.
    bounds: Rect,
    kerf: f64,
}

impl<'a> Cuts<'a> {
    fn new(paths: &'a [CutPath], kerf: f64) -> Self {
        let points = |path: &CutPath| -> Contour {
            path.flatten(ARC_TOLERANCE).into_iter().map(|point| [point.x, point.y]).collect()
        };
        let lines: Vec<Contour> = paths.par_iter().map(points).collect();
        let groove = |(path, line): (&CutPath, &Contour)| {
            if path.closed { Vec::new() } else { stroke(vec![line.clone()], kerf, false) }
        };
        let grooves = paths.par_iter().zip(&lines).map(groove).collect();
        let item = |index: usize, segment: usize, part: &[[f64; 2]]| {
            let Rect { x0, y0, x1, y1 } = contour_box(part);
            GeomWithData::new(Rectangle::from_corners([x0, y0], [x1, y1]), (index, segment))
        };
        let mut items = Vec::with_capacity(paths.len());
        for (index, (path, line)) in paths.iter().zip(&lines).enumerate() {
            if path.closed {
                let segment = |k: usize| item(index, k, &[line[k], line[(k + 1) % line.len()]]);
                items.extend((0..line.len()).map(segment));
            } else {
                items.push(item(index, 0, line));
            }
        }
        let bounds = lines.iter().fold(contour_box(&[]), |all, line| all.union(contour_box(line)));
        Cuts { paths, lines, grooves, tree: RTree::bulk_load(items), bounds, kerf }
    }

    /// The grooves in a box; outside of it they may end anywhere.
    fn grooves(&self, place: Rect) -> Vec<Shape> {
        let near = place.inflate(self.kerf, self.kerf);
        let corners = AABB::from_corners([near.x0, near.y0], [near.x1, near.y1]);
        let mut found: Vec<(usize, usize)> =
            self.tree.locate_in_envelope_intersecting(&corners).map(|item| item.data).collect();
        found.sort_unstable();
        let (mut grooves, mut open, mut closed) = (Vec::new(), Vec::new(), Vec::new());
        for run in found.chunk_by(|a, b| a.0 == b.0) {
            let index = run[0].0;
            let line = &self.lines[index];
            if !self.paths[index].closed {
                let parts = self.grooves[index].iter().flatten().map(|contour| clipped(contour, near));
                grooves.extend(parts.filter(|part| part.len() > 2).map(|part| vec![part]));
            } else if run.len() == line.len() {
                closed.push(line.clone());
            } else {
                let parts = run.chunk_by(|a, b| a.1 + 1 == b.1);
                let part = |part: &[(usize, usize)]| -> Contour {
                    (part[0].1..=part[part.len() - 1].1 + 1).map(|k| line[k % line.len()]).collect()
                };
                open.extend(parts.map(part));
            }
        }
        for (lines, closed) in [(open, false), (closed, true)] {
            if !lines.is_empty() {
                grooves.extend(stroke(lines, self.kerf, closed));
            }
        }
        grooves
    }

    /// Whether a point lies in the sheet: inside of the border and of no window.
    fn in_sheet(&self, point: [f64; 2]) -> bool {
        let around = |kind: CutKind| {
            let closed = self.paths.iter().zip(&self.lines).filter(|(path, _)| path.kind == kind);
            closed.into_iter().any(|(_, line)| contains(line, point))
        };
        around(CutKind::Border) && !around(CutKind::Window)
    }
}

/// The pieces by their middles.
struct Middles {
    of: Vec<[f64; 2]>,
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

impl Middles {
    fn new(design: &Design, kerf: f64) -> Self {
        let middle = |piece| {
            let polygon: Contour = sheet_vertices(design, piece).iter().map(|p| [p.x, p.y]).collect();
            inner_point(&polygon, kerf)
        };
        let of: Vec<[f64; 2]> = design.pieces.par_iter().map(middle).collect();
        let tree = of.iter().enumerate().map(|(piece, &at)| GeomWithData::new(at, piece)).collect();
        Middles { of, tree: RTree::bulk_load(tree) }
    }

    /// The first piece other than `except` whose middle lies in a region.
    fn in_region(&self, region: &Shape, except: Option<usize>) -> Option<usize> {
        let Rect { x0, y0, x1, y1 } = contour_box(&region[0]);
        let inside = self.tree.locate_in_envelope(&AABB::from_corners([x0, y0], [x1, y1]));
        let inside = inside.map(|item| item.data).filter(|&piece| Some(piece) != except);
        inside.filter(|&piece| holds(region, self.of[piece])).min()
    }
}

/// The part of a contour in a box. Where it leaves the box and comes back it runs along the box's edge, maybe twice.
fn clipped(contour: &Contour, place: Rect) -> Contour {
    let Rect { x0, y0, x1, y1 } = place;
    let mut points = contour.clone();
    // Per side of the box: the coordinate, its bound, and on which side of it lies the box.
    for (axis, bound, sign) in [(0, x0, 1.0), (0, x1, -1.0), (1, y0, 1.0), (1, y1, -1.0)] {
        let depth = |point: &[f64; 2]| sign * (point[axis] - bound);
        if points.iter().all(|point| depth(point) >= 0.0) {
            continue;
        }
        let mut kept = Vec::with_capacity(points.len());
        for (i, b) in points.iter().enumerate() {
            let a = &points[(i + points.len() - 1) % points.len()];
            let [s, t] = [depth(a), depth(b)];
            if (s < 0.0) != (t < 0.0) {
                let part = s / (s - t);
                kept.push([0, 1].map(|k| a[k] + part * (b[k] - a[k])));
            }
            if t >= 0.0 {
                kept.push(*b);
            }
        }
        points = kept;
    }
    points
}

/// Whether a point lies in a region and in none of its holes.
fn holds(region: &Shape, point: [f64; 2]) -> bool {
    contains(&region[0], point) && !region[1..].iter().any(|hole| contains(hole, point))
}

/// The true outline of every piece, counter-clockwise, without its halves of the ligaments, in the pieces' order.
///
/// `paths`: all cuts; `ligaments`: measured on them. Scraps smaller than a kerf square are ignored.
///
/// # Errors
/// Scraps that come free, pieces that vanish, hang together or are pierced.
pub fn piece_outlines(
    design: &Design,
    paths: &[CutPath],
    ligaments: &[MeasuredLigament],
    kerf: f64,
) -> Result<Vec<Contour>, FabricationError> {
    let cuts = Cuts::new(paths, kerf);
    let middles = Middles::new(design, kerf);
    let mut held = vec![Vec::new(); design.pieces.len()];
    for (hinge, ligament) in design.hinges.iter().zip(ligaments) {
        hinge.pieces.iter().for_each(|&piece| held[piece].push(ligament_region(ligament)));
    }
    let outline = |piece: usize| {
        let polygon: Contour =
            sheet_vertices(design, &design.pieces[piece]).iter().map(|p| [p.x, p.y]).collect();
        piece_region(&cuts, &middles, piece, contour_box(&polygon), &held[piece])
    };
    let found: Vec<Result<Contour, FabricationError>> =
        (0..design.pieces.len()).into_par_iter().map(outline).collect();
    found.into_iter().collect()
}

/// The region of a piece that lies about `place`.
fn piece_region(
    cuts: &Cuts<'_>,
    middles: &Middles,
    piece: usize,
    place: Rect,
    ligaments: &[Contour],
) -> Result<Contour, FabricationError> {
    let [x, y] = middles.of[piece];
    let error = |reason: String| FabricationError::PieceRegion { piece, x, y, reason };
    let gone = || error("is burned away or cut through at its centre".into());
    let scrap = cuts.kerf * cuts.kerf;
    let mut margin = 2.0 * cuts.kerf + 0.04 * (place.width() + place.height());
    loop {
        let place = place.inflate(margin, margin);
        let (mut own, mut others) = (None, Vec::new());
        for region in in_box(cuts, place, ligaments) {
            if holds(&region, [x, y]) { own = Some(region) } else { others.push(region) }
        }
        let own = own.ok_or_else(gone)?;
        if let Some(other) = middles.in_region(&own, Some(piece)) {
            return Err(error(format!("still hangs together with piece {other} beside the ligaments")));
        }
        if at_edge(&own, place) {
            let everything = cuts.bounds.inflate(cuts.kerf, cuts.kerf);
            if place.union(everything) == place {
                return Err(gone());
            }
            margin *= 2.0;
            continue;
        }
        if own[1..].iter().any(|hole| area(hole).abs() > scrap) {
            return Err(error("is pierced by a cut".into()));
        }
        let free = |region: &&Shape| {
            let size = area(&region[0]);
            let falls = size > scrap && !at_edge(region, place) && middles.in_region(region, None).is_none();
            falls && cuts.in_sheet(inner_point(&region[0], 0.0))
        };
        if let Some(region) = others.iter().find(free) {
            let [x, y] = centroid(&region[0]);
            return Err(FabricationError::FallsApart { area: area(&region[0]), x, y });
        }
        return Ok(own.into_iter().next().unwrap_or_default());
    }
}

/// What grooves and ligaments leave of a box.
fn in_box(cuts: &Cuts<'_>, place: Rect, ligaments: &[Contour]) -> Vec<Shape> {
    let Rect { x0, y0, x1, y1 } = place;
    let sheet = vec![vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]];
    let mut burned = cuts.grooves(place);
    burned.extend(ligaments.iter().map(|ligament| vec![ligament.clone()]));
    subtract(&sheet, &burned)
}

fn at_edge(region: &Shape, place: Rect) -> bool {
    let Rect { x0, y0, x1, y1 } = place.inflate(-AT_EDGE, -AT_EDGE);
    let Rect { x0: left, y0: low, x1: right, y1: high } = contour_box(&region[0]);
    left <= x0 || low <= y0 || right >= x1 || high >= y1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabrication::outline::area;

    #[test]
    fn a_clipped_contour_has_the_area_that_is_in_the_box() {
        // A U of 3 x 3 with a slot of 1 x 2 from above; the box cuts both of its legs.
        let points = [[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.]];
        for (place, expected) in [
            (Rect::new(-1.0, -1.0, 4.0, 4.0), 7.0),
            (Rect::new(-1.0, 2.0, 4.0, 4.0), 2.0),
            (Rect::new(0.5, 0.5, 2.5, 2.0), 2.0),
            (Rect::new(1.2, 1.5, 1.8, 2.5), 0.0),
            (Rect::new(5.0, 5.0, 6.0, 6.0), 0.0),
        ] {
            let part = clipped(&points.to_vec(), place);
            let closed: Contour = part.iter().chain(part.first()).copied().collect();
            assert!((area(&closed) - expected).abs() < 1e-12, "{place:?} {part:?}");
            let whole = place.inflate(1e-12, 1e-12);
            assert!(part.iter().all(|&[x, y]| whole.contains(kurbo::Point::new(x, y))));
        }
    }
}
