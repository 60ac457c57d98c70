//! The test coupon's files, read back: every feature has its nominal size when burned.

use kurbo::{Point, Vec2};

use super::agreement;
use super::contacts::Contacts;
use super::fault::{Check, Fault};
use super::grooves::{Grooves, around};
use super::machine_file::{MachineFile, ReadError};
use super::{Files, paths, read_dxf, read_svg};
use crate::fabrication::coupon::{Feature, Measure};
use crate::fabrication::web::nearest_on_segment;
use crate::profile::Profile;

/// Largest difference of a burned size from the nominal one, millimetres.
pub const SIZE_TOLERANCE: f64 = 1e-3;

/// What is wrong with the files of a coupon; nothing, if they may be cut.
///
/// # Errors
/// A file that is no DXF or SVG.
pub fn verify_coupon(files: Files, features: &[Feature], profile: &Profile) -> Result<Vec<Fault>, ReadError> {
    let [dxf, svg] = [read_dxf::read(files.dxf)?, read_svg::read(files.svg, profile)?];
    let mut faults: Vec<Fault> = [&dxf, &svg].into_iter().flat_map(|file| file.faults.clone()).collect();
    faults.extend(agreement::compare(&dxf, &svg).fault);
    for file in [&dxf, &svg] {
        faults.extend(measure(file, features, profile));
    }
    Ok(faults)
}

fn measure(file: &MachineFile, features: &[Feature], profile: &Profile) -> Vec<Fault> {
    let mut faults = paths::check_numbers(file);
    if !faults.is_empty() || file.paths.is_empty() {
        return faults;
    }
    paths::check_stock(file, profile, &mut faults);
    paths::check_segments(file, &mut faults);
    paths::check_borders(file, 1, &mut faults);
    let grooves = Grooves::new(&file.paths);
    // The coupon's ligaments are narrower than the profile's webs, on purpose.
    let least = features.iter().filter(|feature| feature.measure == Measure::Ligament);
    let mut lenient = profile.clone();
    lenient.cut.min_web = least.map(|feature| feature.nominal).fold(f64::INFINITY, f64::min);
    if let Ok(contacts) = Contacts::new(&grooves, &lenient) {
        paths::check_webs(file, &contacts, &lenient, &mut faults);
    }
    let kerf = profile.cut.kerf;
    for feature in features {
        let span = |axis: Vec2| -> f64 { reach(&grooves, feature, axis) + reach(&grooves, feature, -axis) };
        let (x, y) = (Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0));
        let sizes = match feature.measure {
            Measure::Ligament => vec![span(y) - kerf],
            Measure::Slot => vec![span(x) + kerf],
            Measure::Hole => vec![span(x) + kerf, span(y) + kerf],
        };
        for size in sizes {
            let off = (size - feature.nominal).abs();
            if off > SIZE_TOLERANCE || off.is_nan() {
                let says = format!(
                    "is {size:.4} mm wide when burned, nominal {:.4} mm, the limit is +- {SIZE_TOLERANCE} mm",
                    feature.nominal
                );
                faults.push(Fault::new(Check::Size, file.name, &*feature.name, feature.at, says));
            }
        }
    }
    faults
}

/// Distance from a feature's middle to the nearest groove's centre line in a direction, within 45 degrees of it.
fn reach(grooves: &Grooves, feature: &Feature, axis: Vec2) -> f64 {
    let place = around(feature.at, 2.0 * feature.nominal);
    let feet = grooves.near(place).map(|i| nearest_on_segment(feature.at, grooves.segments[i].ends));
    let ahead = |foot: &Point| {
        let by = *foot - feature.at;
        by.dot(axis) >= by.cross(axis).abs() - 1e-9
    };
    feet.filter(ahead).map(|foot| foot.distance(feature.at)).fold(f64::INFINITY, f64::min)
}
