//! The hinge table as columns: numbers, and indices into lists of the words that occur.

use kurbo::{Point, Vec2};
use rstar::{RTree, primitives::GeomWithData};
use serde_json::{Map, Value, json};

use crate::fabrication::fabricate::Fabrication;
use crate::fabrication::hinge_table::{HingeRow, Verdict};
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::mechanics::StrainClass;
use crate::fabrication::open_sheet::neck::neck_direction;
use crate::fabrication::product::Product;
use crate::kirigami::design::State;

/// The columns by name, and the words by column.
pub fn columns(product: &Product) -> (Value, Value) {
    let rows = product.hinges();
    let mut columns = Map::new();
    let mut add = |name: &str, value: &dyn Fn(&HingeRow) -> Value| {
        columns.insert(name.to_owned(), rows.iter().map(value).collect());
    };
    add("piece_j", &|row| row.pieces[0].into());
    add("piece_k", &|row| row.pieces[1].into());
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        add(name, &|row| rounded(row.point[i], 4));
        add(&format!("axis_{name}"), &|row| rounded(row.axis[i], 6));
    }
    add("tilt", &|row| rounded(row.tilt.to_degrees(), 4));
    add("angle", &|row| rounded(row.angle.to_degrees(), 8));
    add("width", &|row| rounded(row.width, 5));
    add("length", &|row| rounded(row.length, 8));
    add("pole", &|row| rounded(row.pole_offset, 6));
    add("centre", &|row| rounded(row.centre_offset, 5));
    // As it is: hinges are sorted by it as everywhere else.
    add("strain", &|row| row.strain.into());
    add("torque", &|row| row.torque.map_or(Value::Null, |torque| rounded(torque, 6)));
    add("web", &|row| rounded(row.width_margin, 5));
    add("next", &|row| if row.nearest_cut.is_finite() { rounded(row.nearest_cut, 4) } else { Value::Null });
    add("class", &|row| match row.strain_class {
        StrainClass::Elastic => 0.into(),
        StrainClass::PlasticLowCycle => 1.into(),
        StrainClass::BeyondElongation => 2.into(),
    });
    let mut words = Map::new();
    let mut worded = |name: &str, of: &dyn Fn(&HingeRow) -> String| {
        let mut known: Vec<String> = rows.iter().map(of).collect();
        known.sort();
        known.dedup();
        let index = |row: &HingeRow| Value::from(known.binary_search(&of(row)).unwrap_or_default());
        columns.insert(name.to_owned(), rows.iter().map(index).collect());
        words.insert(name.to_owned(), json!(known));
    };
    worded("verdict", &|row| {
        let name = match row.verdict {
            Verdict::Ok => "ok",
            Verdict::Warn => "warn",
            Verdict::Fail => "fail",
        };
        name.to_owned()
    });
    worded("reason", &|row| row.reason.clone());
    worded("fatigue", &|row| row.fatigue.to_string());
    columns.insert(
        "direction".to_owned(),
        directions(product).into_iter().map(|turn| rounded(turn, 3)).collect(),
    );
    (Value::Object(columns), Value::Object(words))
}

fn rounded(value: f64, digits: i32) -> Value {
    let scale = 10_f64.powi(digits);
    // Adding zero takes the sign off a zero.
    ((value * scale).round() / scale + 0.0).into()
}

/// Which way each ligament's length lies, degrees from the sheet's x, counter-clockwise: to its left the ligament ends at
/// the groove that frees it, to its right passes the other. 0 where nothing is laid out.
fn directions(product: &Product) -> Vec<f64> {
    match product {
        Product::Assembly(assembly) => vec![0.0; assembly.hinges.len()],
        Product::Sheet(sheet) if sheet.design.sheet_state == Some(State::Open) => {
            let along =
                |id| neck_direction(&sheet.design, id).map_or(0.0, |along| along.atan2().to_degrees());
            (0..sheet.hinges.len()).map(along).collect()
        }
        Product::Sheet(sheet) => closed_directions(sheet),
    }
}

/// Of a sheet that is cut closed: the nearest relief bar tells, or where there are none the nearest end of a slit, which
/// points at the hinge.
fn closed_directions(sheet: &Fabrication) -> Vec<f64> {
    let paths = &sheet.layout.paths;
    let ends = |path: &CutPath| [path.vertices[0].point, path.vertices[path.vertices.len() - 1].point];
    let bars = paths.iter().filter(|path| path.kind == CutKind::Relief).map(ends);
    let mut marks: Vec<GeomWithData<[f64; 2], Option<Vec2>>> =
        bars.map(|[a, b]| GeomWithData::new([0.5 * (a.x + b.x), 0.5 * (a.y + b.y)], Some(b - a))).collect();
    if marks.is_empty() {
        let slits = paths.iter().filter(|path| path.kind == CutKind::Slit).flat_map(ends);
        marks = slits.map(|end| GeomWithData::new([end.x, end.y], None)).collect();
    }
    let tree = RTree::bulk_load(marks);
    let direction = |row: &HingeRow| {
        let point = Point::new(row.point.x, row.point.y);
        let Some(mark) = tree.nearest_neighbor(&[point.x, point.y]) else { return 0.0 };
        let to_mark = Point::from((mark.geom()[0], mark.geom()[1])) - point;
        let along = mark.data.unwrap_or(-to_mark.turn_90());
        let along = if along.turn_90().dot(to_mark) < 0.0 { -along } else { along };
        along.atan2().to_degrees()
    };
    sheet.hinges.iter().map(direction).collect()
}
