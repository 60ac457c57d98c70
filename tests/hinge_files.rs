//! `hinges.json`, `hinges.csv` and the table of the terminal: they say what the rows hold, and keep their schema.

mod dome;
mod peers;
mod solve;

use std::fs;
use std::sync::LazyLock;

use dome::Dome;
use kirimorph::fabrication::hinge_table::{HingeRow, Verdict};
use kirimorph::fabrication::mechanics::{Fatigue, StrainClass};
use kirimorph::geometry::Point3;
use kirimorph::output::hinge_report::{self, WriteHingesError};
use serde_json::{Value, json};

static DOME: LazyLock<Dome> = LazyLock::new(dome::dome);

fn rows() -> Vec<HingeRow> {
    dome::laid_out(&DOME).hinges
}

/// Rows of the dome, with every kind of entry: an elastic hinge, no other cut, reasons with commas and quotes.
fn varied_rows() -> Vec<HingeRow> {
    let mut rows = rows();
    rows[1].torque = Some(1.25);
    rows[1].strain_class = StrainClass::Elastic;
    rows[1].fatigue = Fatigue::Unlimited;
    rows[2].nearest_cut = f64::INFINITY;
    rows[2].fatigue = Fatigue::Cycles(4321.0);
    rows[3].verdict = Verdict::Fail;
    rows[3].reason = "a, \"b\"; c".into();
    rows[3].strain_class = StrainClass::BeyondElongation;
    rows[4].point.z = -0.0;
    rows
}

fn hinges_text(rows: &[HingeRow]) -> String {
    dome::hinges_text(&DOME, rows)
}

fn remove(value: &mut Value, key: &str) {
    assert!(value.as_object_mut().unwrap().remove(key).is_some(), "{key}");
}

#[test]
fn the_hinge_report_keeps_the_schema() {
    let text = hinges_text(&varied_rows());
    let mutated = |change: fn(&mut Value)| {
        let mut file: Value = serde_json::from_str(&text).unwrap();
        change(&mut file);
        file.to_string()
    };
    type Change = (fn(&mut Value), &'static str);
    let changes: [Change; 10] = [
        (|f| remove(f, "kerf_mm"), "/"),
        (|f| f["version"] = json!(2), "/version"),
        (|f| f["hinges"][0]["note"] = json!("x"), "/hinges/0"),
        (|f| remove(&mut f["hinges"][0], "fatigue"), "/hinges/0"),
        (|f| f["hinges"][0]["tilt_deg"] = json!(90.5), "/hinges/0/tilt_deg"),
        (|f| f["hinges"][0]["width_mm"] = json!(null), "/hinges/0/width_mm"),
        (|f| f["hinges"][0]["strain_class"] = json!("plastic"), "/hinges/0/strain_class"),
        (|f| f["hinges"][0]["verdict"] = json!("good"), "/hinges/0/verdict"),
        (|f| f["hinges"][3]["reason"] = json!(""), "/hinges/3/reason"),
        (|f| f["hinges"][0]["pieces"] = json!([1, 1]), "/hinges/0/pieces"),
    ];
    let mut texts = vec![text.clone(), hinges_text(&rows())];
    texts.extend(changes.iter().map(|(change, _)| mutated(*change)));
    let Some(breaches) = peers::schema_breaches("hinges-schema", "hinges.schema.json", &texts) else {
        return;
    };
    assert_eq!(breaches[..2], [[""; 0]; 2]);
    for ((_, place), found) in changes.iter().zip(&breaches[2..]) {
        assert!(found.contains(&place.to_string()), "{place}: {found:?}");
    }
}

#[test]
fn the_hinge_report_holds_the_rows_in_full_precision() {
    let rows = varied_rows();
    let file: Value = serde_json::from_str(&hinges_text(&rows)).unwrap();
    assert_eq!(
        (&file["profile"], &file["kerf_mm"]),
        (&json!("steel-304-0.5mm"), &json!(DOME.profile.cut.kerf))
    );
    assert_eq!(file["hinges"].as_array().unwrap().len(), 60);
    for (row, ours) in file["hinges"].as_array().unwrap().iter().zip(&rows) {
        assert_eq!((&row["id"], &row["pieces"]), (&json!(ours.id), &json!(ours.pieces)));
        let point: [f64; 3] = serde_json::from_value(row["point"].clone()).unwrap();
        assert_eq!(Point3::from(point), ours.point);
        for (key, value) in [
            ("tilt_deg", ours.tilt.to_degrees()),
            ("angle_deg", ours.angle.to_degrees()),
            ("width_mm", ours.width),
            ("length_mm", ours.length),
            ("effective_length_mm", ours.effective_length),
            ("pole_offset_mm", ours.pole_offset),
            ("centre_offset_mm", ours.centre_offset),
            ("strain", ours.strain),
            ("stiffness_n_mm_per_rad", ours.stiffness),
            ("width_margin_mm", ours.width_margin),
        ] {
            assert_eq!(row[key].as_f64(), Some(value), "{key}");
        }
        assert_eq!(row["torque_n_mm"].as_f64(), ours.torque);
        assert_eq!(row["nearest_cut_mm"].as_f64().unwrap_or(f64::INFINITY), ours.nearest_cut);
        assert_eq!(row["reason"], ours.reason);
    }
    let said = |i: usize| ["strain_class", "fatigue", "verdict"].map(|key| file["hinges"][i][key].clone());
    assert_eq!(said(1)[..2], ["elastic", "unlimited"]);
    assert_eq!(said(2)[1], "about 4000 cycles (order of magnitude)");
    assert_eq!((&said(3)[0], &said(3)[2]), (&json!("beyond elongation"), &json!("fail")));
}

#[test]
fn csv_and_json_say_the_same() {
    let rows = varied_rows();
    let folder = peers::fresh_folder("hinge-tables");
    let [json, csv] = ["hinges.json", "hinges.csv"].map(|name| folder.join(name));
    fs::write(&json, hinges_text(&rows)).unwrap();
    let mut bytes = Vec::new();
    hinge_report::write_csv(&rows, &mut bytes).unwrap();
    fs::write(&csv, &bytes).unwrap();
    // The points are rounded, and -0 has no sign.
    assert!(!String::from_utf8(bytes).unwrap().contains("-0.0000,"));
    let Some(mut oracle) = peers::oracle("hinge_tables.py") else { return };
    let output = oracle.args([&json, &csv]).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    assert_eq!((&found["faults"], &found["rows"]), (&json!([]), &json!(60)));
    assert_eq!(found["header"].as_array().unwrap().len(), 27);
}

#[test]
fn hinges_that_are_not_numbers_are_not_written() {
    let mut rows = rows();
    rows[8].centre_offset = f64::NAN;
    let mut bytes = Vec::new();
    let errors = [
        hinge_report::write_json(&rows, &DOME.profile, None, None, &mut bytes).unwrap_err(),
        hinge_report::write_csv(&rows, &mut bytes).unwrap_err(),
    ];
    for error in errors {
        assert!(
            matches!(error, WriteHingesError::NotFinite { hinge: 8, column: "centre_offset_mm", .. }),
            "{error}"
        );
    }
    assert!(bytes.is_empty());
}

#[test]
fn the_table_of_a_real_sheet_shows_its_worst_hinges() {
    let rows = rows();
    let text = hinge_report::table(&rows, 5);
    assert_eq!(text.lines().count(), 1 + 5 + 1);

    let summary = hinge_report::summary(&rows).unwrap();
    assert_eq!(summary.ok + summary.warn + summary.fail, rows.len());
    assert_eq!(text.lines().last().unwrap(), summary.to_string());
    let worst = rows.iter().map(|row| row.strain).fold(0.0, f64::max);
    assert_eq!(summary.worst_strain.value, worst);
    assert_eq!(rows[summary.worst_strain.hinge].strain, worst);
}
