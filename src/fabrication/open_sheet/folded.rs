//! Whether the folded ligaments of an open sheet find room in the closed state.
//!
//! A folded ligament lies within the two halves of the straight one, each turned with its piece, and a round joint
//! about its middle on either (see [`super::gap`]).

use crate::fabrication::collision::{OVERLAP_TOLERANCE, View, overlap};
use crate::fabrication::error::FabricationError;
use crate::fabrication::ligament::MeasuredLigament;
use crate::fabrication::outline::Contour;
use crate::fabrication::topology::{Fan, Topology};
use crate::geometry::Vector3;
use crate::geometry::rotation::RigidMotion;
use crate::kirigami::design::Design;
use crate::profile::Profile;
use kurbo::{Point, Vec2};

use super::gap::open_sheet_gap;
use super::neck::neck_direction;

/// Corners of the joint's polygon: it lies a fiftieth inside of the circle.
const JOINT_CORNERS: u32 = 16;

/// Checks at every corner the ligaments hinged there against each other and against the pieces that they do not
/// join, in the closed state, seen along the mean normal of the corner's pieces.
///
/// `motions`: of the pieces into the closed state; `outlines` without ligaments, sheet millimetres.
///
/// # Errors
/// The first ligament without room.
pub fn check_folded_ligaments(
    design: &Design,
    topology: &Topology,
    motions: &[RigidMotion],
    outlines: &[Contour],
    ligaments: &[MeasuredLigament],
    profile: &Profile,
) -> Result<(), FabricationError> {
    for (corner, fan) in topology.fans.iter().enumerate() {
        let hinges: Vec<usize> =
            fan.edges.iter().filter_map(|&edge| topology.edges[edge].hinge_at(corner)).collect();
        let Some(view) = view(fan, motions) else { continue };
        let folded: Vec<Vec<Contour>> =
            hinges.iter().map(|&hinge| fold(design, hinge, &ligaments[hinge], motions, &view)).collect();
        for (i, &hinge) in hinges.iter().enumerate() {
            let strangers = fan.pieces.iter().filter(|piece| !design.hinges[hinge].pieces.contains(piece));
            let pieces = strangers.map(|&piece| {
                let outline = outlines[piece].iter().map(|&point| view.of(point, &motions[piece])).collect();
                (format!("piece {piece}"), overlap(&folded[i], &[outline]))
            });
            let others = hinges.iter().zip(&folded).skip(i + 1);
            let others =
                others.map(|(other, shape)| (format!("that of hinge {other}"), overlap(&folded[i], shape)));
            if let Some((other, area)) = pieces.chain(others).find(|(_, area)| *area > OVERLAP_TOLERANCE) {
                let Point { x, y } = ligaments[hinge].centre;
                let needed = open_sheet_gap(profile, 0.0);
                return Err(FabricationError::FoldedLigament { hinge, x, y, other, area, needed });
            }
        }
    }
    Ok(())
}

fn view(fan: &Fan, motions: &[RigidMotion]) -> Option<View> {
    let sum: Vector3 = fan.pieces.iter().map(|&piece| motions[piece].rotation * Vector3::z()).sum();
    sum.try_normalize(1e-9).map(View::against)
}

/// A folded ligament as it is seen: two half bars and their joints.
fn fold(
    design: &Design,
    hinge: usize,
    ligament: &MeasuredLigament,
    motions: &[RigidMotion],
    view: &View,
) -> Vec<Contour> {
    let pieces = design.hinges[hinge].pieces;
    let Some(along) = neck_direction(design, hinge) else { return Vec::new() };
    let (half, radius) = (0.5 * ligament.length * along, 0.5 * ligament.width);
    let across = radius * along.turn_90();
    let seen = |piece: usize, offsets: &[Vec2]| -> Contour {
        let points = offsets.iter().map(|&offset| ligament.centre + offset);
        points.map(|point| view.of([point.x, point.y], &motions[piece])).collect()
    };
    let joint: Vec<Vec2> = (0..JOINT_CORNERS)
        .map(|i| radius * Vec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(JOINT_CORNERS)))
        .collect();
    vec![
        seen(pieces[0], &[-half - across, -across, across, across - half]),
        seen(pieces[1], &[-across, half - across, half + across, across]),
        seen(pieces[0], &joint),
        seen(pieces[1], &joint),
    ]
}
