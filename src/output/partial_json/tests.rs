use super::*;
use crate::geometry::Point3;

fn hashes() -> BTreeMap<String, String> {
    [("job", "a"), ("target", "b")].map(|(name, hash)| (name.to_owned(), hash.to_owned())).into()
}

fn entry(stage: &str, termination: Termination, unknowns: Vec<f64>) -> Entry {
    let row = |energy: f64| Iteration { energies: vec![energy, 1.0 / 3.0], damping: 0.1 + 0.2 };
    let report = Report {
        terms: vec!["prox".to_owned(), "fair".to_owned()],
        iterations: vec![row(0.7), row(5e-324)],
        next_damping: 1e-300,
        termination,
    };
    Entry { stage: stage.to_owned(), report, unknowns }
}

fn journal() -> Vec<Entry> {
    // Numbers that need all their digits, and more than one line of them.
    let unknowns: Vec<f64> = (1..30).map(|i| f64::from(i).sqrt() * 10_f64.powi(3 * i - 40)).collect();
    vec![
        entry("stage-2", Termination::Stagnation, unknowns.clone()),
        entry("stage-3", Termination::IterationLimit, Vec::new()),
        entry("stage-3", Termination::Interrupted, unknowns),
    ]
}

fn text(journal: &[Entry]) -> String {
    let corner = |x: f64| Point3::new(x, 0.1, -0.0);
    let pieces =
        [Piece { corners: vec![0, 1], closed: vec![corner(1.0), corner(2.0)], open: vec![corner(3.0)] }];
    let mut bytes = Vec::new();
    let partial = Partial { stage: "stage-3", pieces: &pieces, journal, hashes: &hashes() };
    write(&partial, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

fn parsed(text: &str) -> Result<Vec<Entry>, String> {
    parse(text.as_bytes(), Path::new("design.partial.json"), &hashes()).map_err(|error| error.to_string())
}

#[test]
fn the_state_reads_back_exactly() {
    let text = text(&journal());
    assert_eq!(parsed(&text), Ok(journal()));
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (&value["converged"], &value["phase"], &value["iteration"]),
        (&false.into(), &1.into(), &1.into())
    );
    assert_eq!(value["pieces"][0]["closed"][1][0], 2.0);
}

#[test]
fn a_state_that_is_not_finite_is_not_written() {
    for place in 0..2 {
        let mut journal = journal();
        match place {
            0 => journal[2].unknowns[5] = f64::NAN,
            _ => journal[0].report.iterations[0].energies[1] = f64::INFINITY,
        }
        let mut bytes = Vec::new();
        let partial = Partial { stage: "stage-3", pieces: &[], journal: &journal, hashes: &hashes() };
        assert!(write(&partial, &mut bytes).is_err());
        assert!(bytes.is_empty());
    }
}

#[test]
fn what_does_not_fit_is_refused_in_words() {
    let sound = text(&journal());
    for (find, replace, says) in [
        ("\"version\": 1", "\"version\": 2", "version 2 of the format"),
        ("\"program\": \"kirimorph ", "\"program\": \"kirimorph 9", "written by"),
        ("\"converged\": false", "\"converged\": true", "not an interrupted design"),
        ("\"job\":\"a\"", "\"job\":\"c\"", "the job has changed"),
        ("\"target\":\"b\"", "\"other\":\"b\"", "the target has changed"),
        ("\"stagnation\"", "\"boredom\"", "minimisation 0 stopped for an unknown reason"),
        ("\"stagnation\"", "\"interrupted\"", "minimisation 0 is interrupted"),
        ("[\"prox\",\"fair\"]", "[\"prox\"]", "2 energies for 1 terms"),
        ("\"damping\":0.30000000000000004", "\"damping\":1e9990", "out of range"),
        ("\"damping\":0.30000000000000004", "\"damping\":null", "invalid type: null"),
        ("\"phase\"", "\"faze\"", "unknown field"),
        ("\"minimisations\"", "\"minimisation\"", "unknown field"),
    ] {
        let faulty = sound.replacen(find, replace, 1);
        assert_ne!(faulty, sound, "{find}");
        let error = parsed(&faulty).unwrap_err();
        assert!(error.contains(says) && error.contains("design.partial.json"), "{find}: {error}");
    }
    assert!(parsed(&sound[..sound.len() / 2]).unwrap_err().contains("EOF"));
}
