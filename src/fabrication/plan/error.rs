//! Why a sheet cannot be cut as it is asked for: each message names the value, the limit and the remedy. Millimetres.

use thiserror::Error;

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanError {
    /// More copies than the sheet has room for.
    #[error(
        "{copies} copies of {width:.2} x {height:.2} mm do not fit on the sheet with {spacing} mm between them: {fit} do, \
         {columns} in each of {rows} rows; ask for fewer copies, less spacing_mm, or take a larger sheet"
    )]
    TooManyCopies {
        /// Copies that were asked for.
        copies: usize,
        /// Copies that fit.
        fit: usize,
        /// Copies that fit beside each other.
        columns: usize,
        /// Rows that fit.
        rows: usize,
        /// A part's size in x, with its kerf.
        width: f64,
        /// A part's size in y, with its kerf.
        height: f64,
        /// Between burned edges.
        spacing: f64,
    },
    /// The border has too few places for tabs.
    #[error(
        "{tabs} tabs of {width} mm do not fit on the border evenly, on straight stretches {clear:.2} mm from slits and hinges: \
         {fit} do; ask for fewer or narrower ones (tabs, tab_mm)"
    )]
    TooManyTabs {
        /// Tabs that were asked for.
        tabs: usize,
        /// Tabs that fit.
        fit: usize,
        /// Their width.
        width: f64,
        /// Least distance from slits and hinges.
        clear: f64,
    },
    /// The border can be reached by no lead.
    #[error(
        "no lead of {length} mm has room outside of the border, which begins at ({x:.2}, {y:.2}) mm: take a shorter one \
         (lead_mm), more room between copies (spacing_mm), or a larger sheet"
    )]
    NoRoomForLead {
        /// Where the border begins.
        x: f64,
        /// Where the border begins.
        y: f64,
        /// The length asked for.
        length: f64,
    },
}
