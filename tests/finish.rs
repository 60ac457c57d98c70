//! Leads, tabs and engraving in the machine files: unharmed ones pass, and each seeded fault is caught by the check that is
//! there for it.

mod peers;
mod program;

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use kirimorph::fabrication::fabricate::Fabrication;
use kirimorph::fabrication::layout::{CutKind, CutLayout, PathVertex};
use kirimorph::fabrication::plan::{CutOptions, CutPlan, LeadShape, Leads, TabWish, cut_plan};
use kirimorph::fabrication::product::Product;
use kirimorph::job::read_job;
use kirimorph::output::dxf::{self, DxfVersion};
use kirimorph::output::svg;
use kirimorph::pipeline::{self, Clock, Progress};
use kirimorph::profile::Profile;
use kirimorph::verify::{Check, Fault, Files, Wanted, hash_comment, verify};
use kurbo::{Point, Vec2};
use program::{made, run};

const HASH: &str = "fnv1a64:0123456789abcdef";

/// A sample's sheet and its plan, with everything that can be asked for.
struct Sample {
    sheet: Fabrication,
    profile: Profile,
    plan: CutPlan,
}

fn sample_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(format!("{name}.toml"))
}

fn sample(name: &str, shape: LeadShape) -> Sample {
    let job = read_job(&sample_file(name)).unwrap();
    let mut watch = |_: &Progress| ControlFlow::Continue(());
    let product = pipeline::make(&job, &mut Clock::new(&mut watch)).unwrap().product;
    let Product::Sheet(sheet) = product else { panic!("{name} has no sheet") };
    let options = CutOptions {
        copies: 2,
        leads: Some(Leads { shape, length: 1.5 }),
        tabs: Some(TabWish { count: 4, width: 0.5 }),
        engrave: Some(name.to_owned()),
        ..CutOptions::default()
    };
    let profile = job.fabrication.profile;
    let plan = cut_plan(&sheet, &profile, &options).unwrap();
    Sample { sheet, profile, plan }
}

static CLOSED: LazyLock<Sample> = LazyLock::new(|| sample("dome", LeadShape::Line));
static OPEN: LazyLock<Sample> = LazyLock::new(|| sample("closing", LeadShape::Arc));

impl Sample {
    fn faults(&self, layout: &CutLayout, version: DxfVersion) -> Vec<Fault> {
        let (mut dxf, mut svg) = (Vec::new(), Vec::new());
        dxf::write(layout, version, &[hash_comment(HASH)], &mut dxf).unwrap();
        svg::write(layout, &[hash_comment(HASH)], &mut svg).unwrap();
        let wanted = Wanted {
            design: &self.sheet.design,
            profile: &self.profile,
            hash: HASH,
            copies: &self.plan.report.copies,
            tabs: self.plan.report.tabs.as_ref(),
        };
        verify(Files { dxf: &dxf, svg: &svg }, wanted).unwrap().faults
    }
}

fn first(layout: &CutLayout, kind: CutKind) -> usize {
    layout.paths.iter().position(|path| path.kind == kind).unwrap()
}

#[test]
fn unharmed_sheets_with_leads_tabs_and_engraving_pass() {
    for sample in [&*CLOSED, &*OPEN] {
        assert_eq!(sample.faults(&sample.plan.layout, DxfVersion::R2000), []);
        let report = &sample.plan.report;
        // The first part stands at the stock's margins, so that some stretches have no room for a lead.
        let leads = report.leads.unwrap();
        let closed = sample.sheet.layout.paths.iter().filter(|path| path.closed).count() - 1;
        assert!(leads.count >= 4 && leads.count + leads.without == 2 * (closed + 4), "{leads:?}");
        let engraved = report.engraved.unwrap();
        assert_eq!((engraved.too_small, engraved.texts), (0, sample.sheet.design.pieces.len() + 1));
    }
    // An ARC of an R12 file has no direction; lines have.
    assert_eq!(CLOSED.faults(&CLOSED.plan.layout, DxfVersion::R12), []);
    // An open sheet has a window in every hole between pieces.
    assert!(OPEN.plan.report.leads.unwrap().count > 50);
}

/// The name of a seeded fault, the check that must notice it, and the change.
type Seed = (&'static str, Check, fn(&mut CutLayout));

/// Mirrors the beginning of a lead in its cut.
fn mirror(layout: &mut CutLayout, lead: usize) {
    let next = &layout.paths[lead + 1].vertices;
    let along = (next[1].point - next[0].point).normalize();
    let lead = &mut layout.paths[lead].vertices;
    let from = lead[0].point - lead[1].point;
    lead[0].point = lead[1].point + 2.0 * from.dot(along) * along - from;
    lead[0].bulge = -lead[0].bulge;
}

const SEEDS: [Seed; 10] = [
    ("lead on the other side", Check::Lead, |layout| mirror(layout, first(layout, CutKind::Lead))),
    ("border's lead on the other side", Check::Lead, |layout| {
        let lead = layout.paths.iter().rposition(|path| path.kind == CutKind::Lead).unwrap();
        mirror(layout, lead);
    }),
    ("lead beside its cut", Check::Lead, |layout| {
        let lead = first(layout, CutKind::Lead);
        layout.paths[lead].vertices.iter_mut().for_each(|v| v.point += Vec2::new(0.01, 0.0));
    }),
    ("lead last of all", Check::Lead, |layout| {
        let lead = layout.paths.remove(first(layout, CutKind::Lead));
        layout.paths.push(lead);
    }),
    ("tab wider", Check::Tab, |layout| {
        let stretch = layout.paths.last_mut().unwrap();
        let [before, last] = [2, 1].map(|k| stretch.vertices[stretch.vertices.len() - k].point);
        let count = stretch.vertices.len();
        stretch.vertices[count - 1].point = last - 0.1 * (last - before).normalize();
    }),
    ("tab elsewhere", Check::Tab, |layout| {
        let count = layout.paths.len();
        let stretch = &layout.paths[count - 1].vertices;
        let [before, last] = [2, 1].map(|k| stretch[stretch.len() - k].point);
        let by = 0.1 * (last - before).normalize();
        let end = layout.paths[count - 1].vertices.len() - 1;
        layout.paths[count - 1].vertices[end].point = last + by;
        // The copy's first stretch begins where its last one ends; its lead moves along.
        for path in [count - 8, count - 7] {
            let lead = layout.paths[path].kind == CutKind::Lead;
            let vertices = &mut layout.paths[path].vertices;
            let moved = if lead { vertices.len() } else { 1 };
            vertices[..moved].iter_mut().for_each(|v| v.point += by);
        }
    }),
    ("tab cut through", Check::Border, |layout| {
        let stretch = layout.paths.pop().unwrap();
        layout.paths.pop();
        layout.paths.last_mut().unwrap().vertices.extend(stretch.vertices);
    }),
    ("engraved on a cut", Check::Engraving, |layout| {
        let inner = |kind| matches!(kind, CutKind::Slit | CutKind::Window);
        let slit = layout.paths.iter().find(|path| inner(path.kind)).unwrap();
        let at = slit.vertices[0].point.midpoint(slit.vertices[1].point);
        layout.engravings[3].strokes[0] = vec![at, at + Vec2::new(0.4, 0.3)];
    }),
    ("engraved beside the part", Check::Engraving, |layout| {
        layout.engravings[3].strokes[0] = vec![Point::new(1.0, 1.0), Point::new(1.0, 2.0)];
    }),
    ("a lead more, across a piece", Check::Lead, |layout| {
        let lead = first(layout, CutKind::Lead);
        let mut more = layout.paths[lead].clone();
        // On beyond the cut where it ends, and back.
        let [from, to] = [more.vertices[0].point, more.vertices[1].point];
        let point = to + 9.0 * (to - from).normalize();
        more.vertices.insert(0, PathVertex { point, bulge: 0.0 });
        layout.paths[lead] = more;
    }),
];

#[test]
fn seeded_faults_are_caught() {
    for (sheet, sample) in [("closed", &*CLOSED), ("open", &*OPEN)] {
        for (name, check, change) in SEEDS {
            let mut layout = sample.plan.layout.clone();
            change(&mut layout);
            let faults = sample.faults(&layout, DxfVersion::R2000);
            assert!(faults.iter().any(|fault| fault.check == check), "{sheet}, {name}: {faults:#?}");
        }
    }
}

#[test]
fn fabricate_takes_the_options_and_verify_finds_them_in_the_report() {
    let folder = peers::fresh_folder("finish-command");
    made(&folder, sample_file("dome").to_str().unwrap(), "out");
    let options = "--copies 2 --leads line --tabs 3 --tab-mm 0.4 --engrave --pierce mid-slit --kerf-mm 0.06";
    let arguments = ["fabricate", "out", "-p", "steel-304-0.5mm", "-o", "laser"];
    let done = run(&folder, arguments.into_iter().chain(options.split(' ')));
    assert_eq!(done.status, 0, "{done:?}");
    for part in [
        "2 copies, ",
        "straight leads",
        "3 tabs of 0.4 mm hold each part",
        "texts of",
        "kerf 0.06 mm applied",
        "cuts and",
        "join them with up to",
    ] {
        assert!(done.stdout.contains(part), "{part:?} is not in {}", done.stdout);
    }
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("laser/hinges.json")).unwrap()).unwrap();
    let cut = &report["cut"];
    assert_eq!(cut["tabs"]["places_mm"].as_array().unwrap().len(), 3);
    assert_eq!((&cut["leads"]["shape"], &cut["engraved"]["named"]), (&"line".into(), &true.into()));
    assert!(cut["price"]["travel_mm"].as_f64().unwrap() > 0.0 && cut["join_tolerance_mm"].is_number());
    let verified = run(&folder, ["verify", "laser"]);
    assert_eq!(verified.status, 0, "{verified:?}");
    for line in ["LEAD ", "engraved ", "tab width "] {
        assert!(verified.stdout.contains(line), "{line}: {}", verified.stdout);
    }
    // The report tells of a tab that is not there.
    let file = folder.join("laser/hinges.json");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replacen("\"width_mm\":0.4", "\"width_mm\":0.5", 1)).unwrap();
    let refused = run(&folder, ["verify", "laser"]);
    assert!(refused.status == 2 && refused.stderr.contains("a tab"), "{refused:?}");
    let bad = run(&folder, arguments.into_iter().chain(["--tabs", "0"]));
    assert!(bad.status == 1 && bad.stderr.contains("tabs = 0"), "{bad:?}");
}
