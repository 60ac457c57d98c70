//! A bistable pattern in both states: the points that the optimisation moves, and the pieces that follow.

use super::cell::BistableCell;
use super::fit::fitted;
use super::mesh::{BistableMesh, Passing, Role, Vertex};
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3, centroid};
use crate::kirigami::design::{Design, PatternKind, Piece, State};
use crate::kirigami::hinges::assemble;
use crate::kirigami::piece_mesh::PieceMesh;

/// The pattern in both states, millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct BistablePattern {
    /// Corners of the unexpanded sheet. Those where two slits meet follow from the others ([`BistablePattern::settle`]).
    pub corners: Vec<Point3>,
    /// For each corner of a rectangle where its hinge stands beside it: half a gap across the slit that passes.
    pub offsets: Vec<Vector3>,
    /// Points of the expanded state: hinges, then free vertices.
    pub open: Vec<Point3>,
}

/// Rounds in which offsets and the slits' directions, which depend on each other, settle. Each brings them nearer by half
/// a gap's part of a side.
const ROUNDS: usize = 8;

impl BistablePattern {
    /// The unexpanded hinge point at a corner of a rectangle.
    pub fn hinge(&self, corner: usize) -> Point3 {
        self.corners[corner] + self.offsets[corner]
    }

    /// Puts each hinge beside the slit that passes it, as far away (mm) as `half` says of its corner, and the crossings inside
    /// the sheet where slits meet.
    pub fn settle(&mut self, mesh: &BistableMesh, half: impl Fn(usize) -> f64) {
        let normals: Vec<Vector3> = (0..mesh.cells).map(|cell| self.rectangle_normal(cell)).collect();
        for _ in 0..ROUNDS {
            let offset = |(corner, slit): (usize, &Passing)| {
                let middle = self.corners[corner];
                let across = normals[corner / 4].cross(&(middle - self.hinge(slit.origin)));
                let across = across.try_normalize(0.0).unwrap_or_default();
                let side = across.dot(&(self.corners[slit.beside] - middle)).signum();
                across * (half(corner) * side)
            };
            self.offsets = mesh.passing.iter().enumerate().map(offset).collect();
        }
        self.cross(mesh);
    }

    /// Puts the crossings inside the sheet where slits meet.
    pub fn cross(&mut self, mesh: &BistableMesh) {
        for (edge, ends) in mesh.meetings.iter().enumerate() {
            if let Some(ends) = ends {
                let lines =
                    ends.map(|corner| [self.hinge(mesh.passing[corner].origin), self.corners[corner]]);
                self.corners[4 * mesh.cells + edge] = meeting(lines);
            }
        }
    }

    fn rectangle_normal(&self, cell: usize) -> Vector3 {
        let at = |i: usize| self.corners[4 * cell + i];
        (at(2) - at(0)).cross(&(at(3) - at(1))).try_normalize(0.0).unwrap_or_else(Vector3::z)
    }

    /// The pieces in both states. Vertices that a piece carries lie in its plane in the unexpanded state and move with it.
    pub fn pieces(&self, mesh: &BistableMesh) -> Vec<Piece> {
        mesh.pieces.iter().map(|vertices| self.piece(vertices)).collect()
    }

    fn piece(&self, vertices: &[Vertex]) -> Piece {
        let own = |vertex: &Vertex| match vertex.role {
            Role::Hinge => Some((self.hinge(vertex.corner), self.open[vertex.corner])),
            Role::Free(open) => Some((self.corners[vertex.corner], self.open[open])),
            Role::Carried => None,
        };
        let (from, to): (Vec<Point3>, Vec<Point3>) = vertices.iter().filter_map(own).unzip();
        let motion = RigidMotion::fit(&from, &to);
        let (middle, normal) = (centroid(&from), plane_normal(&from));
        let both = |vertex: &Vertex| {
            own(vertex).unwrap_or_else(|| {
                let corner = self.corners[vertex.corner];
                let closed = corner - normal * normal.dot(&(corner - middle));
                (closed, motion.apply(&closed))
            })
        };
        let (closed, open) = vertices.iter().map(both).unzip();
        Piece { corners: vertices.iter().map(|vertex| vertex.corner).collect(), closed, open }
    }

    /// The design: pieces in the mesh's order, hinge i at corner i.
    pub fn design(&self, mesh: &BistableMesh, gap: f64, sheet_state: Option<State>) -> Design {
        let (corners, pieces) = (self.corners.clone(), self.pieces(mesh));
        assemble(PatternKind::Bistable, sheet_state, gap, corners, pieces, &mesh.joints)
    }
}

/// The unit normal of a flat polygon, z where it has no area.
fn plane_normal(polygon: &[Point3]) -> Vector3 {
    let origin = polygon[0];
    let area: Vector3 = polygon.windows(2).map(|pair| (pair[0] - origin).cross(&(pair[1] - origin))).sum();
    area.try_normalize(0.0).unwrap_or_else(Vector3::z)
}

/// Where two lines, each given by two points, come nearest to each other: the middle. Nearly parallel ones meet midway
/// between the points that they pass.
fn meeting([[p, q], [r, s]]: [[Point3; 2]; 2]) -> Point3 {
    let (d, e, w) = (q - p, s - r, r - p);
    let (dd, de, ee) = (d.dot(&d), d.dot(&e), e.dot(&e));
    let determinant = dd * ee - de * de;
    // The square of the sine of the angle between them: less than about a degree says nothing.
    if determinant.is_nan() || determinant <= 3e-4 * dd * ee {
        return nalgebra::center(&q, &s);
    }
    let along = (w.dot(&d) * ee - w.dot(&e) * de) / determinant;
    let back = (w.dot(&d) * de - w.dot(&e) * dd) / determinant;
    nalgebra::center(&(p + d * along), &(r + e * back))
}

/// The regular pattern of `columns` x `rows` cells between two flat states, exactly: cell (0, 0) is turned by +phi, both
/// states begin at the origin.
pub fn regular(cell: &BistableCell, [columns, rows]: [usize; 2]) -> (BistableMesh, BistablePattern) {
    let (columns, rows) = (columns as i32, rows as i32);
    let cells: Vec<[i32; 2]> = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])).collect();
    let (grid, places) = PieceMesh::from_cells(&cells);
    let mesh = BistableMesh::new(&grid);
    let corners = |[a, b]: [f64; 2]| -> Vec<Point3> {
        places.iter().map(|[i, j]| Point3::new(a * f64::from(*i), b * f64::from(*j), 0.0)).collect()
    };
    let pattern =
        fitted(&vec![*cell; cells.len()], &grid, &mesh, &corners(cell.cell), &corners(cell.expanded()));
    (mesh, pattern)
}
