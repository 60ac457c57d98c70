//! The picture of a snap: the sheet's energy over the share of its turns, and the mean cell's torque beside it.
//!
//! Page coordinates are millimetres, y down. The same input gives the same bytes.

use std::io::{self, Write};

use kurbo::{Point, Rect};
use svg::Document;
use svg::node::element::{Group, Title};

use crate::output::preview::page::{self, BORDER, GREY, LIGAMENT, SLIT, number, text};
use crate::snap::assess::Snap;

const PAGE: [f64; 2] = [240.0, 100.0];
const ENERGY: Rect = Rect::new(22.0, 20.0, 114.0, 84.0);
const TORQUE: Rect = Rect::new(140.0, 20.0, 232.0, 84.0);
/// Marks along each axis, at least.
const MARKS: f64 = 4.0;

/// One curve: points and colour.
type Curve = (Vec<[f64; 2]>, &'static str);

/// Writes the picture of a snap with this title.
///
/// # Errors
/// Those of `out`.
pub fn write_plot<W: Write>(snap: &Snap, title: &str, mut out: W) -> io::Result<()> {
    let [width, height] = PAGE.map(|length| number(length, 0));
    let line = |samples: &[crate::snap::sheet::Sample]| -> Vec<[f64; 2]> {
        samples.iter().map(|s| [100.0 * s.share, s.energy]).collect()
    };
    let sheet = &snap.sheet;
    let energies: [Curve; 2] = [(line(&sheet.path), SLIT), (line(&sheet.back), LIGAMENT)];
    let mut document = Document::new()
        .set("width", format!("{width}mm"))
        .set("height", format!("{height}mm"))
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("font-family", "sans-serif")
        .add(Title::new(crate::output::plain_line(title)))
        .add(page::rectangle(Rect::new(0.0, 0.0, PAGE[0], PAGE[1]), "#ffffff"))
        .add(text(Point::new(8.0, 9.0), 5.0, title).set("font-weight", "bold"))
        .add(chart(ENERGY, &energies, ["% of the hinges' turns", "mJ, whole sheet, elastic"]));
    if let Some(cell) = &snap.cell {
        let passage = &cell.passage;
        let step = 2.0 * cell.cell.phi.to_degrees() / passage.torques.len() as f64;
        let points = passage.torques.iter().enumerate().map(|(i, &t)| [step * (i + 1) as f64, t]);
        let curve = (std::iter::once([0.0, 0.0]).chain(points).collect(), SLIT);
        document = document.add(chart(
            TORQUE,
            &[curve],
            ["degrees of the rectangle", "N mm against the mean cell's turn, yielding"],
        ));
    }
    svg::write(&mut out, &document)?;
    writeln!(out)
}

/// Curves in a frame whose axes include zero.
fn chart(frame: Rect, curves: &[Curve], labels: [&str; 2]) -> Group {
    let range = |axis: usize| {
        let values = curves.iter().flat_map(|(points, _)| points.iter().map(move |p| p[axis]));
        let (low, high) = values.fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
        [low, if high > low { high } else { low + 1.0 }]
    };
    let [[x0, x1], [y0, y1]] = [range(0), range(1)];
    let at = |[x, y]: [f64; 2]| {
        Point::new(
            frame.x0 + frame.width() * (x - x0) / (x1 - x0),
            frame.y1 - frame.height() * (y - y0) / (y1 - y0),
        )
    };
    let mut group = Group::new()
        .add(page::segment(at([x0, 0.0]), at([x1, 0.0]), GREY, 0.2))
        .add(page::segment(at([0.0, y0]), at([0.0, y1]), GREY, 0.2))
        .add(text(Point::new(frame.x0, frame.y0 - 4.0), 3.2, labels[1]))
        .add(text(Point::new(frame.x1, frame.y1 + 11.0), 3.2, labels[0]).set("text-anchor", "end"));
    for x in marks(x0, x1) {
        let foot = Point::new(at([x, y0]).x, frame.y1);
        group = group
            .add(page::segment(foot, foot + kurbo::Vec2::new(0.0, 1.5), BORDER, 0.2))
            .add(text(foot + kurbo::Vec2::new(0.0, 5.5), 3.0, &number(x, 6)).set("text-anchor", "middle"));
    }
    for y in marks(y0, y1) {
        let left = Point::new(frame.x0, at([x0, y]).y);
        group = group
            .add(page::segment(left, left - kurbo::Vec2::new(1.5, 0.0), BORDER, 0.2))
            .add(text(left + kurbo::Vec2::new(-2.5, 1.0), 3.0, &number(y, 6)).set("text-anchor", "end"));
    }
    for (points, colour) in curves {
        let mut data = String::new();
        page::push_polyline(&mut data, points.iter().map(|p| at(*p)), false, 2);
        group = group.add(page::stroke(data, colour, 0.5));
    }
    group
}

/// Round numbers from low to high, steps of 1, 2 or 5 times a power of ten.
fn marks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / MARKS;
    let decade = 10.0_f64.powf(rough.log10().floor());
    let step = [5.0, 2.0, 1.0].map(|m| m * decade).into_iter().find(|step| *step <= rough).unwrap_or(decade);
    ((low / step).ceil() as i64..=(high / step).floor() as i64).map(|i| i as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_and_within() {
        assert_eq!(marks(-3.0, 11.0), [-2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(marks(0.0, 0.5), [0.0, 0.1, 0.2, 0.30000000000000004, 0.4, 0.5]);
        assert_eq!(marks(0.0, 100.0).len(), 6);
    }
}
