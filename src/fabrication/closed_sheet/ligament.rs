//! Measures the ligaments on the paths that will be cut, not by the formulas that made them.

use kurbo::Point;
use rayon::prelude::*;

use super::cuts::{CutSet, HingeCuts};
use crate::fabrication::cuts::ARC_TOLERANCE;
use crate::fabrication::ligament::MeasuredLigament;
use crate::fabrication::mechanics::pole_offset;
use crate::fabrication::web::{CutIndex, nearest_on_segment};
use crate::kirigami::design::Hinge;
use crate::profile::Profile;

/// Measures the ligament of every hinge, in the hinges' order.
///
/// `hinges`: the design's hinges in sheet coordinates; `set`: the cuts made from it; `index` of the same paths.
pub fn measure_ligaments(
    hinges: &[Hinge],
    set: &CutSet,
    index: &CutIndex,
    profile: &Profile,
) -> Vec<MeasuredLigament> {
    let kerf = profile.cut.kerf;
    let segments: Vec<_> = set.paths.iter().map(|path| path.segments(ARC_TOLERANCE)).collect();
    let measure = |(hinge, cuts): (&Hinge, &HingeCuts)| {
        let own = cuts.relief.unwrap_or(cuts.slits[0]);
        let vertices = &set.paths[own].vertices;
        let mut bar = [vertices[0].point, vertices[vertices.len() - 1].point];
        if cuts.relief.is_none() {
            let point = Point::new(hinge.point.x, hinge.point.y);
            let [first, last] = bar.map(|end| end.distance_squared(point));
            bar = [bar[usize::from(last < first)]; 2];
        }
        let foot = |point: Point| {
            let feet = cuts.passing.iter().flat_map(|&path| &segments[path]);
            let feet = feet.map(|&segment| nearest_on_segment(point, segment));
            feet.min_by(|a, b| point.distance_squared(*a).total_cmp(&point.distance_squared(*b)))
                .unwrap_or(point)
        };
        let middle = bar[0].midpoint(bar[1]);
        let width = [bar[0], middle, bar[1]].map(|point| point.distance(foot(point)) - kerf);
        let centre = middle.midpoint(foot(middle));
        let mut except = vec![own];
        except.extend(cuts.slits.iter().chain(&cuts.passing).chain(&cuts.across));
        let length = bar[0].distance(bar[1]) + kerf;
        let pole = pole_offset(profile, length, hinge.angle);
        let place = Point::new(hinge.point.x, hinge.point.y) + pole * cuts.normal;
        MeasuredLigament {
            width: width[0].min(width[1]).min(width[2]),
            length,
            asked: length,
            centre,
            pole_offset: pole,
            centre_offset: centre.distance(place),
            nearest_cut: index.nearest(bar, &except) - kerf,
            bar,
        }
    };
    hinges.par_iter().zip(&set.hinges).map(measure).collect()
}
