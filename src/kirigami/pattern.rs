//! The pattern in both states, and its unknowns in Stage 3.
//!
//! The unknowns are the corner midpoints of the closed sheet and one open point per edge: the hinge that the edge
//! carries, shared by its two pieces, so that Eq. (8) holds exactly. The two hinges of a closed corner stand `gap`
//! apart: at the midpoint plus and minus gap/2 along the unit normal of the slit that passes between them, in the
//! sheet's surface. Where more slits meet the hinges of a corner stand farther out ([`hinge_offsets`]). A flat state
//! has z = 0, and two unknowns per point.

use super::control_mesh::{ControlMesh, Goals};
use super::cover::Cover;
use super::piece_mesh::{Edge, PieceMesh};
use super::terms::PointAt;
use crate::geometry::{Point3, Vector3};

/// The pattern in both states.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Corner midpoints of the closed sheet.
    pub corners: Vec<Point3>,
    /// For each edge the offset of its closed hinge point from the midpoint of its hinge corner, across the slit.
    pub offsets: Vec<Vector3>,
    /// For each edge the direction in which its closed hinge point is lifted.
    pub rises: Vec<Vector3>,
    /// For each corner how far its hinge points are lifted along their directions, millimetres.
    pub lifts: Vec<f64>,
    /// For each edge its open hinge point (at the border: the free vertex of its piece).
    pub open: Vec<Point3>,
}

impl Pattern {
    /// The closed hinge point of an edge.
    pub fn closed_hinge(&self, mesh: &PieceMesh, edge: usize) -> Point3 {
        let corner = mesh.edges[edge].hinge_corner;
        self.corners[corner] + self.offsets[edge] + self.rises[edge] * self.lifts[corner]
    }

    /// Takes the directions in which hinge points stand apart from where the corners are now.
    pub fn turn_offsets(&mut self, mesh: &PieceMesh, gap: f64) {
        self.offsets = hinge_offsets(mesh, &self.corners, gap);
        self.rises = hinge_rises(mesh, &self.corners);
    }

    /// The same where the hinge points of inner edges stand `halves` from their corners' midpoints instead of half a gap;
    /// those values are in the order of the inner edges.
    pub fn spread_offsets(&mut self, mesh: &PieceMesh, gap: f64, halves: &[f64]) {
        self.turn_offsets(mesh, gap);
        let inner = self.offsets.iter_mut().zip(&mesh.edges).filter(|(_, edge)| !edge.is_border());
        for ((offset, _), half) in inner.zip(halves) {
            // Where no slit passes there is no direction.
            if let Some(normal) = offset.try_normalize(1e-9) {
                *offset += normal * (half - 0.5 * gap);
            }
        }
    }
}

/// The directions in which the hinge points of a closed corner are lifted: the first one along the sheet's normal, the
/// second against it.
///
/// The corners of a closed sheet in space, four pieces at each, would have to be those of a mesh of flat faces, whose
/// lines must follow the curvature of the surface. A small step across the slit between the two hinges of a corner, where
/// pieces do not touch anyway, frees the sheet from that.
fn hinge_rises(mesh: &PieceMesh, corners: &[Point3]) -> Vec<Vector3> {
    let mut rises = vec![Vector3::zeros(); mesh.edges.len()];
    for (corner, fan) in mesh.fans.iter().enumerate() {
        let hinged = fan.edges.iter().filter(|&&e| mesh.edges[e].hinge_corner == corner);
        for (&edge, sign) in hinged.zip([1.0, -1.0]) {
            rises[edge] = sheet_normal(mesh, corners, corner) * sign;
        }
    }
    rises
}

/// How far the straight side of a junction should reach on either side of a hinge, in gaps: enough for ligaments up to
/// two and a half gaps long, that is at a steel sheet's 0.55 mm for 1.4 mm and 125 degrees.
pub const JUNCTION_REACH: f64 = 1.5;

/// Offsets of the closed hinge points: along the normal of the slit that passes the hinge's corner, towards the
/// edge's other end. Zero where no slit passes.
///
/// Half the gap, and where slits meet at angles so much more (`junction_radius`) that each ligament there has a
/// straight cut behind it, as everywhere else.
pub fn hinge_offsets(mesh: &PieceMesh, corners: &[Point3], gap: f64) -> Vec<Vector3> {
    let normals: Vec<Vector3> =
        (0..mesh.edges.len()).map(|e| passing_normal(mesh, corners, e).unwrap_or_default()).collect();
    let radii: Vec<f64> = (0..mesh.fans.len())
        .map(|corner| if gap == 0.0 { 0.0 } else { junction_radius(mesh, &normals, corner, gap) })
        .collect();
    let offset = |(edge, normal): (&Edge, &Vector3)| {
        let corner = edge.hinge_corner;
        // The free vertices beside the end of a cut stay there: their pieces end in a point between slit and cut.
        let end_of_cut = edge.is_border() && mesh.fans[corner].edges.len() > 4;
        if end_of_cut { Vector3::zeros() } else { normal * (0.5 * gap + radii[corner]) }
    };
    mesh.edges.iter().zip(&normals).map(offset).collect()
}

/// The unit normal of the slit that passes an edge's hinge, in the sheet, towards the edge's other end; `None` where
/// no slit passes.
fn passing_normal(mesh: &PieceMesh, corners: &[Point3], e: usize) -> Option<Vector3> {
    let edge = &mesh.edges[e];
    let corner = edge.hinge_corner;
    let fan = &mesh.fans[corner];
    let (before, after) = fan.neighbours(mesh.fan_position(corner, e));
    let inside = |n: Option<usize>| n.is_some_and(|n| !mesh.edges[n].is_border());
    if !inside(before) && !inside(after) {
        return None;
    }
    let arm = |n: usize| corners[mesh.edges[n].other_end(corner)] - corners[corner];
    let end = |n: Option<usize>| match n {
        None => Vector3::zeros(),
        // The two sides of a narrow cut that ends here are one slit.
        Some(n) if mesh.edges[n].is_border() && fan.edges.len() > 4 => {
            let [one, other] = [fan.edges[0], fan.edges[fan.edges.len() - 1]].map(arm);
            if one.dot(&other) > 0.0 { (one + other) * 0.5 } else { arm(n) }
        }
        Some(n) => arm(n),
    };
    let across = sheet_normal(mesh, corners, corner).cross(&(end(after) - end(before)));
    let normal = across.try_normalize(0.0)?;
    Some(normal * normal.dot(&arm(e)).signum())
}

/// How far from a corner the straight cuts behind its ligaments run: 0 where four pieces surround it.
///
/// Where n/2 > 2 slits meet, they end on the corners of a small polygon, of which each ligament has one side. The sides
/// behind two hinges whose normals are the angle f apart meet radius * tan(f/2) beside their middles, and that must be
/// [`JUNCTION_REACH`] gaps: at six pieces a triangle with a radius of reach / tan 60 degrees.
fn junction_radius(mesh: &PieceMesh, normals: &[Vector3], corner: usize, gap: f64) -> f64 {
    let fan = &mesh.fans[corner];
    let n = fan.edges.len();
    if n < 5 || (fan.closed && n < 6) {
        return 0.0;
    }
    let hinged = |&e: &usize| mesh.edges[e].hinge_corner == corner && !mesh.edges[e].is_border();
    let hinges: Vec<usize> = fan.edges.iter().copied().filter(hinged).collect();
    let last = if fan.closed { hinges.len() } else { hinges.len().saturating_sub(1) };
    let radius = |i: usize| {
        let [a, b] = [hinges[i], hinges[(i + 1) % hinges.len()]].map(|e| normals[e]);
        // tan(f/2) = |a x b| / (1 + a.b). Opposite normals have one straight cut between them.
        let across = a.cross(&b).norm();
        if across > 1e-9 { JUNCTION_REACH * gap * (1.0 + a.dot(&b)) / across } else { 0.0 }
    };
    (0..last).map(radius).fold(0.0, f64::max)
}

/// The unit normal of the closed sheet at a corner: the mean over the corner's fan, weighted by area. +z in the plane.
fn sheet_normal(mesh: &PieceMesh, corners: &[Point3], corner: usize) -> Vector3 {
    let fan = &mesh.fans[corner];
    let spoke = |i: usize| {
        let edge = &mesh.edges[fan.edges[i % fan.edges.len()]];
        corners[edge.other_end(corner)] - corners[corner]
    };
    let sectors = fan.edges.len() - usize::from(!fan.closed);
    let sum: Vector3 = (0..sectors).map(|i| spoke(i).cross(&spoke(i + 1))).sum();
    sum.try_normalize(0.0).unwrap_or_else(Vector3::z)
}

/// How far the pieces turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opening {
    /// All by as much as they can: about 45 degrees.
    Full,
    /// Some less than others (Figs. 1 and 16).
    Variable,
}

/// The start of Stage 3 from control meshes: the open hinge of an edge divides the open cell's side.
pub fn initial_pattern(cover: &Cover, control: &ControlMesh, gap: f64, opening: Opening) -> Pattern {
    let mesh = &cover.mesh;
    let sides = match opening {
        Opening::Full => Vec::new(),
        Opening::Variable => sides_across(mesh, &control.closed_corners),
    };
    let hinge = |(e, edge): (usize, &Edge)| {
        let far_end = edge.other_end(edge.hinge_corner);
        let (near, far) = (control.open_corners[edge.hinge_corner], control.open_corners[far_end]);
        let share = match opening {
            Opening::Full => full_share(cover, edge),
            Opening::Variable => {
                let own =
                    (control.closed_corners[edge.hinge_corner] - control.closed_corners[far_end]).norm();
                share(own - 0.5 * gap, sides[e] - 0.5 * gap, (far - near).norm())
            }
        };
        near + (far - near) * share
    };
    let open = mesh.edges.iter().enumerate().map(hinge).collect();
    let corners = control.closed_corners.clone();
    let (offsets, rises) = (hinge_offsets(mesh, &corners, gap), hinge_rises(mesh, &corners));
    Pattern { offsets, rises, lifts: vec![0.0; corners.len()], corners, open }
}

/// Which part of an open cell's side lies between the hinge and the hinge's corner in the model cell (section 2.1): the
/// other side's share of a + b.
fn full_share(cover: &Cover, edge: &Edge) -> f64 {
    let [a, b] = cover.cell.closed;
    cover.cell.closed[1 - edge.direction] / (a + b)
}

/// The same part where a piece has turned by as much as makes its cell's side as long as it is: pieces with sides `a`
/// along it and `b` across, turned by t, have open cells of a cos t + b sin t, and b sin t of that is next to the
/// hinge's corner. Longer sides than any turn gives count as the longest.
fn share(a: f64, b: f64, side: f64) -> f64 {
    let turn = b.atan2(a) - (side / a.hypot(b)).clamp(-1.0, 1.0).acos();
    let turn = turn.clamp(0.0, std::f64::consts::FRAC_PI_2);
    b * turn.sin() / (a * turn.cos() + b * turn.sin())
}

/// For each edge the mean length of the sides next to it in its pieces.
fn sides_across(mesh: &PieceMesh, corners: &[Point3]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); mesh.edges.len()];
    for (piece, owned) in mesh.pieces.iter().zip(&mesh.owned) {
        let n = piece.len();
        let length = |i: usize| (corners[piece[i % n]] - corners[piece[(i + 1) % n]]).norm();
        for &edge in owned {
            // The side that this edge is.
            let ends = mesh.edges[edge].corners;
            let side = (0..n).find(|&i| ends.contains(&piece[i]) && ends.contains(&piece[(i + 1) % n]));
            let side = side.expect("a piece owns its own sides");
            sums[edge].0 += length(side + 1) + length(side + n - 1);
            sums[edge].1 += 2.0;
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// Where the points of a pattern stand among the unknowns.
#[derive(Debug, Clone, Copy)]
pub struct Unknowns {
    /// Number of corners.
    pub corners: usize,
    /// Number of edges.
    pub edges: usize,
    /// Unknowns per point of the closed state: 2 where it lies in the plane, 3 in space.
    pub closed_dimension: usize,
    /// Likewise of the open state.
    pub open_dimension: usize,
    /// Whether closed hinge points can be lifted: where a closed state on a surface has to open flat, or at will. An open
    /// state on a surface is freer.
    pub lifted: bool,
}

impl Unknowns {
    /// Those of a pattern over this mesh.
    pub fn new(mesh: &PieceMesh, goals: &Goals) -> Self {
        Self {
            corners: mesh.corner_count,
            edges: mesh.edges.len(),
            closed_dimension: goals.closed.dimension(),
            open_dimension: goals.open.dimension(),
            lifted: goals.closed.target().is_some() && goals.open.target().is_none(),
        }
    }

    /// A corner midpoint of the closed sheet.
    pub fn corner(&self, i: usize) -> PointAt {
        PointAt { start: self.closed_dimension * i, dimension: self.closed_dimension }
    }

    /// The open hinge of an edge.
    pub fn open(&self, edge: usize) -> PointAt {
        let dimension = self.open_dimension;
        PointAt { start: self.closed_dimension * self.corners + dimension * edge, dimension }
    }

    /// How far the hinge points of a corner are lifted, where they can be.
    pub fn lift(&self, corner: usize) -> Option<usize> {
        let lifts = self.closed_dimension * self.corners + self.open_dimension * self.edges;
        self.lifted.then_some(lifts + corner)
    }

    /// A place of each unknown on the grid.
    pub fn places(&self, cover: &Cover) -> Vec<[f64; 2]> {
        let middle = |edge: &Edge| {
            let [p, q] = edge.corners.map(|c| cover.places[c]);
            [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
        };
        let closed = cover.places.iter().flat_map(|p| std::iter::repeat_n(*p, self.closed_dimension));
        let edges = cover.mesh.edges.iter().map(middle);
        let lifts = if self.lifted { &cover.places[..] } else { &[] };
        let open = edges.flat_map(|p| std::iter::repeat_n(p, self.open_dimension));
        closed.chain(open).chain(lifts.iter().copied()).collect()
    }

    /// The unknowns of a pattern, in units of `scale` millimetres.
    pub fn pack(&self, pattern: &Pattern, scale: f64) -> Vec<f64> {
        let closed = pattern.corners.iter().flat_map(|p| p.iter().take(self.closed_dimension));
        let open = pattern.open.iter().flat_map(|p| p.iter().take(self.open_dimension));
        let lifts = if self.lifted { &pattern.lifts[..] } else { &[] };
        closed.chain(open).chain(lifts).map(|value| value / scale).collect()
    }

    /// Takes the points of a pattern from the unknowns.
    pub fn unpack(&self, x: &[f64], scale: f64, pattern: &mut Pattern) {
        for (i, p) in pattern.corners.iter_mut().enumerate() {
            *p = self.corner(i).point(x, scale);
        }
        for (e, p) in pattern.open.iter_mut().enumerate() {
            *p = self.open(e).point(x, scale);
        }
        for (c, lift) in pattern.lifts.iter_mut().enumerate() {
            *lift = self.lift(c).map_or(0.0, |unknown| x[unknown] * scale);
        }
    }
}
