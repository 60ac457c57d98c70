//! Sheets that are flat in their closed state: slits along the closed edges, T relief bars at the hinges, a border.

pub mod frame;

pub mod junction;

pub mod slit;

pub mod border;

pub mod cuts;

pub mod ligament;

pub mod room;

#[cfg(test)]
mod bistable_tests;

use std::collections::BTreeMap;

use self::cuts::{CutSet, cut_set};
use self::frame::corner_frames;
use self::junction::junctions;
use self::room::{Fitted, crowded, fitted};
use self::slit::Plan;
use super::collision::{check_corner_collisions, check_hinge_collisions};
use super::error::FabricationError;
use super::fabricate::LaidOut;
use super::regions::piece_outlines;
use super::topology::{Topology, topology};
use super::web::check_webs;
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// The cuts of a design where it lies, in no useful order, and its combinatorics.
///
/// # Errors
/// A damaged design, corners that cannot be cut, sides too short for ligaments.
pub fn cuts_of(
    design: &Design,
    profile: &Profile,
    lengths: &[f64],
) -> Result<(CutSet, Topology), FabricationError> {
    let topology = topology(design)?;
    let frames = corner_frames(design, &topology, lengths, profile)?;
    let none = BTreeMap::new();
    let plan = Plan::new(&topology, &frames, &none, lengths, profile);
    let junctions = junctions(&plan, design)?;
    let set = cut_set(&Plan { junctions: &junctions, ..plan })?;
    Ok((set, topology))
}

/// Lays out a placed design and checks the result.
///
/// # Errors
/// Those of [`cuts_of`]; cuts too close together; pieces that fall off, hang together or collide when they open.
pub fn lay_out(design: &Design, profile: &Profile, lengths: &[f64]) -> Result<LaidOut, FabricationError> {
    let kerf = profile.cut.kerf;
    let Fitted { cuts, topology, index, ligaments } = fitted(design, profile, lengths)?;
    check_webs(&cuts.paths, &cuts.touches, &index, kerf, profile.cut.min_web)
        .map_err(|error| crowded(design, profile, &ligaments).unwrap_or(error))?;
    let outlines = piece_outlines(design, &cuts.paths, &ligaments, kerf)?;
    check_hinge_collisions(design, &outlines, &ligaments)?;
    check_corner_collisions(design, &topology, &outlines)?;
    Ok(LaidOut { paths: cuts.paths, ligaments, outlines })
}
