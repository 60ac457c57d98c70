//! Whatever a user hands in by mistake: exit status 1, a message that says what and where, and nothing left behind.

mod peers;
mod program;

use std::path::Path;

use program::{Mesh, STEEL, job, listing, run};

/// A fault: files to write, the job among them, and what the message must say.
struct Fault<'a> {
    /// Also the name of the test's folder.
    name: &'a str,
    /// Exit status.
    status: i32,
    files: Vec<(&'a str, Vec<u8>)>,
    says: &'a [&'a str],
}

/// Runs `make` on job.toml in a fresh folder that holds the fault's files. Nothing may change in that folder.
fn refuses(fault: &Fault) {
    let folder = peers::fresh_folder(&format!("bad-input-{}", fault.name));
    for (name, content) in &fault.files {
        std::fs::write(folder.join(name), content).unwrap();
    }
    refused(&folder, &["make", "job.toml"], fault.status, fault.says);
}

/// Runs the program, which must fail with this status and message and change nothing in its folder.
fn refused(folder: &Path, arguments: &[&str], status: i32, says: &[&str]) {
    let before = listing(folder);
    let run = run(folder, arguments);
    let shown = format!("{}: {arguments:?}: {run:?}", folder.display());
    assert_eq!(run.status, status, "{shown}");
    assert_eq!(run.stdout, "", "{shown}");
    let start = if status == 1 { "error: " } else { "refused: " };
    assert!(run.stderr.starts_with(start), "{shown}");
    for part in says {
        assert!(run.stderr.contains(part), "{part:?} is not in {shown}");
    }
    assert!(!run.stderr.contains("panicked"), "{shown}");
    assert!(listing(folder) == before, "files changed: {shown}");
    if std::env::var_os("SHOW_MESSAGES").is_some() {
        println!("{}", run.stderr);
    }
}

fn bump() -> Mesh {
    Mesh::bump([100.0, 80.0], 12.0, [8, 6])
}

/// A job on a target; 10 pieces a side.
fn job_on(target: &str) -> Vec<u8> {
    job(&format!("open = \"{target}\""), "pieces = [10, 8]", STEEL).into_bytes()
}

/// A mesh file that must be refused with status 1, by its name and with these words.
fn mesh_fault(name: &str, file: &str, content: impl Into<Vec<u8>>, says: &[&str]) {
    let says: Vec<&str> = says.iter().copied().chain([file]).collect();
    let files = vec![("job.toml", job_on(file)), (file, content.into())];
    refuses(&Fault { name, status: 1, files, says: &says });
}

/// A job file beside a sound target that must be refused with status 1 and these words.
fn job_fault(name: &str, content: impl Into<Vec<u8>>, says: &[&str]) {
    let says: Vec<&str> = says.iter().copied().chain(["job.toml"]).collect();
    let files = vec![("job.toml", content.into()), ("target.obj", bump().obj().into_bytes())];
    refuses(&Fault { name, status: 1, files, says: &says });
}

#[test]
fn a_sound_mesh_gives_the_same_pieces_in_every_format() {
    let folder = peers::fresh_folder("bad-input-formats");
    // Coordinates that single precision holds, since STL has no more.
    let mesh = bump().triangles().moved(|v| v.map(|c| f64::from(c as f32)));
    let files: [(&str, Vec<u8>); 5] = [
        ("mesh.obj", mesh.obj().into_bytes()),
        ("mesh.ply", mesh.ply().into_bytes()),
        ("text.stl", mesh.stl_text().into_bytes()),
        ("binary.STL", mesh.stl_bytes()),
        ("crlf.obj", mesh.obj().replace('\n', "\r\n").into_bytes()),
    ];
    let mut designs = Vec::new();
    for (name, content) in files {
        std::fs::write(folder.join(name), content).unwrap();
        std::fs::write(folder.join("job.toml"), job_on(name)).unwrap();
        designs.push(program::design(&program::made(&folder, "job.toml", &format!("out-{name}"))));
    }
    let [first, rest @ ..] = &designs[..] else { unreachable!() };
    assert_eq!(first["pieces"].as_array().unwrap().len(), 80);
    for other in rest {
        let difference =
            program::largest_difference(&program::coordinates(first), &program::coordinates(other));
        // The same points in another order: only sums round differently.
        assert!(difference <= 1e-6, "{difference:e} mm");
    }
}

#[test]
fn empty_mesh_files() {
    for file in ["empty.obj", "empty.stl", "empty.ply"] {
        mesh_fault(file, file, "", &["the file is empty"]);
    }
    mesh_fault("blank", "blank.obj", " \n\t\n", &["the file is empty"]);
    mesh_fault("comments", "comments.obj", "# nothing\n", &["no vertices"]);
}

#[test]
fn truncated_mesh_files() {
    let half = |mut bytes: Vec<u8>| {
        bytes.truncate(bytes.len() / 2);
        bytes
    };
    let mesh = bump().triangles();
    // Cut inside its faces an OBJ file is a smaller mesh; within its vertices it has no faces.
    let obj = mesh.obj();
    let cut = obj.find("f ").unwrap();
    mesh_fault("half-obj", "half.obj", &obj[..cut], &["no faces"]);
    mesh_fault("half-line", "line.obj", &obj[..cut - 30], &["line "]);
    mesh_fault("half-stl", "half.stl", half(mesh.stl_bytes()), &["triangles", "truncated"]);
    let text = mesh.stl_text();
    let end = text.match_indices("endloop").nth(40).unwrap().0;
    mesh_fault("half-text-stl", "text.stl", &text[..end], &["line ", "`endloop`", "truncated"]);
    mesh_fault("half-line-stl", "line.stl", half(text.into_bytes()), &["line "]);
    let ply = mesh.ply();
    let end = ply.match_indices('\n').nth(40).unwrap().0;
    mesh_fault("half-ply", "half.ply", &ply[..end], &["33 of 63", "truncated"]);
    mesh_fault("half-line-ply", "line.ply", half(ply.into_bytes()), &["line "]);
}

#[test]
fn numbers_and_indices_that_are_wrong() {
    let obj = bump().obj();
    let with = |find: &str, replace: &str| obj.replacen(find, replace, 1);
    mesh_fault("nan", "nan.obj", with("v -50.0", "v nan"), &["line 1", "not finite"]);
    mesh_fault("infinite", "infinite.obj", with("v -50.0", "v 1e999"), &["line 1", "not finite"]);
    mesh_fault("comma", "comma.obj", with("v -50.0", "v -50,0"), &["line 1", "-50,0", "not a number"]);
    mesh_fault("far", "far.obj", with("v -50.0", "v -5e200"), &["line 1", "beyond the limit"]);
    mesh_fault("range", "range.obj", with("f 1 ", "f 64 "), &["line 64", "vertex 64", "1 to 63"]);
    mesh_fault("zero", "zero.obj", with("f 1 ", "f 0 "), &["line 64", "vertex 0"]);
    mesh_fault("back", "back.obj", with("f 1 ", "f -64 "), &["line 64", "-64"]);
    let ply = bump().ply().replacen("\n4 0 1", "\n4 0 6300", 1);
    mesh_fault("ply-range", "range.ply", ply, &["line 73", "6300"]);
    let mut stl = bump().triangles().stl_bytes();
    stl[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    mesh_fault("stl-nan", "nan.stl", stl, &["triangle 1", "not finite"]);
}

#[test]
fn counts_that_no_memory_holds() {
    let ply = bump().ply().replacen("vertex 63", "vertex 99999999999", 1);
    mesh_fault("huge-ply", "huge.ply", ply, &["99999999999"]);
    let binary = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\n\
                  property double y\nproperty double z\nelement face 4000000000\n\
                  property list uint int vertex_indices\nend_header\n";
    mesh_fault("huge-binary-ply", "huge.ply", binary, &["4000000000", "ends too early"]);
    let mut stl = bump().triangles().stl_bytes();
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    mesh_fault("huge-stl", "huge.stl", stl, &["4294967295", "ends too early"]);
}

#[test]
fn meshes_that_are_no_surface() {
    let sound = bump();
    let with = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = sound.clone();
        change(&mut mesh);
        mesh.obj()
    };
    let branching = with(&|mesh| {
        mesh.vertices.push([0.0, 0.0, 60.0]);
        mesh.faces.push(vec![30, 31, 63]);
    });
    mesh_fault("branching", "branching.obj", branching, &["3 faces", "share the edge from vertex 31 to 32"]);
    let turned = with(&|mesh| mesh.faces[20].reverse());
    mesh_fault("turned", "turned.obj", turned, &["face 21", "wound the wrong way"]);
    let two = with(&|mesh| {
        let other = bump().moved(|[x, y, z]| [x + 200.0, y, z]);
        mesh.faces.extend(other.faces.iter().map(|face| face.iter().map(|v| v + 63).collect()));
        mesh.vertices.extend(other.vertices);
    });
    mesh_fault("two", "two.obj", two, &["2 components", "48 and 48"]);
    let flat = with(&|mesh| mesh.vertices[12] = mesh.vertices[11]);
    refuses_somehow("double-vertex", flat);
    let point = with(&|mesh| mesh.vertices.iter_mut().for_each(|v| *v = [1.0, 2.0, 3.0]));
    mesh_fault("point", "point.obj", point, &["face 1", "no area"]);
}

/// A mesh with a fault that some stage must find.
fn refuses_somehow(name: &str, content: String) {
    let folder = peers::fresh_folder(&format!("bad-input-{name}"));
    std::fs::write(folder.join("job.toml"), job_on("target.obj")).unwrap();
    std::fs::write(folder.join("target.obj"), content).unwrap();
    let run = run(&folder, ["make", "job.toml"]);
    assert!([1, 2].contains(&run.status) && run.stderr.contains("target.obj"), "{run:?}");
}

#[test]
fn files_that_are_missing_or_something_else() {
    job_fault("no-mesh", job_on("missing.obj"), &["job.toml:2", "missing.obj", "No such file"]);
    mesh_fault("ending", "mesh.step", "ISO-10303-21;", &[".obj, .stl, .ply"]);
    mesh_fault("junk", "junk.obj", [0xff, 0xfe, 0x00, 0x80].repeat(50), &[]);
    let folder = peers::fresh_folder("bad-input-folders");
    std::fs::create_dir(folder.join("folder.obj")).unwrap();
    std::fs::create_dir(folder.join("folder.toml")).unwrap();
    std::fs::write(folder.join("job.toml"), job_on("folder.obj")).unwrap();
    refused(&folder, &["make", "job.toml"], 1, &["folder.obj", "directory"]);
    refused(&folder, &["make", "folder.toml"], 1, &["folder.toml"]);
    refused(&folder, &["make", "none.toml"], 1, &["none.toml", "No such file"]);
}

#[test]
fn job_files_that_break_a_rule() {
    let sound = String::from_utf8(job_on("target.obj")).unwrap();
    let with = |find: &str, replace: &str| {
        assert!(sound.contains(find));
        sound.replacen(find, replace, 1)
    };
    job_fault("empty-job", "", &["target"]);
    job_fault("binary-job", [0xff, 0x00, 0x9c, 0x1b].repeat(64), &["UTF-8"]);
    job_fault("unknown-key", with("kind", "colour = 3\nkind"), &["job.toml:6", "colour"]);
    job_fault("syntax", with("closed =", "closed"), &["job.toml:3"]);
    job_fault("nan", with("[pattern]", "size_mm = nan\n[pattern]"), &["job.toml:5", "nan"]);
    job_fault("infinite", with("[pattern]", "size_mm = inf\n[pattern]"), &["job.toml:5", "inf"]);
    job_fault(
        "tiny",
        with("[pattern]", "size_mm = 1e-3\n[pattern]"),
        &["job.toml:5", "1e-3", "1 to 10000 mm"],
    );
    job_fault("profile", with("steel-304-0.5mm", "steal"), &["steal", "steel-304-0.5mm"]);
    job_fault("profile-file", with("steel-304-0.5mm", "mine.toml"), &["mine.toml", "No such file"]);
    job_fault("units", with("[pattern]", "units = \"feet\"\n[pattern]"), &["feet", "\"in\""]);
    job_fault("counts", with("[10, 8]", "[10]"), &["job.toml:7", "1 value"]);
    job_fault("none", with("[10, 8]", "[0, -8]"), &["job.toml:7"]);
    job_fault("million", with("[10, 8]", "[1000000, 1]"), &["job.toml:7", "2000"]);
    // A thousand by a thousand is within each limit, but the pieces are too small for a hinge: sound input, not makeable.
    let files = vec![
        ("job.toml", with("[10, 8]", "[1000, 1000]").into_bytes()),
        ("target.obj", bump().obj().into_bytes()),
    ];
    refuses(&Fault { name: "many", status: 2, files, says: &["too small for hinges", "larger pieces"] });
}

#[test]
fn more_pieces_than_memory_holds() {
    let target = "open = \"target.obj\"\nsize_mm = 10000.0";
    let files = vec![
        ("job.toml", job(target, "piece_mm = 5.0", STEEL).into_bytes()),
        ("target.obj", bump().obj().into_bytes()),
    ];
    refuses(&Fault { name: "much", status: 1, files, says: &["pieces, more than 1000000", "larger pieces"] });
}

#[test]
fn profile_files_that_break_a_rule() {
    let steel =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/steel-304-0.5mm.toml"))
            .unwrap();
    let line = 1 + steel.lines().position(|line| line.starts_with("kerf_mm")).unwrap();
    let place = format!("mine.toml:{line}");
    for (name, value) in [("nan", "nan"), ("negative", "-0.05"), ("text", "\"thin\"")] {
        let profile = steel.replacen("kerf_mm = 0.05", &format!("kerf_mm = {value}"), 1);
        assert_ne!(profile, steel);
        let target = "open = \"target.obj\"";
        let files = vec![
            ("job.toml", job(target, "pieces = [10, 8]", "profile = \"mine.toml\"").into_bytes()),
            ("target.obj", bump().obj().into_bytes()),
            ("mine.toml", profile.into_bytes()),
        ];
        let name = format!("profile-{name}");
        refuses(&Fault { name: &name, status: 1, files, says: &[&place, "kerf_mm"] });
    }
}

#[test]
fn output_folders_that_are_taken() {
    let folder = peers::fresh_folder("bad-input-output");
    std::fs::write(folder.join("job.toml"), job_on("target.obj")).unwrap();
    std::fs::write(folder.join("target.obj"), bump().obj()).unwrap();
    std::fs::write(folder.join("file"), "mine").unwrap();
    std::fs::create_dir(folder.join("full")).unwrap();
    std::fs::write(folder.join("full/thesis.txt"), "mine").unwrap();
    std::fs::write(folder.join("full/cut.dxf"), "mine too").unwrap();
    refused(&folder, &["make", "job.toml", "-o", "file"], 1, &["file", "-o"]);
    refused(&folder, &["make", "job.toml", "-o", "full"], 1, &["full", "thesis.txt", "-o"]);
    refused(&folder, &["make", "job.toml", "-o", "file/below"], 1, &["file/below"]);
    refused(&folder, &["make", "job.toml", "-o", "."], 1, &["-o"]);
    refused(&folder, &["make", "job.toml", "-o", ""], 1, &[]);
    refused(&folder, &["make", "job.toml", "-o", "/"], 1, &["/"]);
}

/// Whoever may do everything writes into read-only folders too; then this says nothing.
#[cfg(unix)]
#[test]
fn a_folder_that_must_not_be_written() {
    use std::fs::Permissions;
    use std::os::unix::fs::PermissionsExt;

    let folder = peers::fresh_folder("bad-input-read-only");
    let locked = folder.join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::write(folder.join("job.toml"), job_on("target.obj")).unwrap();
    std::fs::write(folder.join("target.obj"), bump().obj()).unwrap();
    std::fs::set_permissions(&locked, Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        eprintln!("skipped: this user may write everywhere");
        std::fs::remove_file(locked.join("probe")).unwrap();
    } else {
        refused(&folder, &["make", "job.toml", "-o", "locked/out"], 1, &["locked/out", "ermission"]);
    }
    std::fs::set_permissions(&locked, Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn odd_names_are_no_fault() {
    let folder = peers::fresh_folder("bad-input-odd-names");
    std::fs::write(folder.join("target.obj"), bump().obj()).unwrap();
    let names = [
        "two words",
        "it's \"mine\"",
        "K\u{fc}hlh\u{e4}lfte",
        "100%20 <&> $HOME",
        "new\nline",
        "-dash",
        "a]]>b--c",
    ];
    for name in names {
        let file = format!("{name}.toml");
        std::fs::write(folder.join(&file), job_on("target.obj")).unwrap();
        let run = run(&folder, ["make", "--", &file]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{name:?}");
        let out = folder.join("out").join(name);
        assert_eq!(program::design(&out)["report"]["job"], name);
        let svgs = [out.join("cut.svg"), out.join("preview.svg")];
        let burned = [&out.join("cut.dxf"), &out.join("hinges.json"), &out.join("design.json")];
        let [dxf, hinges, design] = burned;
        program::asked(peers::oracle("burn.py"), &[dxf, hinges, design]);
        program::asked(peers::oracle("cut_summary.py"), &[&svgs[0]]);
        let target = folder.join("target.obj");
        program::asked(peers::oracle("made_folder.py"), &[&out, &target, &"--scale", &"1"]);
    }
    let mut made: Vec<_> =
        std::fs::read_dir(folder.join("out")).unwrap().map(|e| e.unwrap().file_name()).collect();
    let mut wanted = names.to_vec();
    made.sort();
    wanted.sort_unstable();
    assert_eq!(made, wanted, "nothing else is left");
}
