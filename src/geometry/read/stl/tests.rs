use super::*;

const SQUARE: [[[f32; 3]; 3]; 2] = [
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5]],
    [[0.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]],
];

/// A binary file, written here and not by `stl_io`.
fn binary(header: &str, triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        // The normal is a lie and must not matter.
        bytes.extend([f32::NAN; 3].iter().chain(triangle.iter().flatten()).flat_map(|x| x.to_le_bytes()));
        bytes.extend([0xff, 0xff]);
    }
    bytes
}

fn facet(corners: [[f32; 3]; 3]) -> String {
    let vertices: String = corners.iter().map(|[x, y, z]| format!("   vertex {x} {y} {z:e}\n")).collect();
    format!(" facet normal nan 0 0\n  outer loop\n{vertices}  endloop\n endfacet\n")
}

fn ascii(triangles: &[[[f32; 3]; 3]]) -> String {
    format!("solid\n{}endsolid\n", triangles.iter().map(|&t| facet(t)).collect::<String>())
}

fn fault(bytes: &[u8]) -> String {
    parse(bytes).unwrap_err().to_string()
}

#[test]
fn both_forms_give_the_same_welded_mesh() {
    let mesh = parse(&binary("any header", &SQUARE)).unwrap();
    assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.vertices[2], Point3::new(1.0, 1.0, 0.5));
    assert_eq!(parse(ascii(&SQUARE).as_bytes()).unwrap(), mesh);
}

#[test]
fn the_form_is_told_by_size_not_by_the_header() {
    let mesh = parse(&binary("", &SQUARE)).unwrap();
    for header in ["solid", "solid part", "SOLID", "  solid x"] {
        assert_eq!(parse(&binary(header, &SQUARE)).unwrap(), mesh, "{header:?}");
    }
}

#[test]
fn a_binary_file_may_be_valid_text() {
    // The bytes of 0 and 2 are valid UTF-8, and so is the whole file.
    let mut bytes = binary("solid part", &[[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]]);
    bytes[84..96].fill(0);
    bytes[132..].fill(0);
    assert!(std::str::from_utf8(&bytes).is_ok());
    assert_eq!(parse(&bytes).unwrap().faces, [[0, 1, 2]]);
}

#[test]
fn ascii_is_read_in_any_case_with_or_without_name() {
    let mesh = parse(ascii(&SQUARE).as_bytes()).unwrap();
    for text in [
        ascii(&SQUARE).to_uppercase(),
        ascii(&SQUARE).replace("solid\n", "solid a name with solid in it\n"),
        ascii(&SQUARE).replace('\n', "\r\n"),
        format!("\n\n  {}\n\n", ascii(&SQUARE).replace("\n ", "\n\n\t")),
        ascii(&SQUARE).trim_end().to_owned(),
    ] {
        assert_eq!(parse(text.as_bytes()).unwrap(), mesh, "{text}");
    }
}

#[test]
fn all_solid_blocks_are_read() {
    let text = format!("{}{}", ascii(&SQUARE[..1]), ascii(&SQUARE[1..]));
    assert_eq!(parse(text.as_bytes()).unwrap().faces, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn negative_zero_is_zero() {
    let mut triangles = SQUARE;
    triangles[1][0] = [-0.0, 0.0, -0.0];
    for mesh in [parse(&binary("", &triangles)), parse(ascii(&triangles).as_bytes())] {
        assert_eq!(mesh.unwrap().vertices.len(), 4);
    }
}

#[test]
fn nothing_is_welded_by_a_tolerance() {
    let mut triangles = SQUARE;
    triangles[1][1][0] = 1.0 + f32::EPSILON;
    assert_eq!(parse(&binary("", &triangles)).unwrap().vertices.len(), 5);
}

#[test]
fn triangles_with_coinciding_corners_are_left_out() {
    let [first, second] = SQUARE;
    let needle = [first[0], first[2], first[2]];
    let mesh = parse(&binary("", &[first, needle, second])).unwrap();
    assert_eq!(mesh, parse(&binary("", &SQUARE)).unwrap());
    assert_eq!(parse(&binary("", &[needle])).unwrap_err().problem, Problem::NoFaces);
}

#[test]
fn coordinates_that_are_no_numbers_are_refused() {
    let mut triangles = SQUARE;
    triangles[1][2][1] = f32::NAN;
    assert!(fault(&binary("", &triangles)).starts_with("triangle 2: the coordinate `NaN` is not finite"));
    assert!(fault(ascii(&triangles).as_bytes()).starts_with("line 13: the coordinate `NaN` is not finite"));
    triangles[1][2][1] = f32::MAX;
    assert!(fault(&binary("", &triangles)).starts_with("triangle 2: the coordinate 3.4"));
    let text = ascii(&SQUARE).replace("5e-1", "5e-1 7");
    assert_eq!(fault(text.as_bytes()), "line 6: a vertex has three coordinates, this one has 4 numbers");
    let text = ascii(&SQUARE).replace("5e-1", "5e-1x");
    assert!(fault(text.as_bytes()).starts_with("line 6: `5e-1x` is not a number"));
}

#[test]
fn wrong_counts_and_sizes_are_refused() {
    let mut bytes = binary("solid", &SQUARE);
    bytes.extend([0; 3]);
    assert!(fault(&bytes).starts_with("3 bytes follow after the last of the stated triangles"));
    bytes.truncate(84 + 99);
    assert!(fault(&bytes).starts_with("the file states 2 triangles but ends too early"));
    bytes[80..84].copy_from_slice(&[0xff; 4]);
    assert!(fault(&bytes).starts_with("the file states 4294967295 triangles but ends too early"));
    assert!(fault(&binary("", &SQUARE)[..83]).starts_with("the file ends where `solid` or an 84-byte"));
    assert_eq!(parse(&binary("", &[])).unwrap_err().problem, Problem::NoFaces);
}

#[test]
fn ascii_is_refused_wherever_it_is_cut_off() {
    let text = ascii(&SQUARE);
    // Without its last letters, "endsolid" is another word.
    for end in 0..text.trim_end().len() {
        let error = parse(&text.as_bytes()[..end]).unwrap_err().to_string();
        assert!(!error.is_empty());
    }
    let cut = text.find("endloop").unwrap();
    assert!(fault(&text.as_bytes()[..cut]).starts_with("line 6: the file ends where `endloop`"));
}

#[test]
fn ascii_out_of_order_is_refused_with_its_line() {
    let text = ascii(&SQUARE);
    assert!(
        fault(text.replace("  outer loop\n", "").as_bytes()).starts_with("line 3: expected `outer loop`")
    );
    assert!(fault(text.replace(" endfacet\n", "").as_bytes()).starts_with("line 8: expected `endfacet`"));
    let quad = text.replacen("  endloop", "   vertex 0 0 0\n  endloop", 1);
    assert!(
        fault(quad.as_bytes()).starts_with("line 7: expected `endloop` after three vertices, found `vertex`")
    );
    assert!(fault(format!("{text}rest").as_bytes()).starts_with("line 17: expected `solid`, found `rest`"));
    assert_eq!(parse(b"solid\nendsolid\n").unwrap_err().problem, Problem::NoFaces);
}
