use super::*;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    laser: Laser,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Laser {
    kerf_mm: Spanned<f64>,
    name: Option<String>,
}

const KERF: Limits = Limits::new(0.01, 2.0, "mm", "a beam burns a groove of some width");

fn read(text: &str) -> Result<f64, TomlError> {
    let source = TomlSource { file: "a.toml", text };
    let file: File = source.parse()?;
    source.number(&file.laser.kerf_mm, &KERF)
}

fn diagnostic(text: &str) -> Diagnostic {
    match read(text) {
        Err(TomlError::Invalid(diagnostic)) => *diagnostic,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn a_semantic_error_is_laid_out_in_plain_text() {
    let found = diagnostic("# comment\n[laser]\nkerf_mm = -1.50 # why\n");
    let expected = "\
laser.kerf_mm = -1.50 is out of range: allowed is 0.01 to 2 mm
 --> a.toml:3:11
  |
3 | kerf_mm = -1.50 # why
  |           ^^^^^
  |
  = help: a beam burns a groove of some width";
    assert_eq!(found.to_string(), expected);
    assert_eq!((found.line, found.column, found.key.as_str()), (3, 11, "laser.kerf_mm"));
}

#[test]
fn limits_are_inclusive_and_integers_are_numbers() {
    assert_eq!(read("laser = { kerf_mm = 0.01 }").unwrap(), 0.01);
    assert_eq!(read("laser.kerf_mm = 2").unwrap(), 2.0);
    assert!(read("laser.kerf_mm = 2.0000000001").is_err());
}

#[test]
fn numbers_that_are_not_finite_are_named_as_such() {
    for word in ["nan", "-nan", "inf", "-inf"] {
        let found = diagnostic(&format!("[laser]\nkerf_mm = {word}\n"));
        assert!(found.message.contains("not a finite number"), "{}", found.message);
        assert!(found.message.contains(word) && found.message.contains("0.01 to 2 mm"));
    }
}

#[test]
fn serde_errors_point_at_the_place_and_name_the_key() {
    let unknown = diagnostic("[laser]\nkerf_mm = 1\nkref_mm = 1\n");
    assert_eq!((unknown.line, unknown.column, unknown.key.as_str()), (3, 1, "laser.kref_mm"));
    assert!(unknown.message.contains("unknown key `kref_mm`, expected `kerf_mm` or `name`"));

    let missing = diagnostic("# nothing\n[laser]\nname = \"x\"\n");
    assert_eq!((missing.line, missing.column, missing.key.as_str()), (2, 1, "laser"));
    assert!(missing.message.contains("missing key `kerf_mm`"));

    let wrong = diagnostic("[laser]\nkerf_mm = \"wide\"\n");
    assert_eq!((wrong.line, wrong.column, wrong.key.as_str()), (2, 11, "laser.kerf_mm"));
    assert!(wrong.to_string().contains("^^^^^^"));

    let syntax = diagnostic("[laser]\nkerf_mm = = 1\n");
    assert_eq!((syntax.line, syntax.key.as_str()), (2, ""));
    assert!(diagnostic("").message.contains("missing key `laser`"));
}

#[test]
fn columns_count_characters_and_line_ends_may_be_crlf() {
    let found = diagnostic("[laser]\r\nname = \"Grüße\"\r\n\"kerf_mm\" = -1\r\n");
    assert_eq!((found.line, found.column), (3, 13));
    let found = diagnostic("laser = { name = \"Grüße\", kerf_mm = -1 }");
    assert_eq!(found.column, 37);
    // The caret stands under the value although "ü" and "ß" have two bytes each.
    let text = found.to_string();
    let lines: Vec<&str> = text.lines().collect();
    let column = |line: &str, what| line.chars().position(|c| c == what).unwrap();
    assert_eq!(column(lines[4], '^'), column(lines[3], '-'), "{text}");
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let found = diagnostic("[laser]\n\"\\u001b[31mred\" = 1\n");
    assert!(!found.to_string().contains('\u{1b}'), "{found}");
}

#[test]
fn files_that_are_no_text_are_refused() {
    let folder = std::env::temp_dir().join(format!("kirimorph-toml-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    assert!(matches!(read_text(&folder), Err(TomlError::Directory { .. })));
    assert!(matches!(read_text(&folder.join("absent.toml")), Err(TomlError::Read { .. })));
    let path = folder.join("bytes.toml");
    std::fs::write(&path, b"a = 1\nb = \xff\n").unwrap();
    assert!(matches!(read_text(&path), Err(TomlError::NotUtf8 { line: 2, .. })));
    std::fs::write(&path, vec![b' '; MAX_BYTES as usize + 1]).unwrap();
    assert!(matches!(read_text(&path), Err(TomlError::TooLong { .. })));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn deep_nesting_is_an_error_not_an_overflow() {
    let text = format!("laser = {}1{}", "[".repeat(200_000), "]".repeat(200_000));
    assert!(read(&text).is_err());
}
