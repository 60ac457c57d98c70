//! Sheets that are flat in their open state: windows between pieces that hang together at their hinges.
//!
//! The cuts run along the sides of the hinge polygons, so that half a kerf burns off every piece and closed sides
//! keep a kerf between them. At a hinge two windows leave a straight ligament of the profile's width and of the
//! length that its angle needs, with its pole on the hinge point. Closing bends it into the window whose sides come
//! together; its other face bulges into the gap between the hinge points of a closed corner.

pub mod rim;

pub mod neck;

pub mod trace;

pub mod cuts;

pub mod narrow;

pub mod ligament;

pub mod gap;

pub mod folded;

#[cfg(test)]
mod tests;

use self::cuts::WindowCuts;
use self::folded::check_folded_ligaments;
use self::gap::check_gaps;
use self::ligament::measure_ligaments;
use self::narrow::check_rims;
use super::collision::{check_corner_collisions, check_hinge_collisions};
use super::error::FabricationError;
use super::fabricate::LaidOut;
use super::regions::piece_outlines;
use super::states::motions;
use super::topology::{Topology, topology};
use super::web::{CutIndex, check_webs};
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// The cuts of a design where it lies, in no useful order, and its combinatorics.
///
/// # Errors
/// A damaged design, sides too short for ligaments, windows too narrow or too wide for them.
pub fn cuts_of(
    design: &Design,
    profile: &Profile,
    lengths: &[f64],
) -> Result<(WindowCuts, Topology), FabricationError> {
    let topology = topology(design)?;
    let cuts = WindowCuts::new(design, &topology, profile, lengths)?;
    Ok((cuts, topology))
}

/// Lays out a placed design and checks the result.
///
/// # Errors
/// Those of [`cuts_of`]; cuts too close together; pieces that fall off or hang together; a closed state without
/// room for the pieces or their folded ligaments.
pub fn lay_out(design: &Design, profile: &Profile, lengths: &[f64]) -> Result<LaidOut, FabricationError> {
    let (kerf, min_web) = (profile.cut.kerf, profile.cut.min_web);
    let (cuts, topology) = cuts_of(design, profile, lengths)?;
    let motions = motions(design);
    check_gaps(design, &topology, &motions, profile, &cuts.necks)?;
    let cuts = cuts.started_on_longest_straights();
    let index = CutIndex::new(&cuts.paths);
    check_rims(&cuts.paths, kerf, min_web)?;
    check_webs(&cuts.paths, &[], &index, kerf, min_web)?;
    let ligaments = measure_ligaments(&design.hinges, &cuts, &index, profile);
    let outlines = piece_outlines(design, &cuts.paths, &ligaments, kerf)?;
    check_hinge_collisions(design, &outlines, &ligaments)?;
    check_corner_collisions(design, &topology, &outlines)?;
    check_folded_ligaments(design, &topology, &motions, &outlines, &ligaments, profile)?;
    Ok(LaidOut { paths: cuts.paths, ligaments, outlines })
}
