//! What is drawn of the sheet: layers of path data, in millimetres with y down.

use kurbo::{Point, Rect};
use serde_json::{Value, json};

use super::Report;
use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::layout::{CutKind, CutLayout};
use crate::fabrication::product::{Assembly, Product};
use crate::geometry::Point3;
use crate::kirigami::design::State;
use crate::output::preview::assembly::{frame, normals};
use crate::output::preview::opening::senses;
use crate::output::preview::page::{Sense, bounds, push_polyline, simplified};
use crate::output::svg::path_data;

/// Vertices that change an outline by less are left out, millimetres.
const TOLERANCE: f64 = 0.003;
/// Free space around what is drawn, as a part of its larger side.
const MARGIN: f64 = 0.03;

const CUTS: [(CutKind, &str, &str, &str); 5] = [
    (CutKind::Slit, "slit", "cut-slit", "slits"),
    (CutKind::Relief, "relief", "cut-relief", "relief bars"),
    (CutKind::Window, "window", "cut-window", "windows"),
    (CutKind::Border, "border", "cut-border", "border"),
    (CutKind::Lead, "lead", "cut-lead", "leads"),
];

/// The drawing: what part of it is shown at first, its layers from below, the size of the hinges.
pub fn object(report: &Report) -> Value {
    match (report.product, report.plan) {
        (Product::Sheet(sheet), Some(plan)) if plan.report.copies.len() == 1 => laid_out(sheet, &plan.layout),
        (Product::Sheet(sheet), _) => laid_out(sheet, &sheet.layout),
        (Product::Assembly(assembly), _) => in_space(assembly),
    }
}

/// One layer.
fn layer(id: &str, class: &str, label: &str, data: String) -> Value {
    json!({ "id": id, "class": class, "label": label, "d": data })
}

fn laid_out(sheet: &Fabrication, layout: &CutLayout) -> Value {
    let outlines: Vec<Vec<Point>> = sheet
        .outlines
        .iter()
        .map(|outline| outline.iter().map(|&[x, y]| Point::new(x, -y)).collect())
        .collect();
    let up = vec![crate::geometry::Vector3::z(); sheet.design.pieces.len()];
    let [width, height] = layout.sheet;
    let stock = [(0.0, 0.0), (width, 0.0), (width, -height), (0.0, -height)].map(Point::from);
    let mut data = String::new();
    push_polyline(&mut data, stock, true, 3);
    let mut layers = vec![layer("stock", "stock", "stock", data)];
    layers.extend(pieces(&outlines, &senses(&sheet.design, &up)));
    for (kind, id, class, label) in CUTS {
        let cuts = layout.paths.iter().filter(|path| path.kind == kind);
        let data: String = cuts.map(|path| path_data(path, 0.0)).collect();
        if !data.is_empty() {
            layers.push(layer(id, class, label, data));
        }
    }
    let box_of = bounds(outlines.into_iter().flatten());
    json!({
        "view": view(box_of),
        "kerf": layout.kerf,
        "hinge": 0.7 * sheet.design.gap,
        "laid_out": true,
        "layers": layers,
    })
}

/// The closed state, seen from above: along the mean normal of its pieces.
fn in_space(assembly: &Assembly) -> Value {
    let design = &assembly.design;
    let normals = normals(design, State::Closed);
    let [right, away, _] = frame(&normals);
    let flat = |p: &Point3| Point::new(right.dot(&p.coords), -away.dot(&p.coords));
    let outlines: Vec<Vec<Point>> =
        design.pieces.iter().map(|piece| piece.closed.iter().map(flat).collect()).collect();
    let rounded = |c: f64| (c * 1e4).round() / 1e4 + 0.0;
    let place = |at: Point| [rounded(at.x), rounded(at.y)];
    let places: Vec<[f64; 2]> = design.hinges.iter().map(|hinge| place(flat(&hinge.point))).collect();
    let layers = pieces(&outlines, &senses(design, &normals));
    json!({
        "view": view(bounds(outlines.into_iter().flatten())),
        "kerf": 0.0,
        "hinge": 0.7 * design.gap,
        "laid_out": false,
        "layers": layers,
        "places": places,
    })
}

/// The pieces by turning sense; senses without pieces have no layer.
fn pieces(outlines: &[Vec<Point>], senses: &[Sense]) -> Vec<Value> {
    let kinds = [
        (Sense::CounterClockwise, "counter-clockwise", "piece-a", "pieces, counter-clockwise"),
        (Sense::Clockwise, "clockwise", "piece-b", "pieces, clockwise"),
        (Sense::Still, "still", "piece-c", "pieces that do not turn"),
    ];
    let mut layers = Vec::new();
    for (sense, id, class, label) in kinds {
        let mut data = String::new();
        for (outline, _) in outlines.iter().zip(senses).filter(|(_, of)| **of == sense) {
            push_polyline(&mut data, simplified(outline, TOLERANCE), true, 3);
        }
        if !data.is_empty() {
            layers.push(layer(id, class, label, data));
        }
    }
    layers
}

/// Left, top, width, height, with some space around.
fn view(drawn: Rect) -> [f64; 4] {
    let margin = MARGIN * drawn.width().max(drawn.height()).max(1.0);
    let shown = drawn.inset(margin);
    [shown.x0, shown.y0, shown.width(), shown.height()].map(|c| (c * 1e3).round() / 1e3 + 0.0)
}
