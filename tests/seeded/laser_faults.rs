//! What can be wrong with a layout's files.

use kirimorph::fabrication::layout::{CutKind, CutLayout, CutPath, PathVertex};
use kirimorph::kirigami::design::State;
use kurbo::{Point, Vec2};

use super::{Dice, Sample};

/// How far cuts are spoiled, millimetres: less than a laser's operator would see.
const BY: f64 = 0.1;

/// What a fault does to a layout; `None` where the sheet has nothing to spoil in that way.
pub type Spoil = fn(&mut CutLayout, &Sample, &mut Dice) -> Option<()>;

pub const FAULTS: [(&str, Spoil); 18] = [
    ("slit too long", |layout, _, dice| {
        let slit = dice.cut(layout, CutKind::Slit)?;
        lengthened(&mut layout.paths[slit], BY);
        Some(())
    }),
    ("slit too short", |layout, _, dice| {
        let slit = dice.cut(layout, CutKind::Slit)?;
        lengthened(&mut layout.paths[slit], -BY);
        Some(())
    }),
    ("slit shifted", |layout, _, dice| shifted(layout, CutKind::Slit, dice)),
    ("bar shifted", |layout, _, dice| shifted(layout, CutKind::Relief, dice)),
    ("window shifted", |layout, _, dice| shifted(layout, CutKind::Window, dice)),
    ("slit missing", |layout, _, dice| missing(layout, CutKind::Slit, dice)),
    ("bar missing", |layout, _, dice| missing(layout, CutKind::Relief, dice)),
    ("window missing", |layout, _, dice| missing(layout, CutKind::Window, dice)),
    ("border missing", |layout, _, dice| missing(layout, CutKind::Border, dice)),
    ("any cut twice", |layout, _, dice| {
        let cut = dice.below(layout.paths.len());
        layout.paths.insert(0, layout.paths[cut].clone());
        Some(())
    }),
    ("a corner moved", |layout, _, dice| {
        let cut = dice.below(layout.paths.len());
        let vertices = &mut layout.paths[cut].vertices;
        let corner = dice.below(vertices.len());
        vertices[corner].point += BY * Vec2::from_angle(0.7);
        Some(())
    }),
    ("ligament cut through", |layout, sample, dice| {
        let hinges = &sample.sheet.design.hinges;
        let at = hinges[dice.below(hinges.len())].point;
        let profile = &sample.job.fabrication.profile;
        // Across whatever way the ligament lies.
        let reach = 1.5 * (profile.ligament.width + profile.cut.kerf);
        for angle in [0.0, std::f64::consts::FRAC_PI_2] {
            let along = reach * Vec2::from_angle(angle);
            let at = Point::new(at.x, at.y);
            layout.paths.insert(0, slit(&[at - along, at + along]));
        }
        Some(())
    }),
    ("a cut too many in a piece", |layout, sample, dice| {
        let pieces = &sample.sheet.design.pieces;
        let piece = &pieces[dice.below(pieces.len())];
        let state =
            if sample.sheet.design.sheet_state == Some(State::Open) { &piece.open } else { &piece.closed };
        let sum = state.iter().fold(Vec2::ZERO, |sum, p| sum + Vec2::new(p.x, p.y));
        let middle = (sum / state.len() as f64).to_point();
        layout.paths.insert(0, slit(&[middle, middle + Vec2::new(1.0, 0.3)]));
        Some(())
    }),
    ("border in inches", |layout, _, dice| {
        let border = dice.cut(layout, CutKind::Border)?;
        moved(&mut layout.paths[border], |p| (p.to_vec2() / 25.4).to_point());
        Some(())
    }),
    ("border not last", |layout, _, dice| {
        let turned = 1 + dice.below(layout.paths.len() - 1);
        layout.paths.rotate_right(turned);
        Some(())
    }),
    ("a layer moved", |layout, _, dice| {
        let kind = layout.paths[dice.below(layout.paths.len())].kind;
        let by = BY * Vec2::from_angle(dice.below(6) as f64);
        layout.paths.iter_mut().filter(|path| path.kind == kind).for_each(|path| moved(path, |p| p + by));
        Some(())
    }),
    ("all of it too large", |layout, _, dice| {
        let scale = 1.0 + 1e-3 * (1 + dice.below(5)) as f64;
        layout.paths.iter_mut().for_each(|path| moved(path, |p| (scale * p.to_vec2()).to_point()));
        Some(())
    }),
    ("all of it mirrored", |layout, _, dice| {
        let at = 100.0 + dice.below(100) as f64;
        for path in &mut layout.paths {
            path.vertices.iter_mut().for_each(|vertex| vertex.bulge = -vertex.bulge);
            moved(path, |p| Point::new(2.0 * at - p.x, p.y));
        }
        Some(())
    }),
];

fn slit(points: &[Point]) -> CutPath {
    let vertices = points.iter().map(|&point| PathVertex { point, bulge: 0.0 }).collect();
    CutPath { kind: CutKind::Slit, vertices, closed: false }
}

fn moved(path: &mut CutPath, by: impl Fn(Point) -> Point) {
    path.vertices.iter_mut().for_each(|vertex| vertex.point = by(vertex.point));
}

fn lengthened(path: &mut CutPath, by: f64) {
    let last = path.vertices.len() - 1;
    let along = (path.vertices[last].point - path.vertices[last - 1].point).normalize();
    path.vertices[last].point += by * along;
}

fn shifted(layout: &mut CutLayout, kind: CutKind, dice: &mut Dice) -> Option<()> {
    let cut = dice.cut(layout, kind)?;
    let vertices = &layout.paths[cut].vertices;
    let along = (vertices[1].point - vertices[0].point).normalize();
    // A bar is where its slit ends: along itself it may not move, nor a slit across itself.
    let by = BY * if kind == CutKind::Relief { along } else { along.turn_90() };
    moved(&mut layout.paths[cut], |p| p + by);
    Some(())
}

fn missing(layout: &mut CutLayout, kind: CutKind, dice: &mut Dice) -> Option<()> {
    let cut = dice.cut(layout, kind)?;
    layout.paths.remove(cut);
    Some(())
}
