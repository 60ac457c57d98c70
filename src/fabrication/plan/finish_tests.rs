//! Leads, tabs and engraving on laid-out sheets.

use kurbo::Point;

use super::*;
use crate::fabrication::coupon::coupon;
use crate::fabrication::fabricate::{fabricate, ligament_lengths};
use crate::fabrication::layout::PathVertex;
use crate::fabrication::outline::contains;
use crate::fabrication::test_sheet::{TestSheet, profile};
use crate::fabrication::web::nearest_on_segment;

fn made(cells: [usize; 2]) -> Fabrication {
    let sheet = TestSheet::rectangle(cells, [10.0, 10.0], profile().hinge_gap());
    let design = sheet.design(sheet.full_angle());
    fabricate(&design, &profile(), &ligament_lengths(&design, &profile()).unwrap()).unwrap()
}

fn planned(one: &Fabrication, options: CutOptions) -> CutPlan {
    cut_plan(one, &profile(), &options).unwrap()
}

fn contour(path: &CutPath) -> Vec<[f64; 2]> {
    path.flatten(1e-4).iter().map(|p| [p.x, p.y]).collect()
}

fn distance(at: Point, path: &CutPath) -> f64 {
    path.segments(1e-4).iter().map(|&s| nearest_on_segment(at, s).distance(at)).fold(f64::INFINITY, f64::min)
}

/// The distance between the two ends of a path.
fn span(path: &CutPath) -> f64 {
    path.vertices[0].point.distance(path.vertices[path.vertices.len() - 1].point)
}

#[test]
fn leads_lie_in_scrap_and_lead_into_closed_cuts() {
    // The coupon has square holes of 5, 10 and 20 mm, slots that are too narrow for any lead, and a border.
    let coupon = coupon(&profile()).unwrap().layout.paths;
    let closed: Vec<&CutPath> = coupon.iter().filter(|path| path.closed).collect();
    for shape in [LeadShape::Line, LeadShape::Arc] {
        let leads = Leads { shape, length: 2.0 };
        let none = RTree::new();
        let (paths, without) = leads::with_leads(coupon.clone(), leads, &none, &profile()).unwrap();
        let count = paths.iter().filter(|path| path.kind == CutKind::Lead).count();
        assert_eq!((count, without, paths.len()), (4, closed.len() - 4, coupon.len() + 4), "{shape:?}");
        for (i, lead) in paths.iter().enumerate().filter(|(_, path)| path.kind == CutKind::Lead) {
            let next = &paths[i + 1];
            let begin = lead.vertices[0].point;
            assert!(next.closed && lead.vertices[1].point == next.vertices[0].point);
            assert_eq!(contains(&contour(next), [begin.x, begin.y]), next.kind == CutKind::Window);
            assert!((lead.length() - 2.0).abs() < 1e-3, "{}", lead.length());
            // 45 degrees off the cut, or a quarter of a circle whose radius is 2 times its length over pi.
            let expected = match shape {
                LeadShape::Line => 2.0 * std::f64::consts::FRAC_1_SQRT_2,
                LeadShape::Arc => 4.0 / std::f64::consts::PI,
            };
            let along = next.vertices[1].point - next.vertices[0].point;
            let from = (begin - next.vertices[0].point).cross(along.normalize()).abs();
            assert!((from - expected).abs() < 1e-9 && distance(begin, next) > 1.0, "{shape:?} {from}");
        }
        // The cuts themselves are the same, begun elsewhere.
        let length = |paths: &[CutPath]| -> f64 {
            paths.iter().filter(|path| path.kind != CutKind::Lead).map(CutPath::length).sum()
        };
        assert!((length(&paths) - length(&coupon)).abs() < 1e-6);
    }
    // In a hole of 5 mm a lead of 6 mm is as long as half of that, and 20 mm leave no room at the stock's edge.
    let long = |length: f64, profile: &Profile| {
        let leads = Leads { shape: LeadShape::Line, length };
        leads::with_leads(coupon.clone(), leads, &RTree::new(), profile)
    };
    let (paths, _) = long(6.0, &profile()).unwrap();
    let shortest = paths.iter().filter(|path| path.kind == CutKind::Lead).map(|path| path.length());
    assert!(shortest.fold(f64::INFINITY, f64::min) < 5.0);
    let [width, height] = coupon_size(&coupon);
    let mut tight = profile();
    (tight.sheet.width, tight.sheet.height) =
        (width + 2.0 * tight.sheet.margin, height + 2.0 * tight.sheet.margin);
    let error = long(2.0, &tight).unwrap_err().to_string();
    assert!(error.contains("no lead of 2 mm has room") && error.contains("lead_mm"), "{error}");
}

/// The burned size of the coupon.
fn coupon_size(paths: &[CutPath]) -> [f64; 2] {
    let place = bounding_box(paths).inset(0.5 * profile().cut.kerf);
    [place.width(), place.height()]
}

#[test]
fn leads_between_copies_need_room() {
    let one = made([4, 3]);
    let options = |spacing: f64| CutOptions {
        copies: 4,
        spacing,
        leads: Some(Leads { shape: LeadShape::Arc, length: 2.0 }),
        ..CutOptions::default()
    };
    let plan = planned(&one, options(5.0));
    let report = plan.report.leads.unwrap();
    assert_eq!((report.count, report.without), (4, 0));
    let borders: Vec<&CutPath> = plan.layout.paths.iter().filter(|p| p.kind == CutKind::Border).collect();
    for lead in plan.layout.paths.iter().filter(|path| path.kind == CutKind::Lead) {
        for border in &borders {
            let own = distance(lead.vertices[1].point, border) < 1e-9;
            let begin = lead.vertices[0].point;
            assert!(!contains(&contour(border), [begin.x, begin.y]));
            assert!(own || distance(begin, border) > profile().cut.min_web + profile().cut.kerf);
        }
    }
    // A lead is the beginning of its cut: no more cuts are pierced, and the way is counted to where it begins.
    assert_eq!(plan.report.cuts, 4 * one.layout.paths.len());
    assert!(plan.report.travel.length >= plan.report.travel.bound);
}

#[test]
fn tabs_are_spread_evenly_away_from_hinges_and_leave_their_width() {
    let one = made([6, 5]);
    let border = one.layout.paths.last().unwrap();
    let (kerf, around) = (profile().cut.kerf, border.length());
    for count in [1, 2, 3, 4, 7] {
        let wish = TabWish { count, width: 0.6 };
        let plan = planned(&one, CutOptions { tabs: Some(wish), copies: 2, ..CutOptions::default() });
        let tabs = plan.report.tabs.unwrap();
        assert_eq!((tabs.places.len(), tabs.width), (count, 0.6));
        let stretches: Vec<&CutPath> =
            plan.layout.paths.iter().filter(|path| path.kind == CutKind::Border).collect();
        assert!(stretches.len() == 2 * count && stretches.iter().all(|stretch| !stretch.closed));
        let cut: f64 = stretches.iter().map(|stretch| stretch.length()).sum();
        assert!((cut - 2.0 * (around - count as f64 * (0.6 + kerf))).abs() < 1e-6, "{count}: {cut}");
        // Stretches follow each other; each is as long as the others but for a quarter of what is even.
        for pair in stretches.chunks(count) {
            for (i, stretch) in pair.iter().enumerate() {
                let next = pair[(i + 1) % count].vertices[0].point;
                let end = stretch.vertices[stretch.vertices.len() - 1].point;
                assert!((end.distance(next) - 0.6 - kerf).abs() < 1e-9, "{count}: {}", end.distance(next));
                let even = around / count as f64;
                assert!((stretch.length() - even).abs() < 0.5 * even + 1.0, "{count}");
            }
        }
        for place in &tabs.places {
            assert!(distance(*place, border) < 1e-9);
            assert!(hinge_points(&one.design).iter().all(|hinge| hinge.distance(*place) > 2.0));
            let inner = one.layout.paths.iter().filter(|path| path.kind != CutKind::Border);
            assert!(inner.map(|path| distance(*place, path)).fold(f64::INFINITY, f64::min) > 2.0);
        }
        assert!(count != 1 || (span(stretches[0]) - 0.6 - kerf).abs() < 1e-9);
    }
    let many = CutOptions { tabs: Some(TabWish { count: 500, width: 0.6 }), ..CutOptions::default() };
    let error = cut_plan(&one, &profile(), &many).unwrap_err().to_string();
    assert!(
        error.contains("500 tabs of 0.6 mm do not fit") && error.contains(" do; ask for fewer"),
        "{error}"
    );
}

#[test]
fn stretches_of_a_square_with_tabs_on_one_side() {
    let corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)];
    let vertices = corners.map(|(x, y)| PathVertex { point: Point::new(x, y), bulge: 0.0 }).to_vec();
    let square = CutPath { kind: CutKind::Border, vertices, closed: true };
    let tabs = Tabs { places: vec![Point::new(10.0, 0.0), Point::new(30.0, 0.0)], width: 1.5 };
    // A kerf of 0.5 mm: gaps of 2 mm. The first stretch begins at the tab nearest to the origin.
    let stretches = tabs::stretches(&square, &tabs, Vec2::ZERO, 0.5);
    let points = |path: &CutPath| path.vertices.iter().map(|v| (v.point.x, v.point.y)).collect::<Vec<_>>();
    assert_eq!(points(&stretches[0]), [(11.0, 0.0), (29.0, 0.0)]);
    let around = [(31.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0), (0.0, 0.0), (9.0, 0.0)];
    assert_eq!(points(&stretches[1]), around);
    let one = Tabs { places: vec![Point::new(30.0, 0.0)], width: 1.5 };
    assert_eq!(tabs::stretches(&square, &one, Vec2::ZERO, 0.5)[0].length(), 158.0);
}

#[test]
fn every_piece_is_numbered_inside_its_outline() {
    let one = made([4, 3]);
    let options = CutOptions { engrave: Some("Dome-7".to_owned()), copies: 2, ..CutOptions::default() };
    let plan = planned(&one, options.clone());
    let report = plan.report.engraved.unwrap();
    assert_eq!((report.texts, report.too_small, report.named), (13, 0, true));
    let engravings = &plan.layout.engravings;
    assert_eq!(engravings.len(), 26);
    // Strokes at 50 mm/s and the ways between them at 500 mm/s, on two copies, are all that engraving takes more.
    assert!(!report.timed && plan.report.times.unwrap().engraving == 0.0);
    let mut fast = profile();
    fast.machine =
        fast.machine.map(|machine| crate::profile::Machine { engrave_speed: Some(50.0), ..machine });
    let timed = cut_plan(&one, &fast, &options).unwrap().report;
    let mut seconds = 0.0;
    let mut at: Option<Point> = None;
    for stroke in engravings[..13].iter().flat_map(|engraving| &engraving.strokes) {
        seconds += at.map_or(0.0, |at| at.distance(stroke[0]) / 500.0);
        seconds += stroke.windows(2).map(|pair| pair[0].distance(pair[1]) / 50.0).sum::<f64>();
        at = stroke.last().copied();
    }
    let (times, plain) = (timed.times.unwrap(), plan.report.times.unwrap());
    assert!((times.engraving - 2.0 * seconds).abs() < 1e-9 && seconds > 1.0, "{times:?} {seconds}");
    assert!((times.total() - plain.total() - 2.0 * seconds).abs() < 1e-9);
    let texts: Vec<&str> = engravings.iter().map(|engraving| engraving.label.text.as_str()).collect();
    assert!((0..12).all(|piece: usize| texts.iter().filter(|text| **text == piece.to_string()).count() == 2));
    assert_eq!(texts.iter().filter(|text| **text == "Dome-7").count(), 2);
    // No stroke comes near any cut of its copy; those of the first lie in the outlines.
    let first: Vec<Point> =
        engravings[..13].iter().flat_map(|e| e.strokes.iter().flatten().copied()).collect();
    for at in first {
        let clear = one.layout.paths.iter().map(|path| distance(at, path)).fold(f64::INFINITY, f64::min);
        assert!(clear >= 0.3 + 0.5 * profile().cut.kerf - 1e-3, "{at}: {clear}");
        assert!(one.outlines.iter().any(|outline| contains(outline, [at.x, at.y])), "{at}");
    }
    assert!(plan.layout.notes.iter().any(|note| note.text == "layer ENGRAVE: engrave, do not cut through"));
}

#[test]
fn heat_by_distance_keeps_cuts_that_follow_each_other_apart() {
    let one = made([12, 12]);
    let plan = |within: Option<f64>| {
        let order = CutOrder::Heat { cool: 2.0, within };
        planned(&one, CutOptions { order, ..CutOptions::default() })
    };
    let [beside, far] = [None, Some(12.0)].map(plan);
    // Up to the last cuts, when nothing else is left, a cut at a hinge comes at least so far from the one before.
    let apart = |plan: &CutPlan| {
        let points = hinge_points(&one.design);
        let paths = &plan.layout.paths[..plan.layout.paths.len() * 3 / 4];
        crate::fabrication::order::rest(paths, &points, &pace(&profile()), 2.0).apart
    };
    assert!(apart(&beside) < 6.0 && apart(&far) > 12.0 - 1e-9, "{} {}", apart(&beside), apart(&far));
    let [price, more] = [&beside, &far].map(|plan| plan.report.price.unwrap().travel);
    assert!(0.0 < price && price < more, "{price} {more}");
    assert_eq!(planned(&one, CutOptions::default()).report.price, None);
}
