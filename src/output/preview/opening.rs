//! How the sheet turns into its other state: the pieces' motions and turning senses, the frame that the other state is
//! seen in, and what becomes of the side that is up.

use super::page::Sense;
use crate::fabrication::states::{motions, other_vertices};
use crate::geometry::rotation::RigidMotion;
use crate::geometry::{Point3, Vector3, centroid};
use crate::kirigami::design::{Design, PatternKind, State};

/// What the upper side of the sheet becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bend {
    /// It stays nearly flat.
    Flat,
    /// It becomes the outside of a bulge.
    Convex,
    /// It becomes the inside of a bowl.
    Concave,
    /// It becomes convex along some directions or places and concave along others.
    Mixed,
}

/// The motion from the sheet state to the other state.
#[derive(Debug, Clone)]
pub struct Opening {
    /// The rigid motion of each piece.
    pub motions: Vec<RigidMotion>,
    /// Which way each piece turns.
    pub senses: Vec<Sense>,
    /// Where the sheet's x, y and upper side point to in the other state, on average: a right-handed frame.
    pub frame: [Vector3; 3],
    /// What the upper side becomes.
    pub bend: Bend,
    /// Whether the sheet is cut open, and closes.
    pub closes: bool,
}

/// Mean curvature times extent below which a surface counts as flat: a rise of about half a hundredth of the span.
const FLAT: f64 = 0.05;
/// Share of the convex hinges' curvature from which the whole counts as convex; likewise concave.
const CLEAR: f64 = 0.75;

impl Opening {
    /// Of a design that is flat in its sheet state.
    pub fn new(design: &Design) -> Self {
        let motions = motions(design);
        let closes = design.sheet_state == Some(State::Open);
        Opening {
            senses: senses(design, &vec![Vector3::z(); design.pieces.len()]),
            frame: frame(&motions),
            bend: bend(design, &motions),
            motions,
            closes,
        }
    }

    /// What the sheet has done: "opened" or "closed".
    pub fn done(&self) -> &'static str {
        if self.closes { "closed" } else { "opened" }
    }

    /// The upper side's unit normal of a piece in the other state.
    pub fn normal(&self, piece: usize) -> Vector3 {
        self.motions[piece].rotation.column(2).into_owned()
    }
}

/// Every hinge says how one of its pieces turns as the other sees it, about the upper side's normal in the state in which
/// the hinge's axis is given. On a curved surface this needs no common direction to compare with.
pub fn senses(design: &Design, normals: &[Vector3]) -> Vec<Sense> {
    let mut turns = vec![0.0; design.pieces.len()];
    let mut hinges = vec![0; design.pieces.len()];
    for hinge in &design.hinges {
        let turn = hinge.angle * hinge.axis.dot(&normals[hinge.pieces[0]]);
        turns[hinge.pieces[0]] -= turn;
        turns[hinge.pieces[1]] += turn;
        hinge.pieces.iter().for_each(|&piece| hinges[piece] += 1);
    }
    // Of a bistable sheet only the rectangles turn: they hang on all their corners.
    let still = |piece: usize| design.pieces[piece].closed.len() != 4 || hinges[piece] != 4;
    let sense = |(piece, turn): (usize, f64)| match turn {
        _ if design.pattern == PatternKind::Bistable && still(piece) => Sense::Still,
        turn if turn < 0.0 => Sense::Clockwise,
        _ => Sense::CounterClockwise,
    };
    turns.into_iter().enumerate().map(sense).collect()
}

fn frame(motions: &[RigidMotion]) -> [Vector3; 3] {
    let mean =
        |column: usize| -> Vector3 { motions.iter().map(|m| m.rotation.column(column).into_owned()).sum() };
    // A closed surface may have no mean direction; any will do then.
    let up = mean(2).try_normalize(1e-9).unwrap_or_else(Vector3::z);
    let across = |v: Vector3| (v - up * v.dot(&up)).try_normalize(1e-9);
    let right = across(mean(0)).or_else(|| across(Vector3::x())).or_else(|| across(Vector3::y()));
    let right = right.unwrap_or_else(Vector3::x);
    [right, up.cross(&right), up]
}

/// Across every hinge the normals of the two pieces open like a fan (convex) or close (concave).
fn bend(design: &Design, motions: &[RigidMotion]) -> Bend {
    let centres: Vec<Point3> =
        design.pieces.iter().map(|piece| centroid(other_vertices(design, piece))).collect();
    let (mut convex, mut concave) = (0.0, 0.0);
    for hinge in &design.hinges {
        let [j, k] = hinge.pieces;
        let apart = centres[k] - centres[j];
        let fan = motions[k].rotation.column(2) - motions[j].rotation.column(2);
        let curvature = fan.dot(&apart) / apart.norm_squared();
        if curvature > 0.0 {
            convex += curvature;
        } else if curvature < 0.0 {
            concave -= curvature;
        }
    }
    let extent = centres.iter().flat_map(|a| centres.first().map(|b| (a - b).norm())).fold(0.0, f64::max);
    let total = convex + concave;
    if total / design.hinges.len().max(1) as f64 * extent < FLAT {
        Bend::Flat
    } else if convex > CLEAR * total {
        Bend::Convex
    } else if concave > CLEAR * total {
        Bend::Concave
    } else {
        Bend::Mixed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kirigami::design::{Hinge, PatternKind, Piece, State};
    use crate::kirigami::hinges::relative_turn;
    use nalgebra::{Rotation3, Unit};

    /// 6 x 6 squares that turn by +-0.7 rad in a chessboard and come to lie on the graph of a height with the given
    /// gradient. Their hinges do not close, which nothing here asks for.
    fn sheet(
        height: fn(f64, f64) -> f64,
        gradient: fn(f64, f64) -> [f64; 2],
        about: Rotation3<f64>,
    ) -> Design {
        let mut pieces = Vec::new();
        let mut motions = Vec::new();
        for (i, j) in (0..6).flat_map(|j| (0..6).map(move |i| (i, j))) {
            let (x, y) = (10.0 * f64::from(i) - 25.0, 10.0 * f64::from(j) - 25.0);
            let [gx, gy] = gradient(x, y);
            let tilt = Rotation3::rotation_between(&Vector3::z(), &Vector3::new(-gx, -gy, 1.0)).unwrap();
            let turn = if (i + j) % 2 == 0 { 0.7 } else { -0.7 };
            let rotation =
                about * tilt * Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::z()), turn);
            let middle = Point3::new(x, y, 0.0);
            let closed = [[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]];
            let closed: Vec<Point3> = closed.iter().map(|&[u, v]| middle + Vector3::new(u, v, 0.0)).collect();
            let image = about * Point3::new(1.4 * x, 1.4 * y, height(x, y));
            let open = closed.iter().map(|p| image + rotation * (p - middle)).collect::<Vec<_>>();
            motions.push(RigidMotion::fit(&closed, &open));
            pieces.push(Piece { corners: vec![0; 4], closed, open });
        }
        let neighbours = (0..36).flat_map(|p| [(p, p + 1, p % 6 < 5), (p, p + 6, p < 30)]);
        let hinges = neighbours.filter(|(.., real)| *real).map(|(j, k, _)| {
            let pieces = if (j + k) % 3 == 0 { [k, j] } else { [j, k] };
            let (axis, angle) = relative_turn(&motions[pieces[0]], &motions[pieces[1]]);
            Hinge { pieces, vertices: [0, 0], point: Point3::origin(), axis, angle }
        });
        Design {
            pattern: PatternKind::RotatingRectangles,
            sheet_state: Some(State::Closed),
            gap: 0.5,
            corners: vec![Point3::origin()],
            hinges: hinges.collect(),
            pieces,
        }
    }

    fn openings() -> Vec<(Opening, Bend)> {
        let about = Rotation3::from_euler_angles(0.4, -1.9, 2.5);
        let bowl = |x: f64, y: f64| 0.01 * (x * x + y * y);
        let sheets = [
            sheet(|_, _| 0.0, |_, _| [0.0; 2], about),
            sheet(bowl, |x, y| [0.02 * x / 1.4, 0.02 * y / 1.4], about),
            sheet(|x, y| -0.01 * (x * x + y * y), |x, y| [-0.02 * x / 1.4, -0.02 * y / 1.4], about),
            sheet(|x, y| 0.01 * (x * x - y * y), |x, y| [0.02 * x / 1.4, -0.02 * y / 1.4], about),
            sheet(|x, _| -0.01 * x * x, |x, _| [-0.02 * x / 1.4, 0.0], about),
        ];
        let bends = [Bend::Flat, Bend::Concave, Bend::Convex, Bend::Mixed, Bend::Convex];
        sheets.iter().map(Opening::new).zip(bends).collect()
    }

    #[test]
    fn the_upper_side_of_known_surfaces_is_named() {
        for (opening, expected) in openings() {
            assert_eq!(opening.bend, expected);
        }
    }

    #[test]
    fn senses_and_frame_do_not_depend_on_the_place_in_space() {
        let about = Rotation3::from_euler_angles(0.4, -1.9, 2.5);
        for (opening, _) in openings() {
            for (piece, sense) in opening.senses.iter().enumerate() {
                let expected =
                    if (piece % 6 + piece / 6) % 2 == 0 { Sense::CounterClockwise } else { Sense::Clockwise };
                assert_eq!(*sense, expected, "{piece}");
            }
            // The surfaces are symmetric, so the mean directions are those of the sheet; rounding only.
            for (axis, unit) in opening.frame.iter().zip([Vector3::x(), Vector3::y(), Vector3::z()]) {
                assert!((axis - about * unit).norm() < 1e-9, "{axis} {unit}");
            }
        }
    }
}
