use std::f64::consts::SQRT_2;

use super::*;
use crate::fabrication::plan::{CutOrder, LeadShape, Leads, Pierce, TabWish};
use crate::geometry::Point3;
use crate::kirigami::{stage2, stage3};
use crate::toml_source::{Diagnostic, corruption};

mod bistable;

mod cut;

mod guide;

mod pattern;

const JOB: &str = r#"[target]
open = "roof.obj"
closed = "flat"
units = "cm"
size_mm = 300.0

[pattern]
kind = "rotating-rectangles"
pieces = [30, 20]
stretches = [1.3, 1.5505]
boundary = "fixed-corners"
gap_mm = 0.0
opening = "full"

[fabrication]
profile = "steel-304-0.5mm"
sheet_mm = [600, 800.5]
kerf_mm = 0.06
process = "laser"
dxf = "r12"
copies = 2
spacing_mm = 3
passes = 4
pierce = "scrap"
order = "heat"
cool_s = 7.5
cool_mm = 6
leads = "line"
lead_mm = 1.5
tabs = 3
tab_mm = 0.6
engrave = true

[solver]
stage-2 = { fair = 0.01, prox = 0 }
stage-3 = { widths = 0.5, sides = 2e-4 }
"#;

/// A folder with a mesh file and a job file in it, gone at the end of the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("kirimorph-job-{name}-{}", std::process::id()));
        std::fs::create_dir_all(path.join("meshes")).unwrap();
        std::fs::write(path.join("roof.obj"), "v 0 0 0\n").unwrap();
        Self(path)
    }

    fn read(&self, text: &str) -> Result<Job, JobError> {
        read::parse(text, "roof.toml", self.0.clone())
    }

    fn diagnostic(&self, text: &str) -> Diagnostic {
        match self.read(text) {
            Err(JobError::Job(TomlError::Invalid(diagnostic))) => *diagnostic,
            other => panic!("{other:?} for\n{text}"),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder that stays behind in the temporary directory harms nobody.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The job with one line replaced; the key is unique among the tables. An empty line removes the key.
fn with(key: &str, line: &str) -> String {
    let is_it = |text: &str| text.split('=').next().unwrap().trim() == key;
    assert_eq!(JOB.lines().filter(|text| is_it(text)).count(), 1, "{key}");
    JOB.lines().map(|text| if is_it(text) { line } else { text }).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_job_that_says_everything() {
    let folder = Folder::new("all");
    std::fs::write(folder.0.join("roof.toml"), JOB).unwrap();
    let job = read_job(&folder.0.join("roof.toml")).unwrap();
    assert_eq!(job.folder, folder.0);
    assert_eq!(job.target.open, Shape::Mesh(folder.0.join("roof.obj")));
    assert_eq!(job.target.closed, Shape::Flat);
    assert_eq!((job.target.units.millimetres(), job.target.size), (10.0, Some(300.0)));
    assert_eq!(job.pattern.kind, Kind::RotatingRectangles);
    assert_eq!(job.pattern.grid, Grid::Regular(PieceSize::Counts([30, 20])));
    assert_eq!(job.pattern.boundary, Some(Boundary::FixedCorners));
    assert_eq!(job.pattern.gap, 0.0);
    assert_eq!(job.fabrication.dxf, DxfVersion::R12);
    let solver = Solver::default();
    assert_eq!(job.solver.stage2, stage2::Weights { fair: 0.01, prox: 0.0, ..solver.stage2 });
    assert_eq!(job.solver.stage3, stage3::Weights { widths: 0.5, sides: 2e-4, ..solver.stage3 });
    assert_eq!(
        job.fabrication.cut,
        CutOptions {
            copies: 2,
            spacing: 3.0,
            passes: 4,
            pierce: Pierce::Scrap,
            order: CutOrder::Heat { cool: 7.5, within: Some(6.0) },
            leads: Some(Leads { shape: LeadShape::Line, length: 1.5 }),
            tabs: Some(TabWish { count: 3, width: 0.6 }),
            engrave: Some("roof".to_owned()),
        }
    );
    let profile = &job.fabrication.profile;
    assert_eq!([profile.sheet.width, profile.sheet.height, profile.cut.kerf], [600.0, 800.5, 0.06]);
}

#[test]
fn keys_left_out_have_their_documented_defaults() {
    let folder = Folder::new("defaults");
    let mut shortest = JOB.to_owned();
    // The closed target's own size needs two meshes, a weight its guide; the sheet's state may be said, never chosen.
    let elsewhere =
        ["target.closed_size_mm", "guide.weight", "fabrication.sheet_state", "fabrication.machine"];
    for (key, _) in DEFAULTS.into_iter().filter(|(key, _)| !elsewhere.contains(key)) {
        let name = key.rsplit('.').next().unwrap();
        // What belongs to it goes with it.
        let with_it = [("order", "cool_"), ("tabs", "tab_mm")].into_iter().find(|(of, _)| *of == name);
        let stays = |line: &&str| with_it.is_none_or(|(_, also)| !line.starts_with(also));
        let text = with(name, "").lines().filter(stays).collect::<Vec<_>>().join("\n");
        folder.read(&text).unwrap_or_else(|error| panic!("{key}: {error}"));
        shortest = shortest.lines().filter(|line| !line.starts_with(name)).collect::<Vec<_>>().join("\n");
    }
    let job = folder.read(&shortest).unwrap();
    assert_eq!((job.target.units, job.target.size), (Units::Millimetres, None));
    assert_eq!((job.pattern.stretches, job.pattern.boundary), ([SQRT_2, SQRT_2], None));
    let profile = crate::profile::load("steel-304-0.5mm", Path::new("")).unwrap();
    assert_eq!(job.pattern.gap, profile.hinge_gap());
    assert_eq!(job.solver, Solver::default());
    assert_eq!(
        job.fabrication,
        Fabrication { profile, dxf: DxfVersion::R2000, cut: CutOptions::default(), machine: None }
    );
    // No other key may be left out; pieces has piece_mm in its place.
    for key in ["open", "closed", "kind", "profile", "pieces"] {
        let found = folder.diagnostic(&with(key, ""));
        assert!(found.message.contains(key), "{found}");
    }
}

#[test]
fn the_gap_follows_the_kerf_of_the_job() {
    let folder = Folder::new("gap");
    let job = folder.read(&with("gap_mm", "")).unwrap();
    // Ligament 0.5 plus kerf 0.06; one rounding.
    assert!((job.pattern.gap - 0.56).abs() < 1e-15);
}

#[test]
fn each_pair_of_states_is_taken_or_refused_with_the_reason() {
    let folder = Folder::new("states");
    let states = |closed: &str, open: &str| {
        with("open", &format!("open = \"{open}\""))
            .replace("closed = \"flat\"", &format!("closed = \"{closed}\""))
    };
    let mesh = || Shape::Mesh(folder.0.join("roof.obj"));
    for (closed, open, expected) in [
        ("roof.obj", "flat", [mesh(), Shape::Flat]),
        ("roof.obj", "free", [mesh(), Shape::Free]),
        ("roof.obj", "roof.obj", [mesh(), mesh()]),
        ("flat", "roof.obj", [Shape::Flat, mesh()]),
    ] {
        let target = folder.read(&states(closed, open)).unwrap().target;
        assert_eq!([target.closed, target.open], expected);
    }
    for (closed, open, key, help) in [
        ("flat", "flat", "target.open", "one of the two states must be a mesh"),
        ("flat", "free", "target.open", "one of the two states must be a mesh"),
        ("free", "roof.obj", "target.closed", "open = \"free\""),
    ] {
        let found = folder.diagnostic(&states(closed, open));
        assert!(found.key == key && found.help.contains(help), "{found}");
    }
    let sized = with("size_mm", "closed_size_mm = 200.0");
    assert_eq!(folder.diagnostic(&sized).message, "closed_size_mm needs two meshes");
    let sized = sized.replace("closed = \"flat\"", "closed = \"roof.obj\"");
    assert_eq!(folder.read(&sized).unwrap().target.closed_size, Some(200.0));
}

#[test]
fn the_sheet_state_is_the_flat_one() {
    let folder = Folder::new("sheet-state");
    let said = |closed: &str, open: &str, state: &str| {
        let text = JOB.replace("closed = \"flat\"", &format!("closed = \"{closed}\""));
        let text = text.replace("open = \"roof.obj\"", &format!("open = \"{open}\""));
        text.replace("engrave = true", &format!("sheet_state = \"{state}\""))
    };
    let flat_closed = |state: &str| said("flat", "roof.obj", state);
    assert_eq!(folder.read(&flat_closed("closed")).unwrap().target.closed, Shape::Flat);
    folder.read(&said("roof.obj", "flat", "open")).unwrap();
    for (text, state) in [(flat_closed("open"), "open"), (said("roof.obj", "roof.obj", "closed"), "closed")] {
        let found = folder.diagnostic(&text);
        assert_eq!(found.key, "fabrication.sheet_state");
        assert!(
            found.message.contains(&format!("{state} is not \"flat\" in this job's [target]")),
            "{found}"
        );
    }
    assert!(folder.diagnostic(&flat_closed("both")).message.contains("\"closed\", \"open\""));
}

#[test]
fn machines_are_for_milling_and_three_axes_leave_walls_upright() {
    let folder = Folder::new("machines");
    let found = folder.diagnostic(&with("dxf", "machine = \"linuxcnc-xyz\""));
    assert_eq!(found.key, "fabrication.machine");
    assert!(found.message.contains("is for a laser"), "{found}");
    let milled = |line: &str| {
        let laser = ["process = ", "kerf_mm = "];
        let job = with("profile", &format!("profile = \"nylon-6-5mm\"\n{line}"));
        job.lines()
            .filter(|line| !laser.iter().any(|key| line.starts_with(key)))
            .collect::<Vec<_>>()
            .join("\n")
    };
    let job = folder.read(&milled("")).unwrap();
    assert_eq!(job.fabrication.machine.map(|machine| machine.name).as_deref(), Some(DEFAULT_MACHINE));
    assert!(job.fabrication.profile.cut.ruled);
    let job = folder.read(&milled("machine = \"linuxcnc-xyz\"")).unwrap();
    assert!(!job.fabrication.profile.cut.ruled);
    let found = folder.diagnostic(&milled("machine = \"lathe\""));
    assert!(found.help.contains("linuxcnc-xyzbc-trt"), "{found}");
}

#[test]
fn faulty_values_are_named_with_place_and_range() {
    let folder = Folder::new("faulty");
    let faults = [
        ("size_mm", "size_mm = 0.5", "1 to 10000 mm"),
        ("size_mm", "size_mm = nan", "not a finite number"),
        ("size_mm", "size_mm = \"big\"", "expected f64"),
        ("units", "units = \"ft\"", "\"mm\", \"cm\", \"m\", \"in\""),
        ("pieces", "pieces = [1, 20]", "2 to 2000"),
        ("pieces", "pieces = [30, 2001]", "2 to 2000"),
        ("pieces", "pieces = [-30, 20]", "2 to 2000"),
        ("pieces", "pieces = [30.0, 20]", "invalid type"),
        ("pieces", "pieces = [30]", "1 value: allowed are two"),
        ("pieces", "pieces = [30, 20, 10]", "3 values: allowed are two"),
        ("stretches", "stretches = []", "0 values: allowed are two"),
        ("sheet_mm", "sheet_mm = [600, 600, 0.5]", "3 values: allowed are two"),
        ("pieces", "piece_mm = inf", "0.5 to 1000 mm"),
        ("opening", "piece_mm = 10", "both pieces and piece_mm"),
        ("stretches", "stretches = [0.7, 1.4]", "0.8 to 6.1"),
        ("stretches", "stretches = [1.4, nan]", "0.8 to 6.1"),
        ("boundary", "boundary = \"free\"", "\"glide\", \"fixed-corners\", \"trimmed\""),
        ("gap_mm", "gap_mm = -0.1", "0 to 100 mm"),
        ("kerf_mm", "kerf_mm = 3", "0.005 to 2 mm"),
        ("kerf_mm", "kerf_mm = 0.4", "min_web_mm = 0.35"),
        ("sheet_mm", "sheet_mm = [600, 1e300]", "50 to 10000 mm"),
        ("dxf", "dxf = \"r14\"", "\"r2000\", \"r12\""),
        ("dxf", "dfx = \"r12\"", "unknown key `dfx`"),
        ("stage-3", "stage-3 = { prox = -0.1 }", "0 to 1000000"),
        ("stage-2", "stage-2 = { geom = nan }", "not a finite number"),
        ("stage-2", "stage-2 = { sides = 0.1 }", "unknown key `sides`"),
        ("stage-2", "stage-4 = { prox = 0.1 }", "unknown key `stage-4`"),
        ("profile", "profile = \"brass\"", "not the name of a profile"),
        ("profile", "profile = \"brass.toml\"", "not readable as a profile"),
        ("open", "open = \"rof.obj\"", "not readable as a mesh file"),
        ("open", "open = \"meshes\"", "a directory"),
        ("open", "open = \"\"", "a directory"),
    ];
    for (key, line, what) in faults {
        let found = folder.diagnostic(&with(key, line));
        let place = 1 + JOB.lines().position(|text| text.starts_with(key)).unwrap();
        assert_eq!(found.line, place, "{found}");
        assert!(found.message.contains(what), "{found}");
        assert!(found.to_string().contains(&format!("--> roof.toml:{place}:{}\n", found.column)));
    }
    assert!(folder.diagnostic(&with("profile", "profile = \"brass\"")).help.contains("steel-304-0.5mm"));
}

#[test]
fn each_key_refuses_impossible_values_by_name() {
    let folder = Folder::new("each");
    let mut tried = 0;
    for line in
        JOB.lines().chain(["piece_mm = 10"]).filter(|line| line.contains('=') && !line.starts_with("stage"))
    {
        let key = line.split(' ').next().unwrap();
        for value in ["nan", "inf", "-1", "1e300", "[]", "[nan, nan]", "{}"] {
            let place = if key == "piece_mm" { "pieces" } else { key };
            let found = folder.diagnostic(&with(place, &format!("{key} = {value}")));
            assert!(found.key.ends_with(&format!(".{key}")), "{value}: {found}");
            tried += 1;
        }
    }
    assert_eq!(tried, 7 * 28);
}

#[test]
fn all_weights_can_be_set_and_their_defaults_are_as_documented() {
    let folder = Folder::new("weights");
    let written: Vec<&(&str, &str)> = DEFAULTS.iter().filter(|(key, _)| key.starts_with("solver.")).collect();
    let mut tried = 0;
    for (key, values) in &written {
        let stage = key.strip_prefix("solver.").unwrap();
        // What is documented is the default, and none is left out: doubled, every one of them differs.
        assert_eq!(folder.read(&with(stage, &format!("{stage} = {values}"))).unwrap().solver, {
            let mut expected = folder.read(JOB).unwrap().solver;
            match stage {
                "stage-2" => expected.stage2 = stage2::Weights::default(),
                _ => expected.stage3 = stage3::Weights::default(),
            }
            expected
        });
        for pair in values.trim_matches(['{', '}']).split(',') {
            let (name, value) = pair.split_once('=').unwrap();
            let other =
                format!("{stage} = {{ {} = {} }}", name.trim(), 2.0 * value.trim().parse::<f64>().unwrap());
            let (one, none) = (folder.read(&with(stage, &other)), folder.read(&with(stage, "")));
            assert_ne!(one.unwrap().solver, none.unwrap().solver, "{other}");
            tried += 1;
        }
    }
    // Six weights of Stage 2 and eight of Stage 3.
    assert_eq!(tried, 14);
}

#[test]
fn the_caret_stands_under_the_second_number_of_a_pair() {
    let folder = Folder::new("caret");
    let expected = "\
pattern.pieces = 2001 is out of range: allowed is 2 to 2000
 --> roof.toml:9:15
  |
9 | pieces = [30, 2001]
  |               ^^^^
  |";
    let text = folder.diagnostic(&with("pieces", "pieces = [30, 2001]")).to_string();
    assert!(text.starts_with(expected), "{text}");
}

#[test]
fn a_faulty_profile_file_keeps_its_own_place() {
    let folder = Folder::new("profile");
    std::fs::write(folder.0.join("mine.toml"), "version = 1\nprocess = 3\n").unwrap();
    let error = folder.read(&with("profile", "profile = \"mine.toml\"")).unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("roof.toml: the profile that it names"), "{text}");
    assert!(text.contains("mine.toml:2:11"), "{text}");
}

#[test]
fn random_corruption_never_panics() {
    let folder = Folder::new("random");
    let refused = (0..3000).filter(|&seed| folder.read(&corruption::corrupt(JOB, seed)).is_err()).count();
    assert!(refused > 2000, "{refused}");
}
