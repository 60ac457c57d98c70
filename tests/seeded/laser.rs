//! Laser files from spoiled layouts.

use kirimorph::fabrication::layout::{CutLayout, CutPath};
use kirimorph::output::dxf::{self, DxfVersion};
use kirimorph::output::svg;
use kirimorph::verify::{Fault, Files, ONE_PART, Wanted, hash_comment, verify};
use kurbo::{Point, Rect, Vec2};

use super::{HASH, Sample, distance, places};

/// What verification says of files written from a layout.
pub fn faults(sample: &Sample, layout: &CutLayout) -> Vec<Fault> {
    let (mut dxf, mut svg) = (Vec::new(), Vec::new());
    dxf::write(layout, DxfVersion::R2000, &[hash_comment(HASH)], &mut dxf).unwrap();
    svg::write(layout, &[hash_comment(HASH)], &mut svg).unwrap();
    let wanted = Wanted {
        design: &sample.sheet.design,
        profile: &sample.job.fabrication.profile,
        hash: HASH,
        copies: &ONE_PART,
        tabs: None,
    };
    verify(Files { dxf: &dxf, svg: &svg }, wanted).unwrap().faults
}

/// How far from what one of two layouts burns away the other burns, millimetres: how deep what is left by one is cut into by
/// the other.
pub fn differ(a: &CutLayout, b: &CutLayout) -> f64 {
    deepest(a, b).max(deepest(b, a))
}

/// How deep the changed cuts of a layout go into what another one leaves.
fn deepest(cut: &CutLayout, left: &CutLayout) -> f64 {
    const FLAT: f64 = 1e-4;
    let half = 0.5 * cut.kerf;
    let changed = cut.paths.iter().filter(|path| !left.paths.contains(path));
    let of_path = |path: &CutPath| {
        let lines = path.segments(FLAT);
        let ends = lines.iter().flatten();
        let start = Rect::from_points(lines[0][0], lines[0][1]);
        let place = ends.fold(start, |place, end| place.union_pt(*end)).inflate(1.0, 1.0);
        let near = |line: &[Point; 2]| Rect::from_points(line[0], line[1]).overlaps(place);
        let others: Vec<[Point; 2]> =
            left.paths.iter().flat_map(|path| path.segments(FLAT)).filter(near).collect();
        // The burned groove: round its middle line, on two rings.
        let burned = lines.into_iter().flat_map(|line| places(line, 0.01)).flat_map(|at| {
            let ring = move |radius: f64| {
                (0..16)
                    .map(move |i| at + radius * Vec2::from_angle(f64::from(i) * std::f64::consts::PI / 8.0))
            };
            [at].into_iter().chain(ring(0.5 * half)).chain(ring(half))
        });
        burned.map(|at| distance(at, &others) - half).fold(0.0, f64::max)
    };
    changed.map(of_path).fold(0.0, f64::max)
}
