//! The sheet as thick parts: the finished part in the sheet state, pieces and ligaments in one body, and the
//! bare pieces as they stand in the other state, with a check that they do not run into each other there.
//!
//! What goes in: the checked cuts, true outlines and rigid motions of [`crate::fabrication`], and how the
//! process leaves the walls of its cuts ([`Walls`]). Stages: [`outline`] burns the cuts and drops needless
//! points, `rulings` gives every point of an outline the direction in which its wall runs through the
//! sheet, [`caps`] triangulates the faces, [`loft()`] joins them to closed shells, [`clash`] looks for pieces
//! that interpenetrate.
//!
//! Frame: the sheet's, mid-plane z = 0, faces at z = -t/2 and +t/2; moved pieces stand in the frame of the
//! other state.
//!
//! Promised of the part: closed, oriented outwards, no vertex on another's edge, no face through another, and
//! exactly representable in single precision, so that an STL file holds what was checked. Outlines follow the
//! burned ones within [`outline::TOLERANCE`]. Not promised: that bent ligaments find room in the other state;
//! they are not modelled there.

pub mod error;

pub mod outline;

pub mod strokes;

pub mod harmonic;

pub mod rulings;

pub mod caps;

pub mod loft;

pub mod crossing;

pub mod clash;

#[cfg(test)]
mod tests;

use rayon::prelude::*;

use self::clash::{Clash, Placed, deepest};
use self::error::SolidError;
use self::loft::{joined, loft};
use self::outline::{Plate, plate};
use self::rulings::Rulings;
use self::strokes::Strokes;
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::outline::burned_bodies;
use crate::fabrication::states::{motions, other_name, other_vertices, sheet_vertices};
use crate::geometry::mesh::TriMesh;

/// How a process leaves the walls of its cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Walls {
    /// Straight down, as a laser cuts: right at the mid-plane, off by t/2 tan(tilt) at the faces beside a
    /// hinge.
    Vertical,
    /// Ruled surfaces, as a mill with five axes cuts: along the hinge's axis beside a hinge, interpolated
    /// between hinges.
    Ruled,
}

/// A sheet as solids.
#[derive(Debug, Clone, PartialEq)]
pub struct ThickSheet {
    /// The finished part in the sheet state: one closed shell per connected part, one after the other.
    pub part: TriMesh,
    /// Volume of the part by its outlines, cubic millimetres; the mesh encloses the same.
    pub volume: f64,
    /// The pieces without ligaments in the other state, one closed shell each, in the design's order.
    pub moved: TriMesh,
    /// Largest distance, at the faces, between a ligament's centre and its hinge axis, millimetres: t/2
    /// tan(tilt) for vertical walls, 0 for ruled ones.
    pub axis_error: f64,
    /// The two pieces that run deepest into each other in the other state, though no deeper than they may;
    /// `None` where none do.
    pub clash: Option<Clash>,
}

/// Makes a checked sheet thick.
///
/// `thickness`: of the sheet, millimetres.
///
/// # Errors
/// Walls that meet between their mid-plane and a face, outlines that touch themselves, pieces that
/// interpenetrate.
pub fn thicken(sheet: &Fabrication, thickness: f64, walls: Walls) -> Result<ThickSheet, SolidError> {
    let strokes = strokes(sheet, walls);
    let rulings = rulings(sheet, strokes.as_ref(), thickness)?;
    let ruled = |plate: Plate| ruled(plate, rulings.as_ref());
    let in_other_state = || {
        let pieces = placed(sheet, ruled)?;
        let clash = deepest(other_name(&sheet.design), &sheet.hinges, &pieces, thickness, walls)?;
        Ok((moved(&pieces, thickness)?, clash))
    };
    let in_sheet_state = || {
        let mut volume = 0.0;
        let mut shells = Vec::new();
        for body in burned_bodies(&sheet.layout.paths, sheet.layout.kerf) {
            let Some(plate) = plate(&body) else { continue };
            let shell = loft(&ruled(plate), thickness)?;
            volume += shell.volume;
            shells.push(shell.mesh);
        }
        Ok((joined(shells), volume))
    };
    let (other, part) = rayon::join(in_other_state, in_sheet_state);
    let ((moved, clash), (part, volume)) = (other?, part?);
    let error = |tilt: f64| match walls {
        Walls::Vertical => 0.5 * thickness * tilt.tan(),
        Walls::Ruled => 0.0,
    };
    let axis_error = sheet.hinges.iter().map(|row| error(row.tilt)).fold(0.0, f64::max);
    Ok(ThickSheet { part, volume, moved, axis_error, clash })
}

/// The pieces of a checked sheet as plates, with their motions into the other state.
///
/// # Errors
/// As [`thicken`], but for walls that meet and pieces that interpenetrate.
pub fn pieces(sheet: &Fabrication, thickness: f64, walls: Walls) -> Result<Vec<Placed>, SolidError> {
    let strokes = strokes(sheet, walls);
    let rulings = rulings(sheet, strokes.as_ref(), thickness)?;
    placed(sheet, |plate| ruled(plate, rulings.as_ref()))
}

/// The cuts' courses, which ruled walls follow; upright ones need none.
fn strokes(sheet: &Fabrication, walls: Walls) -> Option<Strokes> {
    let of_sheet = || Strokes::new(&sheet.layout.paths, &sheet.hinges, 0.5 * sheet.layout.kerf);
    (walls == Walls::Ruled).then(of_sheet)
}

/// How walls run that follow the hinges' axes.
fn rulings<'a>(
    sheet: &Fabrication,
    strokes: Option<&'a Strokes>,
    thickness: f64,
) -> Result<Option<Rulings<'a>>, SolidError> {
    strokes.map(|strokes| Rulings::new(strokes, &sheet.hinges, thickness)).transpose()
}

fn ruled(plate: Plate, rulings: Option<&Rulings>) -> Plate {
    match rulings {
        Some(rulings) => rulings.rule(&plate),
        None => plate,
    }
}

/// Every piece's plate with its motion into the other state.
fn placed(sheet: &Fabrication, ruled: impl Fn(Plate) -> Plate + Sync) -> Result<Vec<Placed>, SolidError> {
    let design = &sheet.design;
    let motions = motions(design);
    let place = |piece: usize| {
        let (motion, vertices) = (motions[piece], &design.pieces[piece]);
        let ends = sheet_vertices(design, vertices).iter().zip(other_vertices(design, vertices));
        let misfit = ends.map(|(p, q)| (motion.apply(p) - q).norm()).fold(0.0, f64::max);
        let outline = &sheet.outlines[piece];
        let [x, y] = outline.first().copied().unwrap_or_default();
        let plate = plate(std::slice::from_ref(outline)).ok_or(SolidError::Touches { x, y })?;
        Ok(Placed { plate: ruled(plate), motion, misfit, corners: vertices.corners.clone() })
    };
    (0..motions.len()).into_par_iter().map(place).collect()
}

/// The pieces' shells where their motions take them.
fn moved(pieces: &[Placed], thickness: f64) -> Result<TriMesh, SolidError> {
    let shell = |piece: &Placed| {
        let mut mesh = loft(&piece.plate, thickness)?.mesh;
        mesh.vertices.iter_mut().for_each(|vertex| *vertex = piece.motion.apply(vertex));
        Ok(mesh)
    };
    Ok(joined(pieces.par_iter().map(shell).collect::<Result<Vec<_>, _>>()?))
}
