//! What is left of the sheet: one body that holds every piece.
//!
//! Grooves that meet form a cluster; clusters are apart from each other. So the sheet falls apart exactly where one
//! cluster goes round something. Most clusters are trees of a few cuts, which go round nothing; the others are united
//! and their holes counted. That takes time in proportion to the number of pieces, where the union of all grooves
//! would not.

use std::collections::BTreeMap;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use kurbo::{Point, Rect};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::Wanted;
use super::contacts::Contacts;
use super::cut_name;
use super::fault::{Check, Fault};
use super::grooves::{FLAT, Grooves};
use super::machine_file::MachineFile;
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::outline::{Contour, area, contour_box, inner_point, stroke};
use crate::fabrication::states::sheet_vertices;
use crate::geometry::union_find::UnionFind;

/// What the burned sheet holds.
pub(super) struct Burned {
    /// Number of bodies.
    pub bodies: usize,
    /// Number of pieces in the part.
    pub pieces_held: usize,
}

/// Counts bodies and pieces.
pub(super) fn check(
    file: &MachineFile,
    border: usize,
    grooves: &Grooves,
    contacts: &Contacts,
    wanted: Wanted,
    faults: &mut Vec<Fault>,
) -> Burned {
    let kerf = wanted.profile.cut.kerf;
    let windows = Windows::new(&file.paths);
    let falling = falling_out(&file.paths, border, contacts, kerf, &windows);
    for (at, size, path) in &falling {
        let says = format!("{size:.4} mm2 falls out inside of it; the part must be one body");
        faults.push(Fault::new(Check::Body, file.name, cut_name(&file.paths, *path), *at, says));
    }
    check_scrap(file, border, &windows, faults);
    let outside = Windows::of(&file.paths, |path| path.kind == CutKind::Border);
    let pieces = &wanted.design.pieces;
    let lost: Vec<Option<(Point, &str)>> = pieces
        .par_iter()
        .map(|piece| {
            let vertices = sheet_vertices(wanted.design, piece);
            let polygon: Vec<[f64; 2]> = vertices.iter().map(|v| [v.x, v.y]).collect();
            let [x, y] = inner_point(&polygon, kerf);
            let middle = Point::new(x, y);
            let burned = grooves.nearest(middle).is_none_or(|(distance, _)| distance <= 0.5 * kerf);
            let reason = match (outside.around(middle), windows.around(middle)) {
                (None, _) => "its middle is outside of the border",
                (_, Some(_)) => "its middle falls out with a window",
                _ if burned => "its middle is burned away",
                _ => return None,
            };
            Some((middle, reason))
        })
        .collect();
    for (piece, (at, reason)) in lost.iter().enumerate().filter_map(|(i, lost)| lost.map(|lost| (i, lost))) {
        faults.push(Fault::new(Check::Body, file.name, format!("piece {piece}"), at, reason));
    }
    let pieces_held = lost.iter().filter(|lost| lost.is_none()).count();
    Burned { bodies: 1 + falling.len(), pieces_held }
}

/// Closed cuts by place.
struct Windows<'a> {
    paths: &'a [CutPath],
    contours: Vec<(usize, Contour)>,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
    /// Sides of the contours, where there is one only; for rays.
    sides: Option<Grooves<'a>>,
}

impl<'a> Windows<'a> {
    fn new(paths: &'a [CutPath]) -> Self {
        Self::of(paths, |path| path.kind == CutKind::Window)
    }

    fn of(paths: &'a [CutPath], wanted: impl Fn(&CutPath) -> bool) -> Self {
        let closed = paths.iter().enumerate().filter(|(_, path)| path.closed && wanted(path));
        let contours: Vec<_> = closed.map(|(index, path)| (index, contour(path))).collect();
        let item = |(i, (_, contour)): (usize, &(usize, Contour))| {
            let Rect { x0, y0, x1, y1 } = contour_box(contour);
            GeomWithData::new(Rectangle::from_corners([x0, y0], [x1, y1]), i)
        };
        let tree = RTree::bulk_load(contours.iter().enumerate().map(item).collect());
        let sides = match contours[..] {
            [(index, _)] => Some(Grooves::new(&paths[index..=index])),
            _ => None,
        };
        Self { paths, contours, tree, sides }
    }

    /// The first cut that goes round a point.
    fn around(&self, point: Point) -> Option<usize> {
        if let Some(sides) = &self.sides {
            // One large contour: only the sides that a ray meets are looked at.
            let ray = Rect::new(point.x, point.y, 2.0 * self.reach(), point.y);
            let crossings = sides.near(ray).filter(|&side| crosses(sides.segments[side].ends, point)).count();
            return (crossings % 2 == 1).then(|| self.contours[0].0);
        }
        let at = AABB::from_point([point.x, point.y]);
        let near = self.tree.locate_in_envelope_intersecting(&at);
        let inside = |i: &usize| {
            let contour = &self.contours[*i].1;
            let sides = (0..contour.len()).map(|k| [contour[k], contour[(k + 1) % contour.len()]]);
            sides.filter(|side| crosses(side.map(|[x, y]| Point::new(x, y)), point)).count() % 2 == 1
        };
        near.map(|item| item.data).filter(inside).map(|i| self.contours[i].0).min()
    }

    fn reach(&self) -> f64 {
        self.contours.iter().map(|(_, contour)| contour_box(contour).x1.abs()).fold(1.0, f64::max)
    }

    /// Where a cut begins, for messages.
    fn first_point(&self, index: usize) -> Point {
        self.paths[index].vertices[0].point
    }
}

/// Whether the ray from a point to the right crosses a side.
fn crosses([a, b]: [Point; 2], point: Point) -> bool {
    (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
}

fn contour(path: &CutPath) -> Contour {
    path.flatten(FLAT).into_iter().map(|point| [point.x, point.y]).collect()
}

/// Where something falls out beside what windows cut out, how large it is, and a cut of the cluster around it.
fn falling_out(
    paths: &[CutPath],
    border: usize,
    contacts: &Contacts,
    kerf: f64,
    windows: &Windows,
) -> Vec<(Point, f64, usize)> {
    let mut sets = UnionFind::new(paths.len());
    let mut links: Vec<(usize, bool)> = Vec::new();
    for pair in &contacts.pairs {
        if let Some(place) = pair.contact {
            sets.join(pair.paths[0], pair.paths[1]);
            // Two cuts that meet in two places go round what lies between.
            links.push((pair.paths[0], place.width().max(place.height()) > 2.0 * kerf));
        }
    }
    let mut clusters: BTreeMap<usize, (Vec<usize>, usize, bool)> = BTreeMap::new();
    for path in 0..paths.len() {
        let cluster = clusters.entry(sets.root(path)).or_default();
        cluster.0.push(path);
        // A window that does not come back to itself has the one hole that it is for.
        cluster.2 |= contacts.returns[path];
    }
    for (path, twice) in links {
        let cluster = clusters.entry(sets.root(path)).or_default();
        cluster.1 += 1;
        cluster.2 |= twice;
    }
    let tangled = |(members, links, tangled): &(Vec<usize>, usize, bool)| {
        let closed = members.iter().filter(|&&path| paths[path].closed).count();
        *tangled || *links >= members.len() || closed > 1 || (closed == 1 && members.len() > 1)
    };
    let clusters: Vec<Vec<usize>> =
        clusters.into_values().filter(tangled).map(|(members, ..)| members).collect();
    let found: Vec<Vec<(Point, f64, usize)>> =
        clusters.par_iter().map(|members| holes(paths, members, border, kerf, windows)).collect();
    found.into_iter().flatten().collect()
}

/// The holes of one cluster that no window is for; of the border's, all but the part.
fn holes(
    paths: &[CutPath],
    members: &[usize],
    border: usize,
    kerf: f64,
    windows: &Windows,
) -> Vec<(Point, f64, usize)> {
    let lines = |closed: bool| -> Vec<Contour> {
        let of_kind = members.iter().filter(|&&path| paths[path].closed == closed);
        of_kind.map(|&path| contour(&paths[path])).collect()
    };
    let mut grooves = stroke(lines(false), kerf, false);
    grooves.extend(stroke(lines(true), kerf, true));
    let none: Vec<Contour> = Vec::new();
    let united = grooves.overlay(&none, OverlayRule::Union, FillRule::NonZero);
    let mut holes: Vec<(Point, f64, usize)> = united
        .iter()
        .flat_map(|shape| shape.iter().skip(1))
        .map(|hole| (level_point(hole), area(hole).abs(), members[0]))
        .filter(|(at, size, _)| *size > kerf * kerf && windows.around(*at).is_none())
        .collect();
    holes.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.x.total_cmp(&b.0.x)));
    if members.contains(&border) && !holes.is_empty() {
        holes.remove(0);
    }
    holes
}

/// A point inside of a contour: the middle of the widest stretch of a level line. The border's hole has as many vertices as
/// the sheet has pieces: no time for [`inner_point`]'s search of a place far from all sides.
fn level_point(contour: &Contour) -> Point {
    let place = contour_box(contour);
    // Off the middle by an odd part, so that no vertex lies on the line.
    let y = place.y0 + 0.487_123 * place.height();
    let mut cuts: Vec<f64> = (0..contour.len())
        .filter_map(|i| {
            let [a, b] = [contour[i], contour[(i + 1) % contour.len()]];
            ((a[1] > y) != (b[1] > y)).then(|| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
        })
        .collect();
    cuts.sort_by(f64::total_cmp);
    let widest = cuts.chunks_exact(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    widest.map_or(place.center(), |pair| Point::new(0.5 * (pair[0] + pair[1]), y))
}

/// Cuts that lie in what a window lets fall.
fn check_scrap(file: &MachineFile, border: usize, windows: &Windows, faults: &mut Vec<Fault>) {
    for (index, path) in file.paths.iter().enumerate().filter(|(index, _)| *index != border) {
        let around = windows.around(path.vertices[0].point);
        if let Some(window) = around.filter(|&window| window != index) {
            let at = windows.first_point(index);
            let says = format!("lies in what {} lets fall", cut_name(&file.paths, window));
            faults.push(Fault::new(Check::Body, file.name, cut_name(&file.paths, index), at, says));
        }
    }
}
