//! What is made of a design: a sheet that is cut flat, or, where neither state is flat, an assembly of pieces.

use super::error::FabricationError;
use super::fabricate::{Fabrication, fabricate, ligament_lengths};
use super::hinge_table::{HingeRow, planned_rows};
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// A design that is flat in neither state: it cannot be cut from a sheet, only put together from its pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// The design, each state in the coordinates of its target.
    pub design: Design,
    /// One row per hinge, as it would have to be made.
    pub hinges: Vec<HingeRow>,
}

/// What is made of a design.
#[derive(Debug, Clone, PartialEq)]
pub enum Product {
    /// A checked sheet with its cuts.
    Sheet(Fabrication),
    /// Pieces and hinges without cuts.
    Assembly(Assembly),
}

impl Product {
    /// The design as it is made.
    pub fn design(&self) -> &Design {
        match self {
            Self::Sheet(sheet) => &sheet.design,
            Self::Assembly(assembly) => &assembly.design,
        }
    }

    /// One row per hinge of the design.
    pub fn hinges(&self) -> &[HingeRow] {
        match self {
            Self::Sheet(sheet) => &sheet.hinges,
            Self::Assembly(assembly) => &assembly.hinges,
        }
    }
}

/// Lays a design out for the laser where it has a flat state, and says what its hinges need where it has none.
///
/// # Errors
/// Those of [`fabricate()`]; an assembly has no errors, only hinges that fail.
pub fn produce(design: &Design, profile: &Profile) -> Result<Product, FabricationError> {
    if design.sheet_state.is_none() {
        let hinges = planned_rows(design, profile);
        return Ok(Product::Assembly(Assembly { design: design.clone(), hinges }));
    }
    let lengths = ligament_lengths(design, profile)?;
    Ok(Product::Sheet(fabricate(design, profile, &lengths)?))
}
