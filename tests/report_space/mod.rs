//! What the view in space of a report must show and do: measured on the pixels of its canvas.

use serde_json::Value;

use super::{number, numbers};

mod poses;
pub use poses::check_poses;

/// Of one page, with the hinges and the design that it shows.
pub fn check(found: &Value, hinges: &[Value], design: &Value, job: &str) {
    check_states(&found["states"]);
    if !design["sheet_state"].is_null() {
        check_picks(&found["picks"], hinges);
    }
    check_keys(&found["keys"], job);
}

fn check_states(states: &Value) {
    for state in ["closed", "half", "open"] {
        let covered = number(states, state);
        assert!((0.1..0.95).contains(&covered), "{state}: {states}");
    }
    for pair in ["closed_half", "half_open", "closed_open"] {
        assert!(number(states, pair) > 0.04, "{pair}: {states}");
    }
    let words = states["words"].as_array().unwrap();
    for (words, start) in words.iter().zip(["0 % open, ", "50 % open, ", "100 % open, "]) {
        let words = words.as_str().unwrap();
        assert!(words.starts_with(start) && words.contains("largest hinge angle"), "{words}");
    }
    assert!(number(states, "axes") > 5e-4, "the axes: {states}");
    if states["targets"] == true {
        assert!(number(states, "target") > 0.01, "the target: {states}");
    }
    assert!(number(states, "still") < 0.002, "what is printed is the open state: {states}");
    let colours: Vec<&str> =
        states["colours"].as_array().unwrap().iter().map(|way| way[0].as_str().unwrap()).collect();
    assert!(colours.starts_with(&["turning sense", "worst strain class"]), "{states}");
    assert_eq!(colours.contains(&"distance to target"), states["targets"] == true, "{states}");
    for way in &states["colours"].as_array().unwrap()[1..] {
        assert!(way[1].as_f64().unwrap() > 0.01, "{way}");
    }
}

/// Seen from above without perspective the marks of three hinges lie like their points on the sheet: the turn and the scale
/// that the farther two give lead the third one to its place. A click there chooses the hinge, or one less than 2 mm beside it.
fn check_picks(picks: &Value, hinges: &[Value]) {
    let picks = picks.as_array().unwrap();
    let point = |hinge: &Value| {
        let point = numbers(&hinges[hinge.as_u64().unwrap() as usize]["point"]);
        [point[0], point[1]]
    };
    let on_sheet: Vec<[f64; 2]> = picks.iter().map(|pick| point(&pick["hinge"])).collect();
    let in_window: Vec<[f64; 2]> = picks
        .iter()
        .map(|pick| {
            let at = numbers(&pick["at"]);
            [at[0], -at[1]]
        })
        .collect();
    let apart = |points: &[[f64; 2]], i: usize| [points[i][0] - points[0][0], points[i][1] - points[0][1]];
    let times = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
    let length = |i: usize| apart(&on_sheet, i)[0].hypot(apart(&on_sheet, i)[1]);
    let [near, far] = if length(1) < length(2) { [1, 2] } else { [2, 1] };
    let [from, to] = [apart(&on_sheet, far), apart(&in_window, far)];
    let square = from[0] * from[0] + from[1] * from[1];
    let turn = times(to, [from[0] / square, -from[1] / square]);
    let [wanted, seen] = [times(turn, apart(&on_sheet, near)), apart(&in_window, near)];
    let off = (wanted[0] - seen[0]).hypot(wanted[1] - seen[1]);
    // Axes stand aslant, so that the mark of a rod is not quite where its hinge is.
    assert!(off < 4.0 + 0.04 * seen[0].hypot(seen[1]) && square > 1.0, "{off} pixels: {picks:?}");
    for pick in picks {
        assert!((1e-4..0.1).contains(&number(pick, "changed")), "{pick}");
        let [wanted, clicked] = [point(&pick["hinge"]), point(&pick["clicked"])];
        assert!((wanted[0] - clicked[0]).hypot(wanted[1] - clicked[1]) < 2.0, "{pick}");
    }
}

fn check_keys(keys: &Value, job: &str) {
    assert_eq!(keys["flat"].as_array().unwrap()[..2], [false, true], "{keys}");
    assert!(keys["flat"][2].as_f64().unwrap() > 0.002, "perspective: {keys}");
    assert!(number(keys, "turned") > 0.02, "{keys}");
    assert!(number(keys, "far") < 0.7 * number(keys, "start"), "{keys}");
    assert!(number(keys, "fitted") > 1.5 * number(keys, "far"), "{keys}");
    // Where motion is unwelcome the other state is there at once; else it takes its time.
    assert!(keys["calm"].as_str().unwrap().starts_with("0 % open"), "{keys}");
    let playing = keys["playing"][0].as_str().unwrap();
    let percent: f64 = playing.split(' ').next().unwrap().parse().unwrap();
    assert!(percent < 90.0, "{keys}");
    assert_eq!((&keys["playing"][1], &keys["stopped"]), (&"Stop".into(), &"Play".into()));
    let picture = &keys["picture"];
    let plain: String =
        job.chars().map(|c| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { ' ' }).collect();
    let name = plain.split(' ').filter(|part| !part.is_empty()).collect::<Vec<_>>();
    assert!(name.iter().all(|part| picture[0].as_str().unwrap().contains(part)), "{keys}");
    assert!(picture[0].as_str().unwrap().ends_with(".png") && picture[1] == "PNG", "{keys}");
    assert!(picture[2].as_f64().unwrap() > 5000.0 && picture[3].as_f64().unwrap() > 600.0, "{keys}");
}
