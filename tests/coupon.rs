//! The test coupon: its files hold what they say, and faults in them are found.

mod program;

use std::path::Path;

use kirimorph::fabrication::coupon::{Coupon, Measure, coupon};
use kirimorph::fabrication::layout::{CutKind, CutLayout};
use kirimorph::output::dxf::{self, DxfVersion};
use kirimorph::output::svg;
use kirimorph::profile::{self, Profile};
use kirimorph::verify::{Check, Fault, Files, verify_coupon};
use kurbo::Vec2;

/// Name of a seeded fault, the check that must notice, and the change.
type Seed = (&'static str, Check, fn(&mut CutLayout));

fn profiles() -> Vec<Profile> {
    let names = ["steel-304-0.5mm", "nitrile-rubber-2mm"];
    names.map(|name| profile::load(name, Path::new(".")).unwrap()).into()
}

fn faults(coupon: &Coupon, layout: &CutLayout, profile: &Profile) -> Vec<Fault> {
    let (mut dxf, mut svg) = (Vec::new(), Vec::new());
    dxf::write(layout, DxfVersion::R2000, &[], &mut dxf).unwrap();
    svg::write(layout, &[], &mut svg).unwrap();
    verify_coupon(Files { dxf: &dxf, svg: &svg }, &coupon.features, profile).unwrap()
}

#[test]
fn every_feature_has_its_size_and_faults_are_found() {
    for profile in profiles() {
        let coupon = coupon(&profile).unwrap();
        assert_eq!(faults(&coupon, &coupon.layout, &profile), []);
        let of = |measure| coupon.features.iter().filter(|f| f.measure == measure).count();
        assert_eq!([Measure::Ligament, Measure::Slot, Measure::Hole].map(of), [10, 4, 3]);
        // A wider groove than the profile's shows at once, as it would on the machine.
        let mut wide = profile.clone();
        wide.cut.kerf += 0.02;
        let found = faults(&coupon, &coupon.layout, &wide);
        assert!(found.iter().filter(|fault| fault.check == Check::Size).count() >= 2 * 17, "{found:?}");
        // A hole moved on to another's place, a slit lost, a cut twice, a part beyond the margin.
        let seeds: [Seed; 4] = [
            ("lost", Check::Size, |layout| _ = layout.paths.remove(2)),
            ("moved", Check::Size, |layout| {
                let hole = layout.paths.iter().rposition(|path| path.kind == CutKind::Window).unwrap();
                layout.paths[hole].vertices.iter_mut().for_each(|v| v.point += Vec2::new(0.01, 0.01));
                layout.paths[hole].vertices[0].point += Vec2::new(0.1, 0.0);
            }),
            ("twice", Check::Duplicate, |layout| layout.paths.insert(0, layout.paths[0].clone())),
            ("off", Check::Stock, |layout| {
                let vertices = layout.paths.iter_mut().flat_map(|path| &mut path.vertices);
                vertices.for_each(|v| v.point -= Vec2::new(0.1, 0.0));
            }),
        ];
        for (name, check, change) in seeds {
            let mut layout = coupon.layout.clone();
            change(&mut layout);
            let found = faults(&coupon, &layout, &profile);
            assert!(found.iter().any(|fault| fault.check == check), "{name}: {found:?}");
        }
    }
}

#[test]
fn the_command_leaves_files_and_says_how_to_measure() {
    let folder = std::env::temp_dir().join(format!("kirimorph-coupon-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let made = program::run(&folder, ["coupon", "--profile", "steel-304-0.5mm", "-o", "c"]);
    assert_eq!((made.status, made.stderr.as_str()), (0, ""), "{made:?}");
    for part in [
        "True kerf = 0.05 + (measured - nominal)",
        "W1 5.000",
        "S4 0.450",
        "L3 0.500",
        "kerf_mm",
        "min_web_mm",
    ] {
        assert!(made.stdout.contains(part), "{part}: {}", made.stdout);
    }
    let names: Vec<_> = program::listing(&folder.join("c")).into_keys().collect();
    assert_eq!(names.len(), 3);
    let steel = include_str!("../profiles/steel-304-0.5mm.toml");
    let small = steel.replace("width_mm = 1000.0", "width_mm = 60.0");
    std::fs::write(folder.join("small.toml"), small).unwrap();
    program::refused(
        &folder,
        &["coupon", "-p", "small.toml", "-o", "d"],
        2,
        &["the coupon measures", "larger piece"],
    );
    let mill = ["coupon", "-p", "nylon-6-5mm", "-o", "d"];
    program::refused(&folder, &mill, 1, &["nylon-6-5mm is for milling", "measure the tool"]);
    std::fs::remove_dir_all(folder).unwrap();
}
