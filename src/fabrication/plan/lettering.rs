//! A font of single strokes, for engraving: capital letters, digits and a few signs on a grid of 4 x 6.

use kurbo::{Point, Vec2};

/// Height of the grid on which letters are drawn.
const GRID: f64 = 6.0;
/// From one letter's left edge to the next one's, in grid units.
const STEP: f64 = 5.5;
/// Width of a letter, in grid units.
const LETTER: f64 = 4.0;

/// The strokes of a letter: points "xy" on the grid, one stroke after the other. Small letters are drawn as capitals;
/// what is not known is left blank.
fn glyph(letter: char) -> &'static [&'static str] {
    match letter.to_ascii_uppercase() {
        '0' => &["10 30 41 45 36 16 05 01 10", "12 34"],
        '1' => &["05 26 20", "10 30"],
        '2' => &["05 16 36 45 44 00 40"],
        '3' => &["05 16 36 45 44 33 13", "33 42 41 30 10 01"],
        '4' => &["30 36 02 42"],
        '5' => &["46 06 03 33 42 41 30 10 01"],
        '6' => &["45 36 16 05 01 10 30 41 42 33 03"],
        '7' => &["06 46 10"],
        '8' => &["13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33"],
        '9' => &["01 10 30 41 45 36 16 05 04 13 43"],
        'A' => &["00 26 40", "12 32"],
        'B' => &["00 06 36 45 44 33 03", "33 42 41 30 00"],
        'C' => &["45 36 16 05 01 10 30 41"],
        'D' => &["00 06 26 44 42 20 00"],
        'E' => &["46 06 00 40", "03 33"],
        'F' => &["46 06 00", "03 33"],
        'G' => &["45 36 16 05 01 10 30 41 43 23"],
        'H' => &["00 06", "40 46", "03 43"],
        'I' => &["10 30", "16 36", "20 26"],
        'J' => &["01 10 20 31 36 16"],
        'K' => &["00 06", "46 03 40"],
        'L' => &["06 00 40"],
        'M' => &["00 06 23 46 40"],
        'N' => &["00 06 40 46"],
        'O' => &["10 30 41 45 36 16 05 01 10"],
        'P' => &["00 06 36 45 44 33 03"],
        'Q' => &["10 30 41 45 36 16 05 01 10", "22 40"],
        'R' => &["00 06 36 45 44 33 03", "23 40"],
        'S' => &["45 36 16 05 04 13 33 42 41 30 10 01"],
        'T' => &["06 46", "26 20"],
        'U' => &["06 01 10 30 41 46"],
        'V' => &["06 20 46"],
        'W' => &["06 10 23 30 46"],
        'X' => &["00 46", "06 40"],
        'Y' => &["06 23 46", "23 20"],
        'Z' => &["06 46 00 40"],
        '-' => &["13 33"],
        '_' => &["00 40"],
        '.' => &["20 21"],
        '/' => &["00 46"],
        '+' => &["13 33", "22 24"],
        _ => &[],
    }
}

/// Width of a text of capital letters of this height, both in millimetres.
pub fn width(text: &str, height: f64) -> f64 {
    let count = text.chars().count() as f64;
    ((count - 1.0).max(0.0) * STEP + LETTER) * height / GRID
}

/// The strokes of a text. `position`: left end of its base line; `height`: of its capital letters, millimetres.
pub fn strokes(text: &str, position: Point, height: f64) -> Vec<Vec<Point>> {
    let unit = height / GRID;
    let digit = |letter: u8| f64::from(letter - b'0');
    let stroke = |place: usize, stroke: &str| -> Vec<Point> {
        let left = Vec2::new(place as f64 * STEP, 0.0);
        let points = stroke.split(' ').map(str::as_bytes);
        points.map(|at| position + unit * (left + Vec2::new(digit(at[0]), digit(at[1])))).collect()
    };
    let letters = text.chars().enumerate();
    letters.flat_map(|(place, letter)| glyph(letter).iter().map(move |s| stroke(place, s))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_stay_in_their_boxes_and_all_differ() {
        let known = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ-_./+";
        for (i, letter) in known.chars().enumerate() {
            let text = letter.to_string();
            let strokes = strokes(&text, Point::new(10.0, 20.0), 3.0);
            assert!(!strokes.is_empty() && strokes.iter().all(|stroke| stroke.len() > 1), "{letter}");
            for point in strokes.iter().flatten() {
                let (x, y) = (point.x - 10.0, point.y - 20.0);
                assert!(
                    (0.0..=width(&text, 3.0) + 1e-12).contains(&x) && (0.0..=3.0).contains(&y),
                    "{letter}"
                );
            }
            assert!(known.chars().skip(i + 1).all(|other| glyph(other) != glyph(letter)), "{letter}");
            assert!(strokes.iter().all(|stroke| stroke.windows(2).all(|pair| pair[0] != pair[1])));
        }
        assert_eq!(strokes("é ", Point::ORIGIN, 1.0), Vec::<Vec<Point>>::new());
        assert_eq!(glyph('k'), glyph('K'));
        // Two letters of 6 mm: 5.5 mm from one to the next, and 4 mm.
        assert_eq!(width("12", 6.0), 9.5);
    }
}
