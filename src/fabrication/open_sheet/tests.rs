//! Open sheets laid out from exact flat designs, against closed forms and invariances.

use crate::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use crate::fabrication::test_sheet::{TestSheet, cut_open, profile, sheets};

fn made(sheet: &TestSheet, phi: f64) -> Fabrication {
    let design = cut_open(sheet.design(phi));
    fabricate(&design, &profile(), &ligament_lengths(&design, &profile()).unwrap()).unwrap()
}

#[test]
fn look() {
    for (i, (sheet, phi)) in sheets().iter().enumerate() {
        let made = made(sheet, *phi);
        let file = std::fs::File::create(format!("/tmp/hb/look{i}.svg")).unwrap();
        crate::output::svg::write(&made.layout, &[], file).unwrap();
        for row in &made.hinges {
            println!("{} {} {} {} {} {:?} {}", row.width, row.length, row.centre_offset, row.nearest_cut, row.angle, row.verdict, row.reason);
        }
    }
}
