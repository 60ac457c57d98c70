//! A ligament as measured on the paths that will be cut, not by the formulas that made them.

use kurbo::Point;

/// A ligament as the burned paths leave it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredLigament {
    /// Least width between the relief bar's groove and the groove (or border) that passes, millimetres.
    pub width: f64,
    /// Free length: that of the burned relief bar, millimetres.
    pub length: f64,
    /// Midway between the two grooves at the bar's middle.
    pub centre: Point,
    /// Distance from `centre` to the hinge point, in the sheet plane, millimetres.
    pub centre_offset: f64,
    /// Material between the relief bar's groove and the nearest groove of another hinge or slit, millimetres. Not
    /// counted: the cuts that bound the ligament, and those across the slit that passes.
    pub nearest_cut: f64,
    /// The relief bar's centre line.
    pub bar: [Point; 2],
}
