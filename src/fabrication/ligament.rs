//! Measures the ligaments on the paths that will be cut, not by the formulas that made them.

use kurbo::Point;

use super::cuts::{ARC_TOLERANCE, CutSet, HingeCuts};
use super::web::{CutIndex, nearest_on_segment};
use crate::kirigami::design::Hinge;

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

/// Measures the ligament of every hinge, in the hinges' order.
///
/// `hinges`: the design's hinges in sheet coordinates; `set`: the cuts made from it; `index` of the same paths.
pub fn measure_ligaments(
    hinges: &[Hinge],
    set: &CutSet,
    index: &CutIndex,
    kerf: f64,
) -> Vec<MeasuredLigament> {
    let segments: Vec<_> = set.paths.iter().map(|path| path.segments(ARC_TOLERANCE)).collect();
    let measure = |(hinge, cuts): (&Hinge, &HingeCuts)| {
        let vertices = &set.paths[cuts.relief].vertices;
        let bar = [vertices[0].point, vertices[vertices.len() - 1].point];
        let foot = |point: Point| {
            let feet = cuts.passing.iter().flat_map(|&path| &segments[path]);
            let feet = feet.map(|&segment| nearest_on_segment(point, segment));
            feet.min_by(|a, b| point.distance_squared(*a).total_cmp(&point.distance_squared(*b)))
                .unwrap_or(point)
        };
        let middle = bar[0].midpoint(bar[1]);
        let width = [bar[0], middle, bar[1]].map(|point| point.distance(foot(point)) - kerf);
        let centre = middle.midpoint(foot(middle));
        let mut except = vec![cuts.relief, cuts.slit];
        except.extend(cuts.passing.iter().chain(&cuts.across));
        MeasuredLigament {
            width: width[0].min(width[1]).min(width[2]),
            length: bar[0].distance(bar[1]) + kerf,
            centre,
            centre_offset: centre.distance(Point::new(hinge.point.x, hinge.point.y)),
            nearest_cut: index.nearest(bar, &except) - kerf,
            bar,
        }
    };
    hinges.iter().zip(&set.hinges).map(measure).collect()
}
