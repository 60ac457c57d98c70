//! The page of a design that is flat in neither state: both states in space, what the hinges are like, and that there is
//! no cut file.

use std::io::Write;

use kurbo::{Point, Rect};
use svg::node::element::Group;

use super::opening::senses;
use super::page::{self, Sense, shortened, text, wrapped};
use super::space::{Body, extents, slanting, top};
use super::{DETAILED_PIECES, WritePreviewError, check_design, empty_page, header, tables, worst};
use crate::fabrication::product::Assembly;
use crate::geometry::plane::doubled_area;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, State};
use crate::output::Heading;

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct AssemblyPreview<'a> {
    /// Pieces and hinges.
    pub assembly: &'a Assembly,
    /// What it is called, and its figures.
    pub heading: Heading<'a>,
    /// Why there is no cut file, in a sentence or two.
    pub remark: &'a str,
}

const STATES: [Rect; 2] = [Rect::new(8.0, 24.0, 208.0, 206.0), Rect::new(212.0, 24.0, 412.0, 206.0)];
const LEGEND: Rect = Rect::new(8.0, 210.0, 82.0, 290.0);
const REMARK: Rect = Rect::new(86.0, 210.0, 178.0, 290.0);
const FIGURES: Rect = Rect::new(182.0, 210.0, 296.0, 290.0);
const HINGES: Rect = Rect::new(300.0, 210.0, 412.0, 290.0);

/// Writes the page.
///
/// # Errors
/// A fault of the design or its hinges, before anything is written, or the error of `out`.
pub fn write<W: Write>(preview: &AssemblyPreview<'_>, mut out: W) -> Result<(), WritePreviewError> {
    let Assembly { design, hinges } = preview.assembly;
    check_design(design, hinges)?;
    let heading = preview.heading;
    let subtitle = format!(
        "targets {}   |   profile {}   |   no flat state: nothing to cut from a sheet",
        heading.target, heading.profile.name
    );
    let turns = senses(design, &normals(design, State::Closed));
    let document = empty_page(heading.name)
        .add(header(heading.name, &subtitle, hinges))
        .add(state_panel(design, State::Closed, &turns))
        .add(state_panel(design, State::Open, &turns))
        .add(legend(preview.assembly, &turns))
        .add(remark(preview.remark))
        .add(tables::figures(heading.figures, FIGURES))
        .add(tables::hinges(hinges, &worst(hinges), HINGES));
    ::svg::write(&mut out, &document)?;
    out.write_all(b"\n")?;
    Ok(out.flush()?)
}

/// The unit normals of the pieces in a state.
pub(in crate::output) fn normals(design: &Design, state: State) -> Vec<Vector3> {
    let normal = |polygon: &[Point3]| doubled_area(polygon).try_normalize(0.0).unwrap_or_else(Vector3::z);
    design.pieces.iter().map(|piece| normal(piece.vertices(state))).collect()
}

/// The mean normal is up; x is that of the target's file as far as it lies across.
pub(in crate::output) fn frame(normals: &[Vector3]) -> [Vector3; 3] {
    let up = normals.iter().sum::<Vector3>().try_normalize(1e-9).unwrap_or_else(Vector3::z);
    let across = |v: Vector3| (v - up * v.dot(&up)).try_normalize(1e-3);
    let right = across(Vector3::x()).or_else(|| across(Vector3::y())).unwrap_or_else(Vector3::x);
    [right, up.cross(&right), up]
}

fn state_panel(design: &Design, state: State, senses: &[Sense]) -> Group {
    let (heading, name, area) = match state {
        State::Closed => ("1  Closed: the upper side seen from above", "closed", STATES[0]),
        State::Open => ("2  Open: the upper side seen from above", "open", STATES[1]),
    };
    let normals = normals(design, state);
    let body = Body {
        faces: design.pieces.iter().map(|piece| piece.vertices(state).to_vec()).collect(),
        frame: frame(&normals),
        normals,
        senses,
        outlined: design.pieces.len() <= DETAILED_PIECES,
    };
    let views = Rect::new(area.x0 + 3.0, area.y0 + 9.0, area.x1 - 3.0, area.y1 - 8.0);
    let split = views.y0 + 0.56 * views.height();
    let caption = Point::new(area.x0 + 2.0, area.y1 - 2.5);
    page::panel(area, heading)
        .add(slanting(&body, Rect { y1: split - 2.0, ..views }))
        .add(top(&body, Rect { y0: split + 2.0, ..views }))
        .add(text(caption, 3.2, &format!("{name} {}; below: straight from above", extents(&body))))
}

fn legend(assembly: &Assembly, senses: &[Sense]) -> Group {
    let inner = |y0: f64| Rect { x0: LEGEND.x0 + 2.0, y0, ..LEGEND };
    page::panel(LEGEND, "3  Tones and signs")
        .add(tables::piece_legend("opens", senses, inner(LEGEND.y0 + 9.0)))
        .add(tables::hinge_legend(&assembly.hinges, inner(LEGEND.y0 + 40.0)))
}

fn remark(content: &str) -> Group {
    let mut group = page::panel(REMARK, "No flat state, no cut file");
    let (size, pitch) = (3.6, 5.2);
    let most = ((REMARK.height() - 12.0) / pitch) as usize;
    for (i, line) in wrapped(content, size, REMARK.width() - 5.0).into_iter().take(most).enumerate() {
        let at = Point::new(REMARK.x0 + 2.0, REMARK.y0 + 12.0 + pitch * i as f64);
        group = group.add(text(at, size, &shortened(&line, size, REMARK.width() - 4.0)));
    }
    group
}
