//! Prints the tables of docs/laser.md: the way between cuts, and what piercing and heat cost, on regular sheets.

// The unit tests use the rest of it.
#[allow(dead_code)]
#[path = "../../src/fabrication/test_sheet.rs"]
mod test_sheet;

use std::time::Instant;

use kirimorph::fabrication::closed_sheet::cuts_of;
use kirimorph::fabrication::fabricate::{fabricate, hinge_points, ligament_lengths};
use kirimorph::fabrication::layout::CutKind;
use kirimorph::fabrication::order::{Travel, cutting_order, travel};
use kirimorph::fabrication::plan::{CutOptions, CutOrder, CutReport, Pierce, cut_plan};
use kirimorph::kirigami::design::Design;
// What the sheets of the unit tests are made of.
use kirimorph::{fabrication, geometry, kirigami, profile};
use test_sheet::{TestSheet, profile as steel};

fn main() {
    // `cargo test --all-targets` runs this too, with another argument, and means a build that works.
    if std::env::args().any(|argument| argument == "--bench") {
        ways();
        prices();
    }
}

/// A regular sheet of cells of 10 mm.
fn design(cells: [usize; 2]) -> Design {
    let sheet = TestSheet::rectangle(cells, [10.0, 10.0], steel().hinge_gap());
    sheet.design(sheet.full_angle())
}

fn ways() {
    println!("| slits | travel, mm | bound, mm | ratio | seconds |\n|---|---|---|---|---|");
    for cells in [[10, 10], [20, 20], [20, 21], [40, 40], [100, 100]] {
        let design = design(cells);
        let (cuts, _) = cuts_of(&design, &steel(), &vec![1.0; design.hinges.len()]).expect("a regular sheet");
        let begin = Instant::now();
        let order = cutting_order(&cuts.paths, &hinge_points(&design));
        let seconds = begin.elapsed().as_secs_f64();
        let Travel { length, bound } = travel(&order);
        let slits = order.iter().filter(|path| path.kind == CutKind::Slit).count();
        println!("| {slits} | {length:.0} | {bound:.0} | {:.3} | {seconds:.2} |", length / bound);
    }
}

fn prices() {
    println!(
        "\n| pierce, order | cuts | travel, mm | least rest, s | cuts that begin early | time, s |\n|---|---|---|---|---|---|"
    );
    let (design, steel) = (design([20, 20]), steel());
    let lengths = ligament_lengths(&design, &steel).expect("ligaments of the profile");
    let sheet = fabricate(&design, &steel, &lengths).expect("a regular sheet");
    let heat = |cool: f64| CutOrder::Heat { cool, within: None };
    for (pierce, order) in [
        (Pierce::SlitEnd, CutOrder::Travel),
        (Pierce::MidSlit, CutOrder::Travel),
        (Pierce::SlitEnd, heat(2.0)),
        (Pierce::SlitEnd, heat(5.0)),
        (Pierce::SlitEnd, heat(10.0)),
        (Pierce::MidSlit, heat(10.0)),
    ] {
        let options = CutOptions { pierce, order, ..CutOptions::default() };
        let plan = cut_plan(&sheet, &steel, &options).expect("a plan");
        let CutReport { cuts, travel, rest, times, .. } = plan.report;
        let seconds = times.map_or(f64::NAN, |times| times.total());
        let (length, least, early) = (travel.length, rest.least, rest.early);
        println!("| {pierce:?}, {order:?} | {cuts} | {length:.0} | {least:.2} | {early} | {seconds:.0} |");
    }
}
