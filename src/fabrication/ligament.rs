//! A ligament as measured on the paths that will be cut, not by the formulas that made them.

use kurbo::Point;

/// A ligament as the burned paths leave it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredLigament {
    /// Least width between the relief bar's groove and the groove (or border) that passes, or between the straight ends
    /// of the two windows of an open sheet, millimetres.
    pub width: f64,
    /// Free length: that of the burned relief bar, or of the shorter window's straight end, millimetres.
    pub length: f64,
    /// The free length that was asked for; it is shorter where there was no room for it.
    pub asked: f64,
    /// Midway between the two grooves at the bar's (or straight end's) middle.
    pub centre: Point,
    /// How far from the hinge point its centre belongs, away from the groove that passes, so that the bent ligament turns
    /// about the point, millimetres.
    pub pole_offset: f64,
    /// Distance from `centre` to there, in the sheet plane, millimetres.
    pub centre_offset: f64,
    /// Material between the relief bar's groove and the nearest groove of another hinge or slit, millimetres. Not
    /// counted: the cuts that bound the ligament, and those across the slit that passes.
    pub nearest_cut: f64,
    /// The centre line of the relief bar, or of one straight end; the same point twice for a slit's round end.
    pub bar: [Point; 2],
}
