//! From a design and its hinge report to the answer: how much energy the snap takes, how much the hinges strain, whether
//! the sheet is bistable at all.

use super::cell::Cell;
use super::ligament::Ligament;
use super::sheet::{Sheet, SheetSnap};
use super::yielding::{Passage, pass};
use crate::fabrication::hinge_table::HingeRow;
use crate::kirigami::design::{Design, PatternKind, Piece, State};
use crate::profile::Profile;

/// Steps of the drive from one state to the other.
pub const STEPS: usize = 24;
/// Steps of one cell: loads that yield need finer ones.
const CELL_STEPS: usize = 72;

/// The snap of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Snap {
    /// The sheet's elastic way.
    pub sheet: SheetSnap,
    /// The mean rectangle with ligaments that yield; only for bistable patterns.
    pub cell: Option<CellSnap>,
}

/// The mean rectangle of a bistable pattern, alone in a regular sheet that is cut closed. One that is cut open is its mirror
/// image, but for the directions of the ligaments, which differ by phi.
#[derive(Debug, Clone, PartialEq)]
pub struct CellSnap {
    /// Its dimensions.
    pub cell: Cell,
    /// How many rectangles the design has with four hinges.
    pub rectangles: usize,
    /// How many of them would snap, each in a regular sheet of its own kind.
    pub snapping: usize,
    /// Elastic energy to get over, on the way out, mJ.
    pub barrier: f64,
    /// Likewise on the way back; 0 where elastic ligaments make no second minimum.
    pub back_barrier: f64,
    /// The passage with ligaments that yield.
    pub passage: Passage,
}

/// Computes the snap of a design with the ligaments that its hinge report describes.
pub fn assess(design: &Design, rows: &[HingeRow], profile: &Profile) -> Snap {
    let ligaments: Vec<Ligament> = rows.iter().map(|row| Ligament::of_profile(profile, row.length)).collect();
    snap(design, &ligaments)
}

/// Computes the snap of a design with these ligaments, one per hinge.
pub fn snap(design: &Design, ligaments: &[Ligament]) -> Snap {
    Snap { sheet: Sheet::new(design, ligaments).snap(STEPS), cell: cell_snap(design, ligaments) }
}

/// The rectangles with four hinges, in the design's order, each with its first hinge. `None` where there is none.
fn cell_snap(design: &Design, ligaments: &[Ligament]) -> Option<CellSnap> {
    if design.pattern != PatternKind::Bistable {
        return None;
    }
    let mut angles: Vec<Vec<f64>> = vec![Vec::new(); design.pieces.len()];
    let mut first: Vec<Option<usize>> = vec![None; design.pieces.len()];
    for (i, hinge) in design.hinges.iter().enumerate() {
        for piece in hinge.pieces {
            angles[piece].push(hinge.angle);
            first[piece].get_or_insert(i);
        }
    }
    let rectangles = design.pieces.iter().zip(&angles).zip(&first);
    let cells: Vec<(Cell, Ligament)> = rectangles
        .filter(|((piece, angles), _)| piece.corners.len() == 4 && angles.len() == 4)
        .filter_map(|((piece, angles), hinge)| Some((rectangle(piece, angles), ligaments[(*hinge)?])))
        .collect();
    let (_, ligament) = *cells.first()?;
    let count = cells.len() as f64;
    let mean =
        |figure: &dyn Fn(&Cell) -> f64| cells.iter().map(|(cell, _)| figure(cell)).sum::<f64>() / count;
    let cell =
        Cell { rectangle: [mean(&|c| c.rectangle[0]), mean(&|c| c.rectangle[1])], phi: mean(&|c| c.phi) };
    let path = cell.path(&ligament, CELL_STEPS);
    Some(CellSnap {
        cell,
        rectangles: cells.len(),
        snapping: cells.iter().filter(|(cell, ligament)| pass(cell, ligament, CELL_STEPS).snaps()).count(),
        barrier: path.barrier,
        back_barrier: path.back_barrier,
        passage: pass(&cell, &ligament, CELL_STEPS),
    })
}

/// A rectangle's sides, and half the mean turn of its hinges.
fn rectangle(piece: &Piece, angles: &[f64]) -> Cell {
    let points = piece.vertices(State::Closed);
    let side = |i: usize| (points[(i + 1) % 4] - points[i]).norm();
    let phi = angles.iter().sum::<f64>() / (2 * angles.len()) as f64;
    Cell { rectangle: [0.5 * (side(0) + side(2)), 0.5 * (side(1) + side(3))], phi }
}

#[cfg(test)]
mod tests {
    use super::super::ligament::{NOTCH_ROOT, Neck, PIECE_COMPLIANCE, Stock};
    use super::*;
    use crate::kirigami::bistable::cell::BistableCell;
    use crate::kirigami::bistable::pattern::regular;
    use std::path::Path;

    const DRY: Stock = Stock { modulus: 3300.0, thickness: 5.0, yield_strain: 82.0 / 3300.0 };
    const MOIST: Stock = Stock { modulus: 1500.0, thickness: 5.0, yield_strain: 50.0 / 1500.0 };

    fn notch(stock: &Stock, straight: f64) -> Ligament {
        let neck = Neck { width: 0.5, straight, radius: 0.5, two_sided: false };
        Ligament::new(&neck, stock, NOTCH_ROOT, PIECE_COMPLIANCE)
    }

    fn row(name: &str, side: f64, degrees: f64, ligament: &Ligament) -> String {
        let cell = Cell { rectangle: [side; 2], phi: degrees.to_radians() };
        let (path, passage) = (cell.path(ligament, CELL_STEPS), pass(&cell, ligament, CELL_STEPS));
        let spring = &ligament.spring;
        let verdict = if passage.snaps() { "yes" } else { "no" };
        format!(
            "| {name} | {side} | {degrees} | {:.0} | {:.0} | {:.0} | {:.1} | {:.1} | {:.0} | {:.1} | {:.1} | {verdict} |",
            spring.bending,
            spring.axial,
            spring.shear,
            path.barrier,
            path.back_barrier,
            100.0 * path.largest_strain,
            passage.resistance,
            passage.release.max(0.0)
        )
    }

    #[test]
    fn the_tables_of_the_docs_are_what_the_program_computes() {
        let steel = crate::profile::load("steel-304-0.5mm", Path::new("")).unwrap();
        let steel = Ligament::of_profile(&steel, 0.5);
        let kinds = [
            ("nylon, dry", notch(&DRY, 0.0)),
            ("nylon, dry, 1 mm longer", notch(&DRY, 1.0)),
            ("nylon, moist", notch(&MOIST, 0.0)),
            ("nylon, moist, 1 mm longer", notch(&MOIST, 1.0)),
            ("steel, beam of 0.5 mm", steel),
        ];
        let docs = include_str!("../../docs/snap.md");
        let mut missing = Vec::new();
        for (side, degrees) in [(7.2, 13.0), (7.2, 15.0), (8.4, 18.0)] {
            for (name, ligament) in &kinds {
                let row = row(name, side, degrees, ligament);
                if !docs.contains(&row) {
                    missing.push(row);
                }
            }
        }
        assert!(missing.is_empty(), "docs/snap.md lacks\n{}", missing.join("\n"));
    }

    #[test]
    fn the_rectangles_of_a_regular_sheet_are_the_cell() {
        let cell =
            BistableCell { cell: [20.0, 22.0], rectangle: [7.2, 8.0], phi: 15_f64.to_radians(), gap: 1.5 };
        let (mesh, pattern) = regular(&cell, [3, 2]);
        let design = pattern.design(&mesh, cell.gap, Some(State::Closed));
        let found = cell_snap(&design, &[notch(&DRY, 0.0); 24]).unwrap();
        assert_eq!((design.hinges.len(), found.rectangles), (24, 6));
        assert!((found.cell.rectangle[0] - 7.2).abs() < 1e-9 && (found.cell.rectangle[1] - 8.0).abs() < 1e-9);
        assert!((found.cell.phi - cell.phi).abs() < 1e-9);
        assert_eq!(found.snapping, if found.passage.snaps() { 6 } else { 0 });
        assert!(found.passage.snaps());
    }
}
