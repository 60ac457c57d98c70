//! Designs of other programs and the sample of one: imported, improved and cut as a user does it.

mod peers;
mod program;
mod recomputed;

use program::{asked, coordinates, json_file, number, refused, run, sample, succeeds};
use recomputed::check_recomputed;
use serde_json::{Value, json};

/// Name, arguments of import, pieces, hinges, and what the flat state is.
type Given = (&'static str, Vec<String>, usize, usize, Value);

/// The given designs.
fn given() -> Option<Vec<Given>> {
    let file = |name: &str| Some(peers::shared(&format!("pairs/{name}"))?.display().to_string());
    let (contracted, deployed, sphere) = (
        file("quad_hypar_w4_h4_i3_f1_r0_contracted.obj")?,
        file("quad_hypar_w4_h4_i3_f1_r0_deployed.obj")?,
        file("pykirigami_sphere-to-saddle")?,
    );
    let pair = |a: &String, b: &String| vec!["--closed".into(), a.clone(), "--open".into(), b.clone()];
    Some(vec![
        ("hypar", pair(&contracted, &deployed), 64, 112, json!("closed")),
        ("hypar the other way", pair(&deployed, &contracted), 64, 112, json!("open")),
        ("sphere", vec!["--pykirigami".into(), sphere], 100, 180, Value::Null),
    ])
}

#[test]
fn the_given_designs_become_rigid() {
    let folder = peers::fresh_folder("import-given");
    let Some(given) = given() else { return };
    for (name, source, pieces, hinges, sheet) in given {
        let import = |more: &[&str]| {
            let mut arguments = vec!["import", "-o", "d.json", "--size-mm", "300"];
            arguments.extend(source.iter().map(String::as_str).chain(more.iter().copied()));
            let text = succeeds(&folder, &arguments);
            (text, json_file(&folder.join("d.json")))
        };
        let (text, before) = import(&[]);
        assert_eq!(text.contains("nearly coincide"), name != "sphere", "{text}");
        assert_eq!(before["pieces"].as_array().unwrap().len(), pieces);
        assert_eq!(before["hinges"].as_array().unwrap().len(), hinges);
        assert_eq!(before["sheet_state"], sheet, "{name}");
        check_recomputed(&folder.join("d.json"));
        let flags: Vec<&str> = match name {
            "sphere" => vec!["--pykirigami", &source[1]],
            _ => vec!["--obj", &source[1], &source[3]],
        };
        let flags: Vec<&dyn AsRef<std::ffi::OsStr>> =
            flags.iter().map(|flag| flag as &dyn AsRef<std::ffi::OsStr>).collect();
        if let Some(found) = asked(peers::oracle("rigid_fit.py"), &flags) {
            assert_eq!((&found["pieces"], &found["hinges"]), (&json!(pieces), &json!(hinges)), "{name}");
            for key in ["rigid_residual", "max_length_error"] {
                // The frame and the scale round; lengths of a millionth of a side most.
                let (a, b) = (number(&found, key), number(&before["report"], key));
                assert!((a - b).abs() <= 1e-6 * a, "{name}: {key}: {a:e} and {b:e}");
            }
            let worst = format!("piece {}, ", found["worst_piece"]);
            assert!(text.contains(&worst), "{name}: {worst} is not in {text}");
        }
        let (_, after) = import(&["--improve"]);
        for key in ["max_length_error", "rigid_residual"] {
            let [old, new] = [&before, &after].map(|design| number(&design["report"], key));
            assert!(new < 1e-6 * old && new < 1e-8, "{name}: {key} from {old:e} to {new:e}");
        }
        assert!(number(&after["report"], "e_isom") < 1e-26, "{name}");
        // Nothing else changed: a ten thousandth of the size.
        let moved = program::largest_difference(&coordinates(&before), &coordinates(&after));
        assert!(moved < 0.03, "{name}: {moved} mm");
        check_recomputed(&folder.join("d.json"));
    }
}

#[test]
fn the_given_flat_design_is_cut() {
    let folder = peers::fresh_folder("import-given-cut");
    let Some(given) = given() else { return };
    let (_, source, ..) = &given[0];
    let mut arguments =
        vec!["import", "-o", "d.json", "--size-mm", "300", "--improve", "-p", "steel-304-0.5mm"];
    arguments.extend(source.iter().map(String::as_str));
    succeeds(&folder, &arguments);
    let flags = ["fabricate", "d.json", "-p", "steel-304-0.5mm", "-o", "cut", "--allow-failing-hinges"];
    let text = succeeds(&folder, &flags);
    assert!(text.contains("112"), "{text}");
    check_recomputed(&folder.join("cut/design.json"));
    // The other one has no flat state: said so, with the hinges as they would have to be.
    let mut arguments = vec!["import", "-o", "s.json", "--size-mm", "300"];
    arguments.extend(given[2].1.iter().map(String::as_str));
    succeeds(&folder, &arguments);
    let run = run(&folder, ["check", "s.json", "-p", "steel-304-0.5mm", "-w", "3"]);
    assert_eq!(run.status, 2);
    assert!(run.stdout.contains("180 hinges"), "{}", run.stdout);
    assert!(run.stderr.contains("neither state is flat"), "{}", run.stderr);
    refused(
        &folder,
        &["fabricate", "s.json", "-p", "steel-304-0.5mm", "-o", "none"],
        2,
        &["neither state is flat"],
    );
}

#[test]
fn the_sample_is_imported_improved_and_cut_without_a_failing_hinge() {
    let folder = peers::fresh_folder("import-sample");
    let file = |name: &str| sample("import").join(name).display().to_string();
    let (closed, open) = (file("dome-closed.obj"), file("dome-open.obj"));
    let pair = ["import", "--closed", &closed, "--open", &open, "-o", "dome.json"];
    succeeds(&folder, &pair);
    let before = number(&json_file(&folder.join("dome.json"))["report"], "max_length_error");
    // The files hold two decimals.
    assert!(before > 1e-5 && before < 1e-2, "{before}");
    succeeds(&folder, &[&pair[..], &["--improve", "-p", "steel-304-0.5mm"]].concat());
    let after = number(&json_file(&folder.join("dome.json"))["report"], "max_length_error");
    assert!(after < 1e-12 && after < 1e-3 * before, "{after}");
    let text = succeeds(&folder, &["fabricate", "dome.json", "-p", "steel-304-0.5mm", "-o", "dome"]);
    assert!(text.contains(" 0 fail"), "{text}");
    let hinges = json_file(&folder.join("dome/hinges.json"));
    for row in hinges["hinges"].as_array().unwrap() {
        assert!(number(row, "centre_offset_mm") < 0.02, "{row}");
    }
}
