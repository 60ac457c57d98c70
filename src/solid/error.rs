//! Why a sheet cannot be made thick.

use super::clash::Clash;

/// Each message names the place, the value, the limit and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolidError {
    /// A hinge axis that lies too flat for a wall.
    #[error(
        "hinge {hinge} at ({x:.2}, {y:.2}) mm: its axis tilts by {tilt_deg:.1} degrees from the sheet's normal, but walls \
         can follow it to {limit_deg:.0} degrees only: let the target bend less there"
    )]
    FlatAxis {
        /// The hinge.
        hinge: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
        /// Its tilt.
        tilt_deg: f64,
        /// The largest tilt.
        limit_deg: f64,
    },
    /// Ruled walls that meet on their way to a face.
    #[error(
        "the walls of a cut meet at ({x:.2}, {y:.2}) mm, {depth:.2} mm from the mid-plane: their hinge axes bring them \
         {closing:.3} mm nearer there than at the mid-plane, where they stand {width:.3} mm apart: take a thinner sheet, a \
         wider cut, or let the target bend less there"
    )]
    WallsMeet {
        /// Where, at the mid-plane.
        x: f64,
        /// Where, at the mid-plane.
        y: f64,
        /// Height above the mid-plane.
        depth: f64,
        /// By how much both walls move relative to each other.
        closing: f64,
        /// Distance of the walls at the mid-plane.
        width: f64,
    },
    /// A wall whose rulings cross each other before they reach a face.
    #[error(
        "the wall at ({x:.2}, {y:.2}) mm folds over {depth:.2} mm from the mid-plane: hinge axes turn too fast along it; take \
         a thinner sheet, larger pieces, or let the target bend less there"
    )]
    WallFolds {
        /// Where, at the mid-plane.
        x: f64,
        /// Where, at the mid-plane.
        y: f64,
        /// Height above the mid-plane.
        depth: f64,
    },
    /// An outline that touches or crosses itself, so that no closed solid has it.
    #[error(
        "what the cuts leave of the sheet touches itself near ({x:.3}, {y:.3}) mm, so it bounds no solid: let cuts keep \
         farther from each other there"
    )]
    Touches {
        /// Where.
        x: f64,
        /// Where.
        y: f64,
    },
    /// Thick pieces run into each other in the other state.
    #[error("{0}: take a thinner sheet or a wider kerf, or let the target bend less there")]
    Clash(Clash),
}
