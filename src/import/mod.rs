//! Designs made elsewhere: from pieces in two states to a [`Design`].
//!
//! ```text
//! OBJ pair, PyKirigami, pieces and motions ──> Source ──frame, scale──> ──joints, sides──> ──corners──> Design
//! ```
//!
//! Corners of two pieces that coincide in *both* states are a hinge. The design is as rigid as the source, no more:
//! [`Imported::misfit`] tells.

mod error;
mod frame;
mod joints;
mod pieces_json;
mod pykirigami;
mod sides;
mod source;

pub use error::ImportError;
pub use pieces_json::read_pieces_json;
pub use pykirigami::{CLOSED, CONSTRAINTS, OPEN, read_pykirigami};
pub use source::{Constraint, Source, read_mesh_pair};

use crate::geometry::Point3;
use crate::geometry::coincidence::{clusters, mean, members, near_pairs};
use crate::geometry::plane::doubled_area;
use crate::kirigami::design::{Design, Hinge, PatternKind, Piece, State};
use crate::kirigami::hinges::{Joint, assemble};
use crate::kirigami::repeated::NEARLY;
use crate::kirigami::rigidity::{self, Misfit, mean_side, misfit_of};
use joints::{Corners, joints, row};
use sides::{Sides, sides};

/// The tolerance of coincidence where none is given, in mean sides of the pieces.
pub const TOLERANCE: f64 = 1e-4;

/// Areas below this, in squares of the mean side, have no direction.
const LEAST_AREA: f64 = 1e-12;

/// How large the design is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// Millimetres per unit of the source.
    Scale(f64),
    /// Largest extent along x, y or z of the sheet (of the closed state where neither is flat), millimetres.
    Extent(f64),
}

/// How a design is taken over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// How large it becomes.
    pub size: Size,
    /// Corners nearer than this are one, millimetres; `None` for [`TOLERANCE`] mean sides.
    pub tolerance: Option<f64>,
    /// Distance between the two hinge points of a closed corner, millimetres; 0 where they coincide.
    pub gap: f64,
    /// Largest [`Misfit::strain`] that is accepted.
    pub max_strain: f64,
}

/// A design taken over.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The design, millimetres, a flat state in z = 0.
    pub design: Design,
    /// The tolerance of coincidence that was used, millimetres.
    pub tolerance: f64,
    /// How rigid it is.
    pub misfit: Misfit,
    /// What a person should know.
    pub warnings: Vec<String>,
}

/// Takes a design over.
///
/// # Errors
/// See [`ImportError`].
pub fn import(mut source: Source, options: &Options) -> Result<Imported, ImportError> {
    check_options(options)?;
    let sheet_state = frame::lay_flat(&mut source)?;
    frame::scale(&mut source, sheet_state, options.size)?;
    let side = mean_side(&source.closed);
    let tolerance = options.tolerance.unwrap_or(TOLERANCE * side);
    if !(tolerance > 0.0 && tolerance < 0.25 * side) {
        let rule = "it must be above 0 and below a quarter of the mean side of the pieces";
        return Err(ImportError::Option { what: "--tolerance-mm", value: tolerance, rule });
    }
    check_areas(&source, side)?;
    let (mut joints, mut warnings) = joints(&mut source, tolerance)?;
    check_mirrored_shapes(&source, side, options.max_strain)?;
    let Sides { mut reversed, mirrored } = sides(&source.closed, &source.open, &joints);
    if !mirrored.is_empty() {
        return Err(ImportError::Mirrored { pieces: mirrored });
    }
    if let Some(state) = sheet_state {
        // In the sheet it is known which way round is counter-clockwise.
        let sheet = if state == State::Closed { &source.closed } else { &source.open };
        reversed = (0..sheet.len()).filter(|&i| doubled_area(&sheet[i]).z < 0.0).collect();
    }
    if !reversed.is_empty() {
        warnings.push(format!(
            "{}: listed the other way round than the others, reversed",
            error::named(&reversed)
        ));
        reverse(&mut source, &mut joints, &reversed);
    }
    warnings.extend(nearly_repeated(&source, side));
    let design = design(&source, sheet_state, options.gap, tolerance, &joints);
    let misfit = check_rigid(&design, options.max_strain)?;
    Ok(Imported { design, tolerance, misfit, warnings })
}

fn check_options(options: &Options) -> Result<(), ImportError> {
    let positive = "it must be a number above 0";
    let (what, size) = match options.size {
        Size::Scale(scale) => ("the scale", scale),
        Size::Extent(extent) => ("--size-mm", extent),
    };
    for (what, value, right, rule) in [
        (what, size, size > 0.0, positive),
        ("--max-strain", options.max_strain, options.max_strain > 0.0, positive),
        ("--gap-mm", options.gap, options.gap >= 0.0, "it must be a number, 0 or more"),
    ] {
        if !(right && value.is_finite()) {
            return Err(ImportError::Option { what, value, rule });
        }
    }
    Ok(())
}

fn check_areas(source: &Source, side: f64) -> Result<(), ImportError> {
    for (state, polygons) in [("closed", &source.closed), ("open", &source.open)] {
        let flat = |polygon: &Vec<Point3>| doubled_area(polygon).norm() < LEAST_AREA * side * side;
        if let Some(piece) = polygons.iter().position(flat) {
            return Err(ImportError::NoArea { piece, state });
        }
    }
    Ok(())
}

/// Pieces that are not flat show by themselves that they are mirrored: they fit their mirror image better.
fn check_mirrored_shapes(source: &Source, side: f64, max_strain: f64) -> Result<(), ImportError> {
    let mirrored = |i: &usize| {
        let (closed, open) = (&source.closed[*i], &source.open[*i]);
        let image: Vec<Point3> = closed.iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect();
        misfit_of(closed, open) > max_strain * side && misfit_of(&image, open) <= max_strain * side
    };
    let pieces: Vec<usize> = (0..source.closed.len()).filter(mirrored).collect();
    if pieces.is_empty() { Ok(()) } else { Err(ImportError::Mirrored { pieces }) }
}

/// Turns the lists of pieces round; each keeps its first corner.
fn reverse(source: &mut Source, joints: &mut [Joint], pieces: &[usize]) {
    for &piece in pieces {
        source.closed[piece][1..].reverse();
        source.open[piece][1..].reverse();
    }
    for joint in joints {
        for (piece, vertex) in joint.pieces.iter().zip(&mut joint.vertices) {
            if pieces.binary_search(piece).is_ok() && *vertex > 0 {
                *vertex = source.closed[*piece].len() - *vertex;
            }
        }
    }
}

/// A line about each piece of which two corners nearly coincide, in one state at least.
fn nearly_repeated(source: &Source, side: f64) -> Vec<String> {
    let mut lines = Vec::new();
    for (piece, (closed, open)) in source.closed.iter().zip(&source.open).enumerate() {
        for i in 0..closed.len() {
            for j in i + 1..closed.len() {
                let [near, far] = [closed, open].map(|points| (points[i] - points[j]).norm() / side);
                if near.min(far) < NEARLY {
                    lines.push(format!(
                        "piece {piece}: its corners {i} and {j} nearly coincide, {:.1e} mean sides apart; kept as it is",
                        near.min(far)
                    ));
                }
            }
        }
    }
    lines
}

/// The design with these pieces and this gap in place of its own: corners, axes and angles found anew.
pub fn reassembled(old: &Design, pieces: Vec<Piece>, gap: f64, tolerance: f64) -> Design {
    let joint = |hinge: &Hinge| Joint { pieces: hinge.pieces, vertices: hinge.vertices };
    let joints: Vec<Joint> = old.hinges.iter().map(joint).collect();
    let (closed, open) = pieces.into_iter().map(|piece| (piece.closed, piece.open)).unzip();
    let source = Source { closed, open, constraints: None };
    design(&source, old.sheet_state, gap, tolerance, &joints)
}

/// Assembles the design. Corners are clusters of closed points: where slits are closed, pieces share the corners
/// between which their sides lie.
fn design(source: &Source, sheet_state: Option<State>, gap: f64, tolerance: f64, joints: &[Joint]) -> Design {
    let corners = Corners::new(&source.closed);
    let closed = row(&source.closed);
    // A thousandth more than the gap: what rounding and the tolerance leave of it.
    let reach = if gap > 0.0 { 1.001 * gap + tolerance } else { tolerance };
    let corner_of = clusters(near_pairs(&closed, reach), &corners.piece);
    let reference = if sheet_state == Some(State::Open) { row(&source.open) } else { closed };
    let points = members(&corner_of)
        .iter()
        .map(|cluster| {
            let mut points: Vec<Point3> = cluster.iter().map(|&c| reference[c]).collect();
            // Hinge points count once, however many pieces they hold.
            points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z)));
            points.dedup();
            mean(points)
        })
        .collect();
    let pieces = source
        .closed
        .iter()
        .zip(&source.open)
        .zip(&corners.first)
        .map(|((closed, open), &first)| Piece {
            corners: corner_of[first..first + closed.len()].to_vec(),
            closed: closed.clone(),
            open: open.clone(),
        })
        .collect();
    assemble(PatternKind::Imported, sheet_state, gap, points, pieces, joints)
}

/// The worst piece.
///
/// # Errors
/// It is less rigid than `max_strain` allows.
pub fn check_rigid(design: &Design, max_strain: f64) -> Result<Misfit, ImportError> {
    let strains = rigidity::strains(design);
    let worst = rigidity::worst(design).expect("a design has pieces");
    if worst.strain.is_nan() || worst.strain > max_strain {
        let beyond = strains.iter().filter(|strain| **strain > max_strain).count();
        return Err(ImportError::NotRigid {
            piece: worst.piece,
            strain: worst.strain,
            limit: max_strain,
            beyond,
        });
    }
    Ok(worst)
}
