//! Kinematics: the rigid motion of every piece, and the axis and angle of every hinge (section 4.1, Fig. 19).

use super::design::{Design, Hinge, PatternKind, Piece, State};
use super::pattern::Pattern;
use super::piece_mesh::{Edge, PieceMesh};
use crate::geometry::rotation::{RigidMotion, axis_angle};
use crate::geometry::{Point3, Vector3};

/// Assembles the design: pieces in the pattern's order, one hinge per inner edge in the edges' order. Without a sheet state
/// the closed one is the frame of reference.
pub fn design(mesh: &PieceMesh, pattern: &Pattern, gap: f64, sheet_state: Option<State>) -> Design {
    let pieces: Vec<Piece> = mesh
        .pieces
        .iter()
        .zip(&mesh.owned)
        .map(|(corners, owned)| Piece {
            corners: corners.clone(),
            closed: owned.iter().map(|&e| pattern.closed_hinge(mesh, e)).collect(),
            open: owned.iter().map(|&e| pattern.open[e]).collect(),
        })
        .collect();
    let joint = |(e, edge): (usize, &Edge)| {
        let pieces = [edge.piece, edge.neighbour?];
        Some(Joint { pieces, vertices: pieces.map(|piece| mesh.vertex_of(piece, e)) })
    };
    let joints: Vec<Joint> = mesh.edges.iter().enumerate().filter_map(joint).collect();
    let kind = PatternKind::RotatingRectangles;
    assemble(kind, sheet_state, gap, pattern.corners.clone(), pieces, &joints)
}

/// Two vertices of two pieces that coincide in both states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joint {
    /// The pieces j and k.
    pub pieces: [usize; 2],
    /// The vertex of each.
    pub vertices: [usize; 2],
}

/// Assembles a design from its pieces and joints: one hinge per joint, in their order. Axes and angles are those of the
/// motion from the sheet state (from the closed one, where neither is flat) to the other.
pub fn assemble(
    pattern: PatternKind,
    sheet_state: Option<State>,
    gap: f64,
    corners: Vec<Point3>,
    pieces: Vec<Piece>,
    joints: &[Joint],
) -> Design {
    let reference = sheet_state.unwrap_or(State::Closed);
    let motion =
        |piece: &Piece| RigidMotion::fit(piece.vertices(reference), piece.vertices(reference.other()));
    let motions: Vec<RigidMotion> = pieces.iter().map(motion).collect();
    let hinges = joints
        .iter()
        .map(|&Joint { pieces: [j, k], vertices }| {
            let (axis, angle) = relative_turn(&motions[j], &motions[k]);
            let point = pieces[j].vertices(reference)[vertices[0]];
            Hinge { pieces: [j, k], vertices, point, axis, angle }
        })
        .collect();
    Design { pattern, sheet_state, gap, corners, pieces, hinges }
}

/// Axis and angle of the rotation `A_j^-1 A_k`: seen from piece j, piece k turns by the angle about the axis,
/// from the sheet state to the other. A hinge that does not turn gets the sheet's normal as its axis.
pub fn relative_turn(motion_j: &RigidMotion, motion_k: &RigidMotion) -> (Vector3, f64) {
    let (axis, angle) = axis_angle(&(motion_j.rotation.transpose() * motion_k.rotation));
    (axis.unwrap_or_else(Vector3::z), angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn piece_k_turns_about_the_axis_as_piece_j_sees_it() {
        // Motions of j and k about a common hinge point, with k turned further about a tilted axis in j's
        // frame.
        let hinge = Point3::new(3.0, 1.0, 0.0);
        let axis = Vector3::new(0.05, -0.03, 1.0).normalize();
        let (angle, j_rotation) = (1.4, *Rotation3::from_euler_angles(0.3, 0.2, -0.7).matrix());
        let turn = *Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), angle).matrix();
        let about = |rotation: nalgebra::Matrix3<f64>, image: Vector3| RigidMotion {
            rotation,
            translation: image - rotation * hinge.coords,
        };
        let image = Vector3::new(10.0, 2.0, 5.0);
        let (j, k) = (about(j_rotation, image), about(j_rotation * turn, image));
        let (found, turned) = relative_turn(&j, &k);
        assert!((found - axis).norm() < 1e-12 && (turned - angle).abs() < 1e-12);
        // Swapping the pieces: the same axis in the other's frame, the opposite way round.
        let (swapped, back) = relative_turn(&k, &j);
        assert!((swapped + axis).norm() < 1e-12 && (back - angle).abs() < 1e-12);
        // j's view of a point of k is that point turned about the axis through the hinge.
        let p = Point3::new(5.0, -2.0, 0.4);
        let seen = j.inverse().apply(&k.apply(&p));
        assert!((seen - (hinge + turn * (p - hinge))).norm() < 1e-12);
    }
}
