//! Pieces, stretches and openings.

use super::*;

#[test]
fn stretches_are_scaled_onto_the_condition_of_the_pattern() {
    let folder = Folder::new("stretch");
    for given in [[1.3, 1.5505], [1.4145, 1.4145], [1.4135, 1.4145], [0.8, 6.088]] {
        let job = folder.read(&with("stretches", &format!("stretches = {given:?}"))).unwrap();
        let [m1, m2] = job.pattern.stretches;
        // Two roundings each.
        assert!((1.0 / m1 + 1.0 / m2 - SQRT_2).abs() < 1e-15);
        // The ratio, which sets the sides of the rectangle, stays; the size moves by the tolerance at most.
        assert!((m1 / m2 - given[0] / given[1]).abs() < 1e-14);
        assert!((m1 / given[0] - 1.0).abs() <= 1e-3);
    }
}

#[test]
fn stretches_that_do_not_fit_get_the_one_that_does() {
    let folder = Folder::new("unfit");
    let found = folder.diagnostic(&with("stretches", "stretches = [1.3, 1.3]"));
    assert_eq!((found.line, found.column, found.key.as_str()), (10, 19, "pattern.stretches"));
    assert!(found.message.contains("1.5385"), "{found}");
    // 1 / (1.41421356 - 0.76923077) = 1 / 0.64498279 = 1.550429.
    assert_eq!(found.help, "with m1 = 1.3 take m2 = 1.5504");
    // 0.2 % off the condition is refused, 0.05 % is not: d(sum)/sum = (1/m2)/sqrt 2 * dm2/m2, 0.456 here.
    assert!(folder.read(&with("stretches", "stretches = [1.3, 1.5573]")).is_err());
    assert!(folder.read(&with("stretches", "stretches = [1.3, 1.5522]")).is_ok());
}

#[test]
fn a_variable_opening_has_its_own_weights_and_needs_an_open_target() {
    let folder = Folder::new("variable");
    let variable = with("opening", "opening = \"variable\"");
    let found = folder.diagnostic(&variable);
    assert!(found.message.contains("stretches do not go with"), "{found}");
    let variable: Vec<&str> = variable.lines().filter(|line| !line.starts_with("stretches")).collect();
    let variable = variable.join("\n");
    let job = folder.read(&variable).unwrap();
    assert_eq!(job.pattern.opening, Opening::Variable);
    assert_eq!((job.solver.stage2.geom, job.solver.stage3.fair, job.solver.stage3.opening), (0.0, 0.0, 0.0));
    let closing = variable
        .replace("open = \"roof.obj\"", "open = \"flat\"")
        .replace("closed = \"flat\"", "closed = \"roof.obj\"");
    assert!(folder.diagnostic(&closing).message.contains("not possible without an open target"));
}

#[test]
fn pieces_come_from_a_grid_or_from_a_mesh_file() {
    let folder = Folder::new("grids");
    let aligned = with("opening", "alignment = \"principal\"");
    assert_eq!(folder.read(&aligned).unwrap().pattern.grid, Grid::Aligned(PieceSize::Counts([30, 20])));
    let mesh = with("pieces", "control_mesh = \"roof.obj\"").replace("boundary = \"fixed-corners\"", "");
    let file = |reading, cuts| Grid::Mesh(PatternFile { path: folder.0.join("roof.obj"), reading, cuts });
    let control = Reading::ControlMesh { pieces_at: None };
    assert_eq!(folder.read(&mesh).unwrap().pattern.grid, file(control, Cuts::None));
    let mesh = mesh.replace("control_mesh", "piece_mesh");
    for (cuts, expected) in
        [("automatic", Cuts::Automatic), ("roof.obj", Cuts::File(folder.0.join("roof.obj")))]
    {
        let cut = mesh.replace("[target]", &format!("[target]\ncuts = \"{cuts}\""));
        assert_eq!(folder.read(&cut).unwrap().pattern.grid, file(Reading::Pieces, expected));
    }
    for (text, message) in [
        (with("opening", "control_mesh = \"roof.obj\""), "pieces does not go with a mesh of pieces"),
        (with("units", "cuts = \"automatic\""), "cuts need control_mesh or piece_mesh"),
        (
            format!("{}\n", mesh.replace("piece_mesh", "alignment = \"grid\"\npiece_mesh")),
            "alignment does not go",
        ),
        (
            mesh.replace("piece_mesh", "control_mesh = \"roof.obj\"\npiece_mesh"),
            "both control_mesh and piece_mesh",
        ),
        (with("opening", "alignment = \"radial\""), "\"grid\", \"principal\""),
        (
            mesh.replace("piece_mesh = \"roof.obj\"", "piece_mesh = \"none.obj\""),
            "not readable as a mesh file",
        ),
    ] {
        let found = folder.diagnostic(&text);
        assert!(found.message.contains(message), "{found}");
    }
}
