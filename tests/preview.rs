//! The preview of real sheets: what it says, that it is sound SVG, and that it stays small.

use std::path::Path;

use kirimorph::fabrication::fabricate::{Fabrication, fabricate, ligament_lengths};
use kirimorph::fabrication::hinge_table::Verdict;
use kirimorph::geometry::mesh::TriMesh;
use kirimorph::geometry::{Point3, Vector2};
use kirimorph::output::Heading;
use kirimorph::output::preview::{self, Preview, WritePreviewError};
use svg::node::Attributes;
use svg::node::element::tag::Type;
use svg::parser::Event;

mod solve;

/// A spherical cap over a square of 120 mm, or the same seen from below.
fn cap(from_below: bool) -> TriMesh {
    const CELLS: usize = 12;
    let radius: f64 = 150.0;
    let at = |i: usize| 120.0 * i as f64 / CELLS as f64 - 60.0;
    let vertices = (0..=CELLS)
        .flat_map(|j| (0..=CELLS).map(move |i| (at(i), at(j))))
        .map(|(x, y)| Point3::new(x, y, (radius * radius - x * x - y * y).sqrt()))
        .collect();
    let mut faces = Vec::new();
    for (i, j) in (0..CELLS).flat_map(|j| (0..CELLS).map(move |i| (i, j))) {
        let [a, b] = [j * (CELLS + 1) + i, (j + 1) * (CELLS + 1) + i];
        faces.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
    }
    if from_below {
        faces.iter_mut().for_each(|face: &mut [usize; 3]| face.reverse());
    }
    TriMesh { vertices, faces }
}

fn sheet(mesh: &TriMesh) -> Fabrication {
    let profile = kirimorph::profile::load("steel-304-0.5mm", Path::new(".")).unwrap();
    let gap = profile.hinge_gap();
    let solved = solve::solve(mesh, [6, 6], [std::f64::consts::SQRT_2; 2], gap, |_| Vector2::x());
    let (design, _) = solved.measured(&solved.pattern);
    let lengths = ligament_lengths(&design, &profile).unwrap();
    fabricate(&design, &profile, &lengths).unwrap()
}

fn page(fabrication: &Fabrication) -> Result<String, WritePreviewError> {
    let figures = vec![("largest strain".to_string(), "39 % <of> \"all\"".to_string())];
    let profile = &kirimorph::profile::load("steel-304-0.5mm", Path::new(".")).unwrap();
    let name = "cap & <dome> \u{1} 'one'";
    let heading = Heading { name, target: "cap.obj", profile, figures: &figures };
    let preview = Preview { fabrication, heading, made_from: "cut cut.dxf", groove: "kerf" };
    let mut bytes = Vec::new();
    let result = preview::write(&preview, &mut bytes);
    assert!(result.is_ok() || bytes.is_empty(), "a refused sheet leaves nothing behind");
    result.map(|()| String::from_utf8(bytes).unwrap())
}

/// Element names with their attributes, and all texts.
fn parsed(page: &str) -> (Vec<(String, Attributes)>, Vec<String>) {
    let (mut elements, mut texts) = (Vec::new(), Vec::new());
    for event in svg::read(page).unwrap() {
        match event {
            Event::Tag(_, Type::End, _) => {}
            Event::Tag(name, _, attributes) => elements.push((name.to_string(), attributes)),
            Event::Text(text) => texts.push(text.to_string()),
            Event::Error(error) => panic!("{error}"),
            _ => {}
        }
    }
    (elements, texts)
}

/// The numbers of path data, and panics on anything else.
fn path_numbers(data: &str) -> Vec<f64> {
    let plain = |c: char| c.is_ascii_digit() || "MLhaZ ,.-".contains(c);
    assert!(data.chars().all(plain), "{data}");
    data.split(['M', 'L', 'h', 'a', 'Z', ' ', ','])
        .filter(|t| !t.is_empty())
        .map(|t| t.parse().unwrap())
        .collect()
}

#[test]
fn a_dome_is_drawn_with_all_its_pieces_cuts_and_hinges() {
    let fabrication = sheet(&cap(false));
    let page = page(&fabrication).unwrap();
    let (elements, texts) = parsed(&page);
    let get = |attributes: &Attributes, name: &str| attributes.get(name).map(|value| value.to_string());
    // Numbers: finite, without exponent, texts on the page.
    assert!(!page.contains("NaN") && !page.contains("inf"));
    let mut paths = 0;
    for (name, attributes) in &elements {
        if let Some(data) = get(attributes, "d") {
            assert!(path_numbers(&data).iter().all(|n| n.is_finite()));
            paths += 1;
        }
        if name == "text" {
            let [x, y]: [f64; 2] = ["x", "y"].map(|name| get(attributes, name).unwrap().parse().unwrap());
            assert!((0.0..=420.0).contains(&x) && (0.0..=297.0).contains(&y), "{x} {y}");
        }
    }
    assert!(paths > 2 * fabrication.design.pieces.len());
    // The most repetitions of a path letter in one path that is filled or stroked with a colour.
    let most = |paint: &str, colour: &str, letter: char| {
        let painted = elements.iter().filter(|(_, a)| get(a, paint).as_deref() == Some(colour));
        painted.filter_map(|(_, a)| get(a, "d")).map(|d| d.matches(letter).count()).max()
    };
    // On the sheet one path per tone holds the pieces of a turning sense: as many of each in a 6 x 6 chessboard.
    assert_eq!([most("fill", "#a8d0f0", 'Z'), most("fill", "#fada8c", 'Z')], [Some(18); 2]);
    // One path per kind of cut, one stroke per cut.
    assert_eq!(most("stroke", "#0072b2", 'M'), Some(fabrication.hinges.len()));
    // The words.
    let said = |text: &str| texts.iter().any(|t| t.trim().contains(text));
    assert!(said("THIS SIDE UP") && said("It ends CONVEX"));
    assert!(said("cap &amp; &lt;dome&gt;   'one'"), "the title is escaped, its control character a space");
    assert!(said("39 % &lt;of&gt;"));
    let ok = fabrication.hinges.iter().filter(|row| row.verdict == Verdict::Ok).count();
    assert!(said(&format!("hinges: {ok} ok, {} warn, 0 fail", fabrication.hinges.len() - ok)));
}

#[test]
fn the_same_sheet_gives_the_same_bytes_and_its_mirror_image_a_bowl() {
    let mut fabrication = sheet(&cap(true));
    let first = page(&fabrication).unwrap();
    assert_eq!(first, page(&fabrication.clone()).unwrap());
    assert!(first.contains("It ends CONCAVE"));
    // A failing hinge is named, with its reason, on the drawing and in the list.
    fabrication.hinges[17].verdict = Verdict::Fail;
    fabrication.hinges[17].reason = "because".into();
    let failing = page(&fabrication).unwrap();
    assert!(failing.contains("1 fail") && failing.contains("#17 at (") && failing.contains("fail: because"));
}

#[test]
fn damaged_sheets_are_refused() {
    let good = sheet(&cap(false));
    let refused = |damage: fn(&mut Fabrication)| {
        let mut bad = good.clone();
        damage(&mut bad);
        page(&bad).unwrap_err().to_string()
    };
    assert!(
        refused(|f| f.outlines[3][2][1] = f64::NAN).starts_with("piece 3 has a vertex that is not finite")
    );
    assert!(refused(|f| f.design.pieces[5].open[0].z = f64::INFINITY).starts_with("piece 5"));
    assert!(refused(|f| f.design.corners[7].x = f64::NAN).starts_with("corner 7"));
    assert!(refused(|f| f.design.hinges[4].pieces[1] = 1000).starts_with("hinge 4 joins"));
    assert!(refused(|f| f.hinges[2].id = 9999).starts_with("hinge 2"));
    assert!(refused(|f| f.hinges[2].width = f64::NAN).starts_with("hinge 2"));
    assert!(refused(|f| f.design.gap = f64::NAN).contains("gap"));
    assert!(refused(|f| _ = f.outlines.pop()).starts_with("the sheet has 35 outlines instead of 36"));
    assert!(refused(|f| _ = f.hinges.pop()).contains("rows of hinges"));
    assert!(refused(|f| f.layout.kerf = f64::NAN).contains("kerf"));
    assert!(refused(|f| f.layout.paths[0].vertices[0].point.x = f64::NAN).starts_with("cut 0"));
}

/// The first pieces of a sheet with the hinges between them.
fn first_pieces(sheet: &Fabrication, count: usize) -> Fabrication {
    let mut few = sheet.clone();
    few.design.pieces.truncate(count);
    few.outlines.truncate(count);
    few.design.hinges.retain(|hinge| hinge.pieces.iter().all(|&piece| piece < count));
    few.hinges.retain(|row| row.pieces.iter().all(|&piece| piece < count));
    for (id, row) in few.hinges.iter_mut().enumerate() {
        row.id = id;
    }
    few
}

#[test]
fn sheets_of_no_one_and_two_pieces_and_ligaments_of_no_size_are_drawn() {
    let sheet = sheet(&cap(false));
    let mut flat_ligaments = sheet.clone();
    flat_ligaments.layout.kerf = 0.0;
    flat_ligaments.design.gap = 0.0;
    flat_ligaments
        .hinges
        .iter_mut()
        .for_each(|row| (row.width, row.length, row.strain) = (0.0, 0.0, f64::NAN));
    let mut no_cuts = first_pieces(&sheet, 2);
    no_cuts.layout.paths.clear();
    let few = [0, 1, 2].map(|count| first_pieces(&sheet, count));
    assert_eq!(few.each_ref().map(|few| few.hinges.len()), [0, 0, 1]);
    for (fabrication, hinge) in
        few.iter().zip([false, false, true]).chain([(&flat_ligaments, true), (&no_cuts, true)])
    {
        let page = page(fabrication).unwrap();
        assert_eq!(page.contains("This sheet has no hinge"), !hinge);
        let (elements, _) = parsed(&page);
        let data = elements.iter().filter_map(|(_, attributes)| attributes.get("d"));
        assert!(data.flat_map(|d| path_numbers(d)).all(|n| n.is_finite()));
    }
}

/// The sheet beside itself `times` x `times`.
fn tiled(one: &Fabrication, times: usize) -> Fabrication {
    let mut all = one.clone();
    all.layout.paths.clear();
    all.layout.sheet = [120.0 * times as f64; 2];
    (all.outlines, all.hinges, all.design.corners, all.design.pieces, all.design.hinges) = Default::default();
    for tile in 0..times * times {
        let shift = kurbo::Vec2::new(115.0 * (tile % times) as f64, 115.0 * (tile / times) as f64);
        let in_space = kirimorph::geometry::Vector3::new(shift.x, shift.y, 0.0);
        let (corners, pieces, hinges) = (all.design.corners.len(), all.design.pieces.len(), all.hinges.len());
        all.design.corners.extend(one.design.corners.iter().map(|p| p + in_space));
        for piece in &one.design.pieces {
            let mut piece = piece.clone();
            piece.corners.iter_mut().for_each(|corner| *corner += corners);
            piece.closed.iter_mut().chain(&mut piece.open).for_each(|p| *p += in_space);
            all.design.pieces.push(piece);
        }
        for (hinge, row) in one.design.hinges.iter().zip(&one.hinges) {
            let (mut hinge, mut row) = (hinge.clone(), row.clone());
            hinge.pieces.iter_mut().chain(&mut row.pieces).for_each(|piece| *piece += pieces);
            hinge.point += in_space;
            row.point += in_space;
            row.id += hinges;
            all.design.hinges.push(hinge);
            all.hinges.push(row);
        }
        let moved =
            |outline: &Vec<[f64; 2]>| outline.iter().map(|[x, y]| [x + shift.x, y + shift.y]).collect();
        all.outlines.extend(one.outlines.iter().map(moved));
        for path in &one.layout.paths {
            let mut path = path.clone();
            path.vertices.iter_mut().for_each(|v| v.point += shift);
            all.layout.paths.push(path);
        }
    }
    all
}

#[test]
fn ten_thousand_pieces_stay_below_fifteen_megabytes_and_say_what_is_left_out() {
    let one = sheet(&cap(false));
    let many = tiled(&one, 17);
    assert_eq!(many.design.pieces.len(), 10_404);
    let large = page(&many).unwrap();
    assert!(large.len() < 15_000_000, "{}", large.len());
    assert!(large.contains("relief bars not drawn"));
    assert!(!page(&one).unwrap().contains("not drawn"));
    // Just below the limit everything is drawn, and that stays small too.
    let full = page(&tiled(&one, 9)).unwrap();
    assert!(full.len() < 15_000_000 && !full.contains("not drawn"), "{}", full.len());
}
