//! Why a sheet cannot be milled.

/// Each message names the place, the value, the limit and the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MillingError {
    /// The tool's cutting edges do not reach through the sheet.
    #[error(
        "the tool's cutting edges are {given:.2} mm long, but sheet, breakthrough and tilt take {needed:.2} mm: give the \
         profile a tool with a larger flute_length_mm, or a thinner sheet"
    )]
    ShortEdges {
        /// Length that is needed, millimetres.
        needed: f64,
        /// Length of the edges, millimetres.
        given: f64,
    },
    /// No stretch of an opening is away from ligaments.
    #[error(
        "the cut near ({x:.2}, {y:.2}) mm has no place away from ligaments where the tool could go down: use larger pieces or a \
         thinner tool"
    )]
    NoEntry {
        /// Where.
        x: f64,
        /// Where.
        y: f64,
    },
}
