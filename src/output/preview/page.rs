//! The page's vocabulary: numbers, texts, lines, arrows, panels. Positions in page millimetres, y down.

use std::f64::consts::PI;
use std::fmt::Write as _;

use kurbo::{Affine, Point, Rect, Vec2};
use svg::node::element::{Group, Path, Rectangle, Text};

use super::super::plain_line;

/// A3 landscape, millimetres.
pub const PAGE: [f64; 2] = [420.0, 297.0];

/// Text and thin lines.
pub const INK: &str = "#222222";
/// Secondary lines.
pub const GREY: &str = "#777777";
/// Stock around the part.
pub const STOCK: &str = "#ececec";
/// Slits. The colours are those of M. Okabe and K. Ito (2008), which colour-blind people tell apart.
pub const SLIT: &str = "#d55e00";
/// Relief bars.
pub const RELIEF: &str = "#0072b2";
/// Borders and windows.
pub const BORDER: &str = "#000000";
/// The ligament in the enlarged corner.
pub const LIGAMENT: &str = "#009e73";

/// Which way a piece turns in its plane when the sheet opens, seen from the side that is up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// Against the clock.
    CounterClockwise,
    /// With the clock.
    Clockwise,
    /// Neither: it is only shifted, as the pieces between the rectangles of a bistable sheet are.
    Still,
}

impl Sense {
    /// The tone of pieces that turn this way, red, green and blue of 255.
    pub fn tone(self) -> [f64; 3] {
        match self {
            Self::CounterClockwise => [168.0, 208.0, 240.0],
            Self::Clockwise => [250.0, 218.0, 140.0],
            Self::Still => [214.0, 226.0, 205.0],
        }
    }
}

/// A colour as SVG writes it, from red, green and blue of 255.
pub fn colour(tone: [f64; 3]) -> String {
    let [r, g, b] = tone.map(|c| c.round().clamp(0.0, 255.0) as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A number with at most `digits` decimals, without exponent, trailing zeros or negative zero; a dash where there is
/// none.
pub fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "\u{2013}".into();
    }
    let text = format!("{value:.digits$}");
    let text = if digits > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// A number with exactly `digits` decimals, for columns and angles; a dash where there is none.
pub fn fixed(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{:.digits$}", value + 0.0) } else { "\u{2013}".into() }
}

/// A whole number with a comma between thousands.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Appends a polyline to path data.
pub fn push_polyline(
    data: &mut String,
    points: impl IntoIterator<Item = Point>,
    closed: bool,
    digits: usize,
) {
    for (i, point) in points.into_iter().enumerate() {
        let lead = if i == 0 { 'M' } else { ' ' };
        _ = write!(data, "{lead}{},{}", number(point.x, digits), number(point.y, digits));
    }
    if closed {
        data.push('Z');
    }
}

/// A filled area.
pub fn area(data: String, fill: &str) -> Path {
    Path::new().set("d", data).set("fill", fill)
}

/// A stroked line without filling.
pub fn stroke(data: String, colour: &str, width: f64) -> Path {
    Path::new().set("d", data).set("fill", "none").set("stroke", colour).set("stroke-width", number(width, 3))
}

/// A straight stroke.
pub fn segment(from: Point, to: Point, colour: &str, width: f64) -> Path {
    let mut data = String::new();
    push_polyline(&mut data, [from, to], false, 2);
    stroke(data, colour, width)
}

/// Dots of one colour as a single path: strokes of no length with round ends.
pub fn dots(points: impl IntoIterator<Item = Point>, radius: f64, colour: &str) -> Path {
    let mut data = String::new();
    for point in points {
        _ = write!(data, "M{},{}h0", number(point.x, 2), number(point.y, 2));
    }
    stroke(data, colour, 2.0 * radius).set("stroke-linecap", "round")
}

/// A line of text; `at` is the left end of its base line, `size` the font size.
pub fn text(at: Point, size: f64, content: &str) -> Text {
    Text::new(plain_line(content))
        .set("x", number(at.x, 2))
        .set("y", number(at.y, 2))
        .set("font-size", number(size, 2))
        .set("fill", INK)
}

/// The same text twice, first as a wide white stroke, so that it can be read on a drawing.
pub fn text_with_halo(at: Point, size: f64, content: &str, anchor: &str) -> Group {
    let line = || text(at, size, content).set("text-anchor", anchor).set("font-weight", "bold");
    let halo = line().set("stroke", "#ffffff").set("stroke-width", number(0.3 * size, 2));
    Group::new().add(halo.set("stroke-linejoin", "round").set("fill", "#ffffff")).add(line())
}

/// Width of a letter in font sizes, as in DejaVu Sans, one of the widest sans-serif fonts.
fn letter_width(letter: char) -> f64 {
    match letter {
        'i' | 'j' | 'l' | 't' | 'f' | 'r' | ' ' | '.' | ',' | ':' | ';' | '\'' | '(' | ')' | '|' | '-' => 0.4,
        'm' | 'w' | 'M' | 'W' | '%' | '#' | '\u{2026}' => 0.98,
        letter if letter.is_lowercase() => 0.6,
        letter if letter.is_ascii() => 0.68,
        _ => 1.0,
    }
}

/// How much wider bold letters are: bold text of size s needs the room of plain text of size `BOLD * s`.
pub const BOLD: f64 = 1.15;

/// Width that a text is expected to take.
pub fn text_width(content: &str, size: f64) -> f64 {
    size * content.chars().map(letter_width).sum::<f64>()
}

/// The text, cut off where it would be wider than `width`.
pub fn shortened(content: &str, size: f64, width: f64) -> String {
    if text_width(content, size) <= width {
        return content.into();
    }
    let mut room = width - text_width("\u{2026}", size);
    let fits = |letter: &char| {
        room -= size * letter_width(*letter);
        room >= 0.0
    };
    content.chars().take_while(fits).chain(['\u{2026}']).collect()
}

/// The text broken between words into lines of at most `width`.
pub fn wrapped(content: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in content.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(line, size) + text_width(word, size) + 0.6 * size <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(shortened(word, size, width)),
        }
    }
    lines
}

/// A panel: a thin frame with a heading.
pub fn panel(area: Rect, heading: &str) -> Group {
    let heading = shortened(heading, BOLD * 4.2, area.width() - 4.0);
    Group::new()
        .add(rectangle(area, "none").set("stroke", "#bbbbbb").set("stroke-width", "0.25"))
        .add(text(Point::new(area.x0 + 2.0, area.y0 + 5.2), 4.2, &heading).set("font-weight", "bold"))
}

/// A filled rectangle.
pub fn rectangle(area: Rect, fill: &str) -> Rectangle {
    Rectangle::new()
        .set("x", number(area.x0, 2))
        .set("y", number(area.y0, 2))
        .set("width", number(area.width(), 2))
        .set("height", number(area.height(), 2))
        .set("fill", fill)
}

/// The triangle of an arrow's head.
pub fn arrow_head(tip: Point, direction: Vec2, size: f64, colour: &str) -> Path {
    let back = tip - size * direction;
    let side = 0.36 * size * direction.turn_90();
    let mut data = String::new();
    push_polyline(&mut data, [tip, back + side, back - side], true, 2);
    area(data, colour)
}

/// A straight arrow; nothing if it has no length.
pub fn arrow(from: Point, to: Point, colour: &str, width: f64) -> Group {
    let direction = (to - from).normalize();
    if !direction.is_finite() {
        return Group::new();
    }
    let head = 2.2_f64.min(0.6 * from.distance(to));
    Group::new()
        .add(segment(from, to - 0.8 * head * direction, colour, width))
        .add(arrow_head(to, direction, head, colour))
}

/// A dimension line with a head at both ends; if the ends are near, the arrows point at them from outside.
/// Nothing if the ends coincide.
pub fn dimension(from: Point, to: Point) -> Group {
    let direction = (to - from).normalize();
    if !direction.is_finite() {
        return Group::new();
    }
    if from.distance(to) < 6.0 {
        let reach = 5.0 * direction;
        return Group::new().add(arrow(from - reach, from, INK, 0.25)).add(arrow(to + reach, to, INK, 0.25));
    }
    Group::new()
        .add(segment(from, to, INK, 0.25))
        .add(arrow_head(from, -direction, 2.0, INK))
        .add(arrow_head(to, direction, 2.0, INK))
}

/// Three quarters of a circle with a head: how a piece turns. Nothing where it does not.
pub fn turn_arrow(centre: Point, radius: f64, sense: Sense, width: f64) -> Group {
    // The page's y points down: counter-clockwise to the eye is towards smaller angles.
    let sign = match sense {
        Sense::CounterClockwise => -1.0,
        Sense::Clockwise => 1.0,
        Sense::Still => return Group::new(),
    };
    let sweep = 1.5 * PI - 0.5;
    let from = -0.5 * PI + sign * 0.25 * PI;
    let points = (0..=24).map(|i| {
        let angle = from + sign * sweep * f64::from(i) / 24.0;
        centre + radius * Vec2::from_angle(angle)
    });
    let mut data = String::new();
    push_polyline(&mut data, points, false, 2);
    let end = from + sign * (sweep + 0.15);
    let direction = sign * Vec2::from_angle(end).turn_90();
    let head = 1.0 * radius;
    let tip = centre + radius * Vec2::from_angle(end) + 0.55 * head * Vec2::from_angle(end + sign * 0.5 * PI);
    Group::new().add(stroke(data, INK, width)).add(arrow_head(tip, direction, head, INK))
}

/// The map that fits `source` (y up) into `panel` (y down), centred, with one scale for both axes.
pub fn fit(source: Rect, panel: Rect) -> Affine {
    let scale = (panel.width() / source.width()).min(panel.height() / source.height());
    // A source without extent (a single point) is shown at the middle.
    let scale = if scale.is_finite() { scale } else { 1.0 };
    Affine::translate(panel.center().to_vec2())
        * Affine::scale_non_uniform(scale, -scale)
        * Affine::translate(-source.center().to_vec2())
}

/// How many times larger a map without shear draws lengths.
pub fn scale_of(map: Affine) -> f64 {
    map.determinant().abs().sqrt()
}

/// The box of points; empty at the origin if there are none.
pub fn bounds(points: impl IntoIterator<Item = Point>) -> Rect {
    let mut points = points.into_iter();
    let first = points.next().unwrap_or_default();
    points.fold(Rect::from_points(first, first), |all, point| all.union_pt(point))
}

/// A closed contour with fewer vertices, nowhere further than `tolerance` from the given one (D. Douglas and
/// T. Peucker 1973).
pub fn simplified(contour: &[Point], tolerance: f64) -> Vec<Point> {
    let far = |from: Point| {
        let reach = |i: &usize| contour[*i].distance_squared(from);
        (0..contour.len()).max_by(|a, b| reach(a).total_cmp(&reach(b)))
    };
    let Some(split) = contour.first().and_then(|&first| far(first)).filter(|&split| split > 0) else {
        return contour.to_vec();
    };
    let mut ring = contour.to_vec();
    ring.push(contour[0]);
    let mut kept = vec![ring[0]];
    let mut pending = vec![(split, ring.len() - 1), (0, split)];
    while let Some((from, to)) = pending.pop() {
        let distance = |i: usize| distance_to_segment(ring[i], ring[from], ring[to]);
        match (from + 1..to).max_by(|&a, &b| distance(a).total_cmp(&distance(b))) {
            Some(worst) if distance(worst) > tolerance => pending.extend([(worst, to), (from, worst)]),
            _ => kept.push(ring[to]),
        }
    }
    kept.pop();
    if kept.len() < 3 { contour.to_vec() } else { kept }
}

fn distance_to_segment(p: Point, a: Point, b: Point) -> f64 {
    let along = b - a;
    let t = (p - a).dot(along) / along.length_squared();
    let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + t * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_plain() {
        let shown = [
            (0.0, 2),
            (-0.001, 2),
            (1e-9, 3),
            (12.5, 0),
            (1e7, 1),
            (-2.50, 2),
            (f64::NAN, 1),
            (f64::INFINITY, 1),
        ];
        let texts: Vec<String> = shown.iter().map(|&(value, digits)| number(value, digits)).collect();
        assert_eq!(texts, ["0", "0", "0", "12", "10000000", "-2.5", "\u{2013}", "\u{2013}"]);
        assert_eq!([100, 1000, 1234567].map(grouped), ["100", "1,000", "1,234,567"]);
        assert_eq!([fixed(84.0, 1), fixed(f64::NAN, 1)], ["84.0", "\u{2013}"]);
    }

    #[test]
    fn texts_are_cut_and_broken_to_width() {
        assert_eq!(shortened("short", 3.0, 100.0), "short");
        let cut = shortened(&"w".repeat(500), 3.0, 60.0);
        assert!(cut.ends_with('\u{2026}') && text_width(&cut, 3.0) <= 60.0);
        let lines = wrapped("one two three four five six seven", 3.0, 20.0);
        assert_eq!(lines.join(" "), "one two three four five six seven");
        assert!(lines.len() > 1 && lines.iter().all(|line| text_width(line, 3.0) <= 20.0));
    }

    #[test]
    fn simplified_contours_stay_within_tolerance() {
        let circle: Vec<Point> =
            (0..200).map(|i| Vec2::from_angle(2.0 * PI * f64::from(i) / 200.0).to_point()).collect();
        let few = simplified(&circle, 0.01);
        // A chord over the angle a leaves the unit circle by 1 - cos(a/2): 0.01 at 16 degrees, so 23 chords or more.
        assert!((23..60).contains(&few.len()), "{}", few.len());
        for p in &circle {
            let ring = few.iter().zip(few.iter().cycle().skip(1));
            let distance = ring.map(|(a, b)| distance_to_segment(*p, *a, *b)).fold(f64::INFINITY, f64::min);
            assert!(distance <= 0.01 + 1e-12); // rounding
        }
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(Point::from);
        assert_eq!(simplified(&square, 0.1), square);
        let point = [Point::new(1.0, 2.0); 4];
        assert_eq!(simplified(&point, 0.1).len(), 4);
    }

    #[test]
    fn fit_turns_y_over_and_centres() {
        let map = fit(Rect::new(0.0, 0.0, 10.0, 10.0), Rect::new(100.0, 50.0, 140.0, 70.0));
        assert_eq!(map * Point::new(0.0, 0.0), Point::new(110.0, 70.0));
        assert_eq!(map * Point::new(10.0, 10.0), Point::new(130.0, 50.0));
        assert_eq!(scale_of(map), 2.0);
    }

    #[test]
    fn turn_arrows_turn_as_they_say() {
        assert!(!turn_arrow(Point::ORIGIN, 4.0, Sense::Still, 0.5).to_string().contains("path"));
        for (sense, sign) in [(Sense::CounterClockwise, -1.0), (Sense::Clockwise, 1.0)] {
            let drawn = turn_arrow(Point::ORIGIN, 4.0, sense, 0.5).to_string();
            let data = drawn.split("d=\"M").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
            let points: Vec<Vec2> = data
                .split(' ')
                .map(|pair| {
                    let (x, y) = pair.split_once(',').unwrap();
                    Vec2::new(x.parse().unwrap(), y.parse().unwrap())
                })
                .collect();
            assert_eq!(points.len(), 25);
            // With y down a positive cross product is a turn with the clock.
            assert!(points.windows(2).all(|pair| sign * pair[0].cross(pair[1]) > 0.0));
        }
    }
}
