use super::*;

const ASCII: &str = "ply\nformat ascii 1.0\ncomment made by hand\nobj_info x\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n3 0 1 2\n3 0 2 3\n";

fn fault(text: &str) -> String {
    parse(text.as_bytes()).unwrap_err().to_string()
}

/// The bytes of a number as the PLY type `kind` stores them.
fn encode(kind: &str, value: f64, big: bool) -> Vec<u8> {
    let mut bytes = match kind {
        "char" | "int8" => (value as i8).to_le_bytes().to_vec(),
        "uchar" | "uint8" => (value as u8).to_le_bytes().to_vec(),
        "short" | "int16" => (value as i16).to_le_bytes().to_vec(),
        "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
        "int" | "int32" => (value as i32).to_le_bytes().to_vec(),
        "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
        "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if big {
        bytes.reverse();
    }
    bytes
}

const KINDS: [&str; 16] = [
    "char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32", "uint", "uint32",
    "float", "float32", "double", "float64",
];

/// A square of two triangles and its mirror image of a quad, with properties and elements to pass over.
fn binary(big: bool, xyz: &str, length: &str, index: &str) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement camera 2\nproperty list uchar double view\n\
         property short id\nelement vertex 4\nproperty uchar red\nproperty {xyz} x\nproperty {xyz} y\n\
         property list ushort float extra\nproperty {xyz} z\nelement face 3\nproperty float area\n\
         property list {length} {index} vertex_index\nproperty list uchar float texcoord\nelement nothing 99\n\
         element edge 1\nproperty int vertex1\nend_header\n"
    )
    .into_bytes();
    let mut put = |kind: &str, values: &[f64]| {
        bytes.extend(values.iter().flat_map(|&value| encode(kind, value, big)));
    };
    for length in [0, 3] {
        put("uchar", &[f64::from(length)]);
        put("double", &vec![f64::NAN; length as usize]);
        put("short", &[-1.0]);
    }
    for [x, y, z] in [[0.0, 0.0, 1.0], [20.0, 0.0, 2.0], [20.0, 30.0, 3.0], [0.0, 30.0, 4.0]] {
        put("uchar", &[255.0]);
        put(xyz, &[x, y]);
        put("ushort", &[1.0]);
        put("float", &[f64::NAN]);
        put(xyz, &[z]);
    }
    for face in [&[0.0, 1.0, 2.0][..], &[0.0, 2.0, 3.0], &[3.0, 2.0, 1.0, 0.0]] {
        put("float", &[f64::INFINITY]);
        put(length, &[face.len() as f64]);
        put(index, face);
        put("uchar", &[2.0]);
        put("float", &[0.5, 0.5]);
    }
    put("int", &[7.0]);
    bytes
}

#[test]
fn ascii_is_read() {
    let mesh = parse(ASCII.as_bytes()).unwrap();
    assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.vertices[2], Point3::new(1.0, 1.0, 0.5));
    assert_eq!(parse(ASCII.replace('\n', "\r\n").as_bytes()).unwrap(), mesh);
    assert_eq!(parse(ASCII.replace("\n0 0 0", "\n\n\t0  0 0  ").as_bytes()).unwrap(), mesh);
    assert_eq!(parse(ASCII.trim_end().as_bytes()).unwrap(), mesh);
}

#[test]
fn all_types_and_byte_orders_are_read() {
    for big in [false, true] {
        for xyz in KINDS {
            let mesh = parse(&binary(big, xyz, "uchar", "int")).unwrap();
            assert_eq!(mesh.faces, [vec![0, 1, 2], vec![0, 2, 3], vec![3, 2, 1, 0]], "{xyz}");
            assert_eq!(mesh.vertices[2], Point3::new(20.0, 30.0, 3.0), "{xyz}");
        }
        for integer in &KINDS[..12] {
            let mesh = parse(&binary(big, "float", integer, integer)).unwrap();
            assert_eq!(mesh.faces[2], [3, 2, 1, 0], "{integer}");
        }
    }
}

#[test]
fn signed_numbers_keep_their_sign() {
    for kind in ["char", "short", "int", "float", "double"] {
        for big in [false, true] {
            let mut bytes = format!(
                "ply\nformat binary_{}_endian 1.0\nelement vertex 3\nproperty {kind} x\nproperty {kind} y\n\
                 property {kind} z\nelement face 1\nproperty list char char vertex_indices\nend_header\n",
                if big { "big" } else { "little" }
            )
            .into_bytes();
            for value in [-1.0, 0.0, 0.0, -128.0, 127.0, 0.0, -2.0, -3.0, 0.0] {
                bytes.extend(encode(kind, value, big));
            }
            bytes.extend([3, 2, 1, 0]);
            let mesh = parse(&bytes).unwrap();
            assert_eq!(mesh.vertices[1], Point3::new(-128.0, 127.0, 0.0));
            assert_eq!(mesh.vertices[2], Point3::new(-2.0, -3.0, 0.0));
        }
    }
}

#[test]
fn a_carriage_return_ends_the_header_of_a_binary_file_too() {
    let bytes = binary(false, "double", "uchar", "uint");
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8(bytes[..end].to_vec()).unwrap().replace('\n', "\r\n");
    let with_crlf = [header.as_bytes(), &bytes[end..]].concat();
    assert_eq!(parse(&with_crlf).unwrap(), parse(&bytes).unwrap());
}

#[test]
fn faults_of_the_header_name_the_line() {
    for (from, to, expected) in [
        ("ply\n", "plx\n", "line 1: expected `ply`, found `plx`"),
        ("ascii", "asci", "line 2: expected ascii, binary_little_endian or binary_big_endian, found `asci`"),
        ("ascii 1.0", "ascii 2.0", "line 2: expected a line of a PLY 1.0 header"),
        ("format ascii 1.0\n", "", "line 10: expected a `format` line"),
        ("vertex 4", "vertex -4", "line 5: expected a count of records, found `-4`"),
        ("float y", "flout y", "line 7: expected a type"),
        ("float y", "float", "line 7: expected `property TYPE NAME`, found `float`"),
        ("float y", "float w", "line 11: expected a scalar property y of element vertex"),
        ("float y", "list uchar float y", "line 11: expected a scalar property y of element vertex"),
        ("element vertex 4\n", "", "line 5: expected `element` first"),
        ("element face 2", "element vertex 2", "line 9: expected an element that was not stated before"),
        (
            "uchar int",
            "float int",
            "line 10: expected an integer type for the length of a list, found `float`",
        ),
        ("uchar int", "uchar float", "line 11: expected an integer list vertex_indices or vertex_index"),
        ("vertex_indices", "indices", "line 11: expected an integer list vertex_indices or vertex_index"),
        ("element face 2", "element strips 2", "the file has no faces"),
        ("element face 2", "element face 0", "the file has no faces"),
        ("element vertex 4", "element vertex 0", "the file has no vertices"),
        ("element vertex 4", "element points 4", "the file has no vertices"),
    ] {
        let message = fault(&ASCII.replacen(from, to, 1));
        assert!(message.starts_with(expected), "{to:?}: {message}");
    }
    assert!(fault("ply\nformat ascii 1.0\n").starts_with("line 2: the file ends where `end_header`"));
}

#[test]
fn faults_of_the_body_name_line_and_range() {
    for (from, to, expected) in [
        ("3 0 2 3", "3 0 2 4", "line 17: vertex 4 is named, but the vertices run from 0 to 3"),
        ("3 0 2 3", "3 0 2 -1", "line 17: vertex -1 is named, but the vertices run from 0 to 3"),
        ("3 0 2 3", "3 0 2 2", "line 17: the face names vertex 2 twice"),
        ("3 0 2 3", "2 0 2", "line 17: the face has 2 corners"),
        ("3 0 2 3", "3 0 2", "line 17: expected another value of the record, found `end of line`"),
        ("3 0 2 3", "3 0 2 3 1", "line 17: expected the end of the face record, found `1`"),
        ("3 0 2 3", "3 0 2 2.5", "line 17: expected an integer, found `2.5`"),
        ("3 0 2 3", "3 0 2 nan", "line 17: expected an integer, found `nan`"),
        ("3 0 2 3", "-3 0 2 3", "line 17: expected the length of a list, found `-3`"),
        ("3 0 2 3", "4000000000 0 2 3", "line 17: the file states 4000000000 items of a list but"),
        ("1 1 0.5", "1 1 nan", "line 14: the coordinate `NaN` is not finite"),
        ("1 1 0.5", "1 1 0,5", "line 14: `0,5` is not a number"),
        ("1 1 0.5", "1 1 2e9", "line 14: the coordinate 2e9 is beyond the limit"),
        ("3 0 2 3\n", "", "the file ends where record 2 of 2 of face should follow"),
        ("3 0 2 3\n", "3 0 2 3\n1 2 3\n", "5 bytes follow after the last of the stated records"),
        ("vertex 4", "vertex 4611686018427387904", "the file states 4611686018427387904 vertex records"),
        ("vertex 4", "vertex 18446744073709551615", "line 5: expected a count of records"),
    ] {
        let message = fault(&ASCII.replacen(from, to, 1));
        assert!(message.starts_with(expected), "{to:?}: {message}");
    }
}

#[test]
fn binary_files_are_refused_wherever_they_are_cut_off() {
    let bytes = binary(true, "double", "uchar", "uint");
    for end in 0..bytes.len() {
        assert!(parse(&bytes[..end]).is_err(), "cut at {end}");
    }
    let error = parse(&[bytes, vec![0; 9]].concat()).unwrap_err();
    assert_eq!(error.problem, Problem::TrailingBytes { bytes: 9, what: "records" });
}

#[test]
fn binary_faults_name_the_record() {
    let bytes = binary(false, "float", "uchar", "uchar");
    let face = [3, 0, 2, 3, 2];
    let at = bytes.windows(5).position(|w| w == face).unwrap();
    let mut wrong = bytes.clone();
    wrong[at + 3] = 4;
    let message = parse(&wrong).unwrap_err().to_string();
    assert_eq!(message, "face 1 (counted from 0): vertex 4 is named, but the vertices run from 0 to 3");
    wrong[at] = 255;
    let message = parse(&wrong).unwrap_err().to_string();
    assert!(message.starts_with("face 1 (counted from 0): the file states 255 items of a list"), "{message}");
}

#[test]
fn records_without_properties_take_no_time() {
    let text = ASCII.replace("end_header", "element nothing 4611686018427387904\nend_header");
    assert_eq!(parse(text.as_bytes()).unwrap().faces.len(), 2);
}
