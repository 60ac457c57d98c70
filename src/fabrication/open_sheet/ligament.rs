//! Measures the ligaments of an open sheet on the paths that will be cut.

use kurbo::Point;

use super::cuts::{Flat, WindowCuts};
use super::neck::Neck;
use crate::fabrication::ligament::MeasuredLigament;
use crate::fabrication::mechanics::pole_offset;
use crate::fabrication::web::{CutIndex, nearest_on_segment};
use crate::kirigami::design::Hinge;
use crate::profile::{Profile, Shape};

/// Measures the ligament of every hinge, in the hinges' order.
///
/// `hinges`: the design's hinges in sheet coordinates; `cuts`: made from it; `index` of the same paths.
pub fn measure_ligaments(
    hinges: &[Hinge],
    cuts: &WindowCuts,
    index: &CutIndex,
    profile: &Profile,
) -> Vec<MeasuredLigament> {
    let kerf = profile.cut.kerf;
    // A notch reaches to the ends of the groove's rounds.
    let rounds = if matches!(profile.ligament.shape, Shape::Notch { .. }) { kerf } else { 0.0 };
    let measure = |((hinge, flats), neck): ((&Hinge, &[Flat; 2]), &Neck)| {
        let [first, second] = flats.map(|flat| cuts.segment(flat));
        let across = |from: [Point; 2], to: [Point; 2]| {
            let distance = |point: Point| point.distance(nearest_on_segment(point, to));
            distance(from[0]).min(distance(from[1]))
        };
        let lengths = [first, second].map(|[a, b]| a.distance(b));
        // The shorter flat decides where the ligament is.
        let [short, long] = if lengths[0] <= lengths[1] { [first, second] } else { [second, first] };
        let middle = short[0].midpoint(short[1]);
        let centre = middle.midpoint(nearest_on_segment(middle, long));
        let around = [first, second].map(|flat| index.nearest(flat, &flats.map(|flat| flat.path)));
        let length = lengths[0].min(lengths[1]) + rounds;
        let pole = pole_offset(profile, neck.length + rounds, hinge.angle);
        MeasuredLigament {
            width: across(first, second).min(across(second, first)) - kerf,
            length,
            asked: length,
            centre,
            pole_offset: pole,
            centre_offset: centre.distance(neck.centre) + (pole - neck.pole).abs(),
            nearest_cut: around[0].min(around[1]) - kerf,
            bar: short,
        }
    };
    hinges.iter().zip(&cuts.flats).zip(&cuts.necks).map(measure).collect()
}
