//! Bistable sheets.

use super::*;

/// The job as one of bistable sheets, with more lines in its pattern.
fn bistable(lines: &str) -> String {
    let rotating = ["stretches", "opening"];
    let kept = JOB.lines().filter(|line| !rotating.iter().any(|key| line.starts_with(key)));
    let text: Vec<&str> = kept.take_while(|line| !line.starts_with("[solver]")).collect();
    let kind = format!("kind = \"bistable\"\n{lines}");
    text.join("\n").replace("kind = \"rotating-rectangles\"", &kind)
}

#[test]
fn bistable_cells_have_their_documented_defaults_and_obey_inequality_3() {
    let folder = Folder::new("bistable");
    let plain = folder.read(&bistable("")).unwrap();
    let given: Vec<String> = BISTABLE_DEFAULTS[..5]
        .iter()
        .map(|(key, value)| format!("{}\n", key.replace("pattern.", "") + " = " + value))
        .collect();
    assert_eq!(folder.read(&bistable(&given.concat())).unwrap(), plain);
    let weights = BISTABLE_DEFAULTS[5..]
        .iter()
        .map(|(key, value)| format!("{} = {value}\n", key.replace("solver.", "")));
    let solver = format!("{}\n[solver]\n{}", bistable(""), weights.collect::<String>());
    assert_eq!(folder.read(&solver).unwrap(), plain);
    let Kind::Bistable(cell) = plain.pattern.kind else { panic!("bistable") };
    assert_eq!(plain.pattern.stretches, cell.stretches());
    for (lines, key, said) in [
        // b < B cos phi - A sin phi = 0.642: the sides a, prolonged, miss.
        ("b = 0.7", "pattern.b", "sides a, prolonged, miss the cell's left and right edges by 0.0305"),
        ("a = 0.7", "pattern.a", "sides b, prolonged, miss the cell's top and bottom edges by 0.0305"),
        (
            "phi_deg = 30",
            "pattern.phi_deg",
            "sides a, prolonged, miss the cell's left and right edges by 0.0312",
        ),
        ("stretches = [1.4, 1.4]", "pattern.stretches", "does not go with kind = \"bistable\""),
        ("opening = \"full\"", "pattern.opening", "does not go with kind = \"bistable\""),
        ("a = -1.0", "pattern.a", "0.001 to 1000"),
    ] {
        let found = folder.diagnostic(&bistable(lines));
        assert_eq!(found.key, key, "{found}");
        assert!(found.message.contains(said), "{found}");
    }
    assert!(folder.diagnostic(&bistable("b = 0.7")).help.contains("b must be less than 0.6420"));
    assert!(folder.diagnostic(&bistable("phi_deg = 30")).help.contains("phi_deg = 27.7"));
    let found = folder.diagnostic(&with("kind", "kind = \"rotating-rectangles\"\nphi_deg = 18"));
    assert!(found.message.contains("phi_deg does not go with"), "{found}");
}
