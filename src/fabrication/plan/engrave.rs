//! Numbers of the pieces, and the part's name on one of them, engraved inside the pieces' true outlines.

use kurbo::Point;

use super::lettering::{strokes, width};
use crate::fabrication::layout::{Engraving, Note};
use crate::fabrication::outline::{Contour, inner_point};

/// Letter heights that are tried, millimetres: the largest that fits. Below the last nobody reads them.
const HEIGHTS: [f64; 8] = [4.0, 3.0, 2.5, 2.0, 1.5, 1.2, 1.0, 0.8];
/// Least distance between a stroke and the edge of a piece, millimetres.
const CLEAR: f64 = 0.3;
/// From one line's base to the next, in letter heights.
const LINE: f64 = 1.5;

/// What is engraved on one part.
#[derive(Debug, Clone, PartialEq)]
pub struct Engraved {
    /// The texts, in the order of the pieces.
    pub engravings: Vec<Engraving>,
    /// Number of pieces that are too small for their number.
    pub too_small: usize,
    /// Whether the part's name stands on a piece.
    pub named: bool,
}

/// Every piece's number in its middle, and under that of one piece, where it can be largest, the part's name.
///
/// `outlines`: true outlines of the pieces, millimetres.
pub fn engraved(outlines: &[Contour], name: &str) -> Engraved {
    let number = |piece: usize| vec![piece.to_string()];
    let with_name = |piece: usize| vec![piece.to_string(), name.to_owned()];
    let mut named: Option<(usize, Fit)> = None;
    for (piece, outline) in outlines.iter().enumerate() {
        let larger = |fit: &Fit| named.as_ref().is_none_or(|(_, best)| fit.height > best.height);
        if let Some(fit) = fit(outline, &with_name(piece)).filter(larger) {
            named = Some((piece, fit));
        }
    }
    let mut engraved = Engraved { engravings: Vec::new(), too_small: 0, named: named.is_some() };
    for (piece, outline) in outlines.iter().enumerate() {
        let (lines, place) = match &named {
            Some((with, place)) if *with == piece => (with_name(piece), Some(place.clone())),
            _ => (number(piece), fit(outline, &number(piece))),
        };
        match place {
            Some(place) => engraved.engravings.extend(place.lines(&lines)),
            None => engraved.too_small += 1,
        }
    }
    engraved
}

/// Where a text fits: its middle and the height of its letters, millimetres.
#[derive(Debug, Clone, PartialEq)]
struct Fit {
    middle: Point,
    height: f64,
}

impl Fit {
    /// The lines, each centred, the first on top.
    fn lines(&self, lines: &[String]) -> Vec<Engraving> {
        let Fit { middle, height } = *self;
        let top = middle.y + 0.5 * box_height(lines.len(), height) - height;
        let line = |(i, text): (usize, &String)| {
            let position = Point::new(middle.x - 0.5 * width(text, height), top - LINE * height * i as f64);
            let label = Note { position, height, text: text.clone() };
            Engraving { strokes: strokes(text, position, height), label }
        };
        lines.iter().enumerate().map(line).collect()
    }
}

fn box_height(lines: usize, height: f64) -> f64 {
    (1.0 + LINE * (lines - 1) as f64) * height
}

/// The largest letters with which lines of text, one below the other, fit about the middle of a piece.
fn fit(outline: &Contour, lines: &[String]) -> Option<Fit> {
    let [x, y] = inner_point(outline, CLEAR + HEIGHTS[HEIGHTS.len() - 1]);
    let middle = Point::new(x, y);
    let fits = |height: f64| {
        let wide = lines.iter().map(|line| width(line, height)).fold(0.0, f64::max);
        let [half_x, half_y] = [wide, box_height(lines.len(), height)].map(|size| 0.5 * size + CLEAR);
        // In these units the text's box, with its clearance, is the square of half side 1.
        let scaled = |[px, py]: [f64; 2]| Point::new((px - x) / half_x, (py - y) / half_y);
        let mut from = scaled(outline[outline.len() - 1]);
        outline.iter().all(|&vertex| {
            let to = scaled(vertex);
            let clear = from_square(from, to) >= 1.0;
            from = to;
            clear
        })
    };
    HEIGHTS.into_iter().find(|&height| fits(height)).map(|height| Fit { middle, height })
}

/// Half side of the largest square about the origin that a segment does not enter.
fn from_square(from: Point, to: Point) -> f64 {
    let along = to - from;
    let size = |part: f64| {
        let at = from + part.clamp(0.0, 1.0) * along;
        at.x.abs().max(at.y.abs())
    };
    // The greater of |x| and |y| is least at an end, where one of them vanishes, or where both are equal.
    let parts = [
        0.0,
        1.0,
        -from.x / along.x,
        -from.y / along.y,
        (from.y - from.x) / (along.x - along.y),
        -(from.y + from.x) / (along.x + along.y),
    ];
    parts.into_iter().filter(|part| part.is_finite()).map(size).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_that_segments_leave_free() {
        let half = |ax: f64, ay: f64, bx: f64, by: f64| from_square(Point::new(ax, ay), Point::new(bx, by));
        assert_eq!((half(3.0, -1.0, 3.0, 1.0), half(-5.0, 2.0, 9.0, 2.0)), (3.0, 2.0));
        // x + y = 4 comes nearest at (2, 2); the part from (3, 1) on at its end.
        assert_eq!((half(0.0, 4.0, 4.0, 0.0), half(3.0, 1.0, 4.0, 0.0)), (2.0, 3.0));
        assert_eq!(half(-1.0, -1.0, 1.0, 1.0), 0.0);
    }

    #[test]
    fn numbers_are_as_large_as_their_piece_lets_them() {
        let rectangle = |w: f64, h: f64| vec![[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]];
        // Letters of 2.5 mm are 1.67 mm wide; with 0.3 mm on each side 2.27 x 3.1 mm. The next larger need 3.6 mm.
        let [exact, small] = [rectangle(2.5 * 4.0 / 6.0 + 0.6 + 1e-9, 3.1 + 1e-9), rectangle(1.0, 1.0)];
        let large = rectangle(30.0, 20.0);
        let Engraved { engravings, too_small, named } = engraved(&[exact.clone(), small, large], "Dome");
        let texts: Vec<(&str, f64)> =
            engravings.iter().map(|e| (e.label.text.as_str(), e.label.height)).collect();
        assert_eq!(texts, [("0", 2.5), ("2", 4.0), ("Dome", 4.0)]);
        assert!(too_small == 1 && named);
        for point in engravings[0].strokes.iter().flatten() {
            let edge = point.x.min(exact[2][0] - point.x).min(point.y).min(exact[2][1] - point.y);
            assert!(edge >= CLEAR - 1e-9, "{point}");
        }
        // Two lines in the middle of 20 mm: 4 mm, 2 mm between them, 4 mm.
        assert_eq!((engravings[1].label.position.y, engravings[2].label.position.y), (11.0, 5.0));
        assert!(!self::engraved(&[exact], "A name that is too long").named);
    }
}
