//! Measures the ligaments of an open sheet on the paths that will be cut.

use kurbo::Point;

use super::cuts::{Flat, WindowCuts};
use crate::fabrication::ligament::MeasuredLigament;
use crate::fabrication::web::{CutIndex, nearest_on_segment};
use crate::kirigami::design::Hinge;

/// Measures the ligament of every hinge, in the hinges' order.
///
/// `hinges`: the design's hinges in sheet coordinates; `cuts`: made from it; `index` of the same paths.
pub fn measure_ligaments(
    hinges: &[Hinge],
    cuts: &WindowCuts,
    index: &CutIndex,
    kerf: f64,
) -> Vec<MeasuredLigament> {
    let measure = |(hinge, flats): (&Hinge, &[Flat; 2])| {
        let [first, second] = flats.map(|flat| cuts.segment(flat));
        let across = |from: [Point; 2], to: [Point; 2]| {
            let distance = |point: Point| point.distance(nearest_on_segment(point, to));
            distance(from[0]).min(distance(from[1]))
        };
        let [middle, opposite] = [first, second].map(|[a, b]| a.midpoint(b));
        let centre = middle.midpoint(nearest_on_segment(middle, second));
        let around = [first, second].map(|flat| index.nearest(flat, &flats.map(|flat| flat.path)));
        let lengths = [first, second].map(|[a, b]| a.distance(b));
        // The bar from the flat's middle, as long as the shorter one.
        let length = lengths[0].min(lengths[1]);
        let half = 0.5 * length * (first[1] - first[0]).normalize();
        MeasuredLigament {
            width: across(first, second).min(across(second, first)) - kerf,
            length,
            centre,
            centre_offset: middle.midpoint(opposite).distance(Point::new(hinge.point.x, hinge.point.y)),
            nearest_cut: around[0].min(around[1]) - kerf,
            bar: [middle - half, middle + half],
        }
    };
    hinges.iter().zip(&cuts.flats).map(measure).collect()
}
