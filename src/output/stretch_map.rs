//! The feasibility map: one A3 landscape page, SVG or HTML, that shows where a target asks for how much
//! stretch.
//!
//! Left the flattened target, right the target itself in an oblique view, both coloured by the opening asked
//! for in parts of the full one; below the scale and the figures. Page coordinates are millimetres, y down.
//! The same input gives the same bytes.

use std::io::{self, Write};

use kurbo::{Affine, Point, Rect};
use svg::Document;
use svg::node::element::{Circle, Group, Title};

use super::plain_line;
use super::preview::page::{self, PAGE, fixed, number, text, text_with_halo};
use crate::geometry::mesh::TriMesh;
use crate::geometry::{Point2, Point3};

mod paint;

use paint::{CLASSES, COARSE, Detail, FINE, HATCH, class_colour, class_limits, hatch, hatching, paint};

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct StretchMap<'a> {
    /// The job's name and the verdict, for the heading.
    pub title: &'a str,
    /// The target, millimetres.
    pub mesh: &'a TriMesh,
    /// #V points of its flattening.
    pub flat: &'a [Point2],
    /// #F openings asked for, in parts of the full one.
    pub openings: &'a [f64],
    /// #F whether the pattern's model does not reach the triangle.
    pub beyond: &'a [bool],
    /// The triangle to mark.
    pub worst: usize,
    /// Figures: label and value with its unit.
    pub figures: &'a [(String, String)],
}

const FLAT: Rect = Rect::new(8.0, 22.0, 240.0, 240.0);
const SPACE: Rect = Rect::new(246.0, 22.0, 412.0, 175.0);
const FIGURES: Rect = Rect::new(246.0, 180.0, 412.0, 290.0);
const SCALE: Rect = Rect::new(8.0, 246.0, 240.0, 290.0);

/// Writes the map as an SVG file.
///
/// # Errors
/// Those of `out`.
pub fn write_svg<W: Write>(map: &StretchMap, mut out: W) -> io::Result<()> {
    let [width, height] = PAGE.map(|length| number(length, 0));
    let document = Document::new()
        .set("width", format!("{width}mm"))
        .set("height", format!("{height}mm"))
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("font-family", "sans-serif")
        .add(Title::new(plain_line(map.title)))
        .add(page::rectangle(Rect::new(0.0, 0.0, PAGE[0], PAGE[1]), "#ffffff"))
        .add(
            text(Point::new(8.0, 14.0), 8.0, &page::shortened(map.title, page::BOLD * 8.0, 400.0))
                .set("font-weight", "bold"),
        )
        .add(body(map, FINE));
    svg::write(&mut out, &document)?;
    writeln!(out)
}

/// Writes the map as a figure for a page: without heading and size, and coarse enough to be small.
///
/// # Errors
/// Those of `out`.
pub fn write_figure<W: Write>(map: &StretchMap, out: W) -> io::Result<()> {
    let [left, top] = [FLAT.x0 - 2.0, FLAT.y0 - 2.0];
    let shown = [left, top, PAGE[0] - 2.0 * left, FIGURES.y1 + 2.0 - top].map(|length| number(length, 0));
    let document = Document::new()
        .set("viewBox", shown.join(" "))
        .set("font-family", "sans-serif")
        .add(page::rectangle(Rect::new(0.0, 0.0, PAGE[0], PAGE[1]), "#ffffff"))
        .add(body(map, COARSE));
    svg::write(out, &document)
}

fn body(map: &StretchMap, detail: Detail) -> Group {
    Group::new()
        .add(hatching())
        .add(flat_view(map, detail))
        .add(space_view(map, detail))
        .add(scale_bar())
        .add(figures(map.figures))
}

/// Writes the map as an HTML page: the drawing and the figures as a table.
///
/// # Errors
/// Those of `out`.
pub fn write_html<W: Write>(map: &StretchMap, mut out: W) -> io::Result<()> {
    let escaped =
        |text: &str| plain_line(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let title = escaped(map.title);
    writeln!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>{title}</title>"
    )?;
    writeln!(out, "<style>body{{font-family:sans-serif;margin:1em}}svg{{width:100%;height:auto}}")?;
    writeln!(out, "td{{padding:0.1em 1em 0.1em 0}}</style></head><body><h1>{title}</h1>")?;
    write_svg(map, &mut out)?;
    writeln!(out, "<table>")?;
    for (label, value) in map.figures {
        writeln!(out, "<tr><td>{}</td><td>{}</td></tr>", escaped(label), escaped(value))?;
    }
    writeln!(out, "</table></body></html>")
}

fn flat_view(map: &StretchMap, detail: Detail) -> Group {
    let points: Vec<Point> = map.flat.iter().map(|p| Point::new(p.x, p.y)).collect();
    let depths = vec![0.0; map.mesh.faces.len()];
    let (view, to_page) = view((map, detail), FLAT, "The target laid flat", &points, &depths);
    let triangles: Vec<[Point; 3]> =
        map.mesh.faces.iter().map(|face| face.map(|v| to_page * points[v])).collect();
    view.add(hatch(&triangles, map.beyond, detail)).add(length_bar(to_page))
}

/// The target seen from the front, from above: x to the right, y into the page.
fn space_view(map: &StretchMap, detail: Detail) -> Group {
    let (elevation, turn) = (35.0_f64.to_radians(), 30.0_f64.to_radians());
    let seen = |p: &Point3| {
        let across = p.x * turn.cos() - p.y * turn.sin();
        let away = p.x * turn.sin() + p.y * turn.cos();
        let up = away * elevation.sin() + p.z * elevation.cos();
        (Point::new(across, up), away * elevation.cos() - p.z * elevation.sin())
    };
    let seen: Vec<(Point, f64)> = map.mesh.vertices.iter().map(seen).collect();
    let points: Vec<Point> = seen.iter().map(|(point, _)| *point).collect();
    let depth = |face: &[usize; 3]| face.iter().map(|&v| seen[v].1).sum::<f64>();
    let depths: Vec<f64> = map.mesh.faces.iter().map(depth).collect();
    view((map, detail), SPACE, "The target", &points, &depths).0
}

/// A panel with the coloured triangles and the mark; returns also the map from the points to the page.
fn view(
    (map, detail): (&StretchMap, Detail),
    area: Rect,
    heading: &str,
    points: &[Point],
    depths: &[f64],
) -> (Group, Affine) {
    let room = Rect::new(area.x0 + 4.0, area.y0 + 10.0, area.x1 - 4.0, area.y1 - 12.0);
    let to_page = page::fit(page::bounds(points.iter().copied()), room);
    let triangles: Vec<[Point; 3]> =
        map.mesh.faces.iter().map(|face| face.map(|v| to_page * points[v])).collect();
    let [a, b, c] = triangles[map.worst];
    let worst = ((a.to_vec2() + b.to_vec2() + c.to_vec2()) / 3.0).to_point();
    let ring = |colour: &str, width: f64| {
        Circle::new()
            .set("cx", number(worst.x, 2))
            .set("cy", number(worst.y, 2))
            .set("r", "3")
            .set("fill", "none")
            .set("stroke", colour)
            .set("stroke-width", number(width, 2))
    };
    // The label stays inside the panel.
    let anchor = if worst.x > area.center().x { "end" } else { "start" };
    let side = if anchor == "end" { -4.5 } else { 4.5 };
    let group = page::panel(area, heading)
        .add(paint(&triangles, depths, map.openings, detail))
        .add(ring("#ffffff", 1.4))
        .add(ring("#000000", 0.6))
        .add(text_with_halo(Point::new(worst.x + side, worst.y + 1.4), 4.0, "worst", anchor));
    (group, to_page)
}

/// A bar of a round length at the foot of the flat view.
fn length_bar(to_page: Affine) -> Group {
    let scale = page::scale_of(to_page);
    let most = 60.0 / scale;
    let power = 10.0_f64.powf(most.log10().floor());
    let length = [5.0, 2.0, 1.0].map(|step| step * power).into_iter().find(|&l| l <= most).unwrap_or(power);
    let from = Point::new(FLAT.x0 + 4.0, FLAT.y1 - 4.0);
    let to = Point::new(from.x + scale * length, from.y);
    Group::new().add(page::dimension(from, to)).add(text(
        Point::new(to.x + 2.0, to.y + 1.2),
        3.6,
        &format!("{length} mm on the flattening"),
    ))
}

fn scale_bar() -> Group {
    let heading = "Opening asked for, in parts of the full one (1/m1 + 1/m2 = sqrt 2)";
    let mut group = page::panel(SCALE, heading);
    let width = (SCALE.width() - 20.0) / CLASSES as f64;
    let left = |class: usize| SCALE.x0 + 10.0 + width * class as f64;
    for class in 0..CLASSES {
        let area = Rect::new(left(class), SCALE.y0 + 9.0, left(class + 1), SCALE.y0 + 19.0);
        group = group.add(page::rectangle(area, &class_colour(class)));
    }
    for class in (0..=CLASSES).step_by(CLASSES / 8) {
        let label = fixed(class_limits(class), 2);
        let at = Point::new(left(class), SCALE.y0 + 24.0);
        group = group.add(text(at, 3.6, &label).set("text-anchor", "middle"));
    }
    let remarks = [
        "Purple: pieces open less than fully, down to 0.71 (closed). Orange: more than the full opening gives.",
        "Hatched above: out of reach of turning rectangles. A prediction: the measured result decides.",
    ];
    let swatch = Rect::new(SCALE.x1 - 26.0, SCALE.y0 + 34.0, SCALE.x1 - 10.0, SCALE.y0 + 40.0);
    group = group.add(page::rectangle(swatch, HATCH).set("stroke", page::GREY).set("stroke-width", "0.2"));
    for (i, remark) in remarks.iter().enumerate() {
        group = group.add(text(Point::new(SCALE.x0 + 3.0, SCALE.y0 + 32.0 + 6.0 * i as f64), 3.6, remark));
    }
    group
}

fn figures(rows: &[(String, String)]) -> Group {
    let mut group = page::panel(FIGURES, "Figures");
    for (i, (label, value)) in rows.iter().enumerate() {
        let y = FIGURES.y0 + 13.0 + 7.5 * i as f64;
        let value = page::shortened(value, 4.0, 92.0);
        group = group.add(text(Point::new(FIGURES.x0 + 3.0, y), 4.0, label)).add(text(
            Point::new(FIGURES.x0 + 70.0, y),
            4.0,
            &value,
        ));
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat sheet of `n` by `n` squares.
    fn sheet(n: usize) -> (TriMesh, Vec<Point2>) {
        let flat: Vec<Point2> =
            (0..=n).flat_map(|j| (0..=n).map(move |i| Point2::new(i as f64, j as f64))).collect();
        let faces = (0..n)
            .flat_map(|j| (0..n).map(move |i| j * (n + 1) + i))
            .flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]])
            .collect();
        (TriMesh { vertices: flat.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect(), faces }, flat)
    }

    #[test]
    fn large_maps_stay_small_and_names_are_escaped() {
        for (n, limit) in [(4, 40_000), (230, 5_000_000)] {
            let (mesh, flat) = sheet(n);
            let openings: Vec<f64> = (0..mesh.faces.len()).map(|i| 0.6 + (i % 97) as f64 / 97.0).collect();
            let beyond: Vec<bool> = (0..mesh.faces.len()).map(|i| i % 5 < 2).collect();
            let figures = [("a <b>".to_owned(), "1 & 2".to_owned())];
            let map = StretchMap {
                title: "<x>",
                mesh: &mesh,
                flat: &flat,
                openings: &openings,
                beyond: &beyond,
                worst: 3,
                figures: &figures,
            };
            let mut svg = Vec::new();
            write_svg(&map, &mut svg).unwrap();
            assert!(svg.len() < limit, "{n}: {}", svg.len());
            let mut html = Vec::new();
            write_html(&map, &mut html).unwrap();
            let html = String::from_utf8(html).unwrap();
            assert!(html.contains("a &lt;b&gt;") && !html.contains("<x>") && !html.contains("NaN"));
        }
    }
}
