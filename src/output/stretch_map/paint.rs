//! Triangles in classes of colour, in files that stay small however fine the mesh is.

use std::fmt::Write;

use kurbo::{Point, Rect};
use svg::node::element::{Definitions, Group, Path, Pattern};

use crate::output::preview::page::{self, colour, number};

/// Classes of colour, evenly spaced in the logarithm.
pub const CLASSES: usize = 32;

/// The first and the last class reach to sqrt 2 below and above 1: a sheet of squares opens by that much.
const REACH: f64 = std::f64::consts::SQRT_2;

/// How finely a mesh is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Detail {
    /// Meshes with more triangles are drawn as cells.
    pub triangles: usize,
    /// Side of a cell on the page, millimetres; cells come in runs of one colour.
    pub cell: f64,
}

/// For a file of its own: 20,000 triangles take about 1 MB a view, and there are two hundred thousand cells at most.
pub const FINE: Detail = Detail { triangles: 20_000, cell: 0.5 };

/// For a figure in a page: some 100 kB in all.
pub const COARSE: Detail = Detail { triangles: 2500, cell: 0.8 };

/// ColorBrewer's PuOr (C. Brewer, M. Harrower), which colour-blind people can read: less, even, more.
const STOPS: [[f64; 3]; 7] = [
    [84.0, 39.0, 136.0],
    [153.0, 142.0, 195.0],
    [216.0, 218.0, 235.0],
    [247.0, 247.0, 247.0],
    [254.0, 224.0, 182.0],
    [241.0, 163.0, 64.0],
    [179.0, 88.0, 6.0],
];

/// Where a class begins; class `CLASSES` is the end of the last.
pub fn class_limits(class: usize) -> f64 {
    REACH.powf(2.0 * class as f64 / CLASSES as f64 - 1.0)
}

/// The class of a value; values beyond the ends belong to the end's class.
fn class_of(value: f64) -> usize {
    let part = 0.5 * (value.ln() / REACH.ln() + 1.0);
    ((part * CLASSES as f64).floor().max(0.0) as usize).min(CLASSES - 1)
}

/// Colour of a class as SVG writes it.
pub fn class_colour(class: usize) -> String {
    let at = (class as f64 + 0.5) / CLASSES as f64 * (STOPS.len() - 1) as f64;
    let stop = (at as usize).min(STOPS.len() - 2);
    let part = at - stop as f64;
    colour(std::array::from_fn(|i| STOPS[stop][i] * (1.0 - part) + STOPS[stop + 1][i] * part))
}

/// Triangles on the page, coloured by their values; nearer ones (smaller depth) hide others.
pub fn paint(triangles: &[[Point; 3]], depths: &[f64], values: &[f64], detail: Detail) -> Group {
    if triangles.len() <= detail.triangles {
        paint_triangles(triangles, depths, values)
    } else {
        paint_cells(triangles, depths, values, detail.cell)
    }
}

/// The triangles themselves, the farthest first; neighbours in that order share a path if they share a
/// colour.
fn paint_triangles(triangles: &[[Point; 3]], depths: &[f64], values: &[f64]) -> Group {
    let mut order: Vec<(usize, usize)> =
        values.iter().enumerate().map(|(i, &value)| (i, class_of(value))).collect();
    order.sort_by(|a, b| depths[b.0].total_cmp(&depths[a.0]).then(a.1.cmp(&b.1)).then(a.0.cmp(&b.0)));
    let mut group = Group::new().set("stroke-width", "0.12").set("stroke-linejoin", "round");
    for same in order.chunk_by(|a, b| a.1 == b.1) {
        let mut data = String::new();
        for &(triangle, _) in same {
            page::push_polyline(&mut data, triangles[triangle], true, 2);
        }
        // A thin stroke hides the seams that renderers leave between areas.
        let fill = class_colour(same[0].1);
        group = group.add(Path::new().set("d", data).set("stroke", fill.as_str()).set("fill", fill));
    }
    group
}

/// A grid of cells, each with the colour of the nearest triangle at its centre; of several there the one that
/// is farthest from 1.
fn paint_cells(triangles: &[[Point; 3]], depths: &[f64], values: &[f64], cell: f64) -> Group {
    let bounds = page::bounds(triangles.iter().flatten().copied());
    let (columns, rows) = grid(&bounds, cell);
    let mut cells: Vec<Option<usize>> = vec![None; columns * rows];
    for (triangle, corners) in triangles.iter().enumerate() {
        for (column, row) in covered(corners, &bounds, cell) {
            let nearest = &mut cells[row * columns + column];
            let key = |i: usize| (depths[i], -values[i].ln().abs());
            let nearer = nearest.is_none_or(|other| {
                let ((a, b), (c, d)) = (key(triangle), key(other));
                a.total_cmp(&c).then(b.total_cmp(&d)).is_lt()
            });
            if nearer {
                *nearest = Some(triangle);
            }
        }
    }
    let classes: Vec<Option<usize>> = cells.iter().map(|found| found.map(|i| class_of(values[i]))).collect();
    let painted =
        runs(&classes, columns, &bounds, cell).into_iter().enumerate().filter(|(_, data)| !data.is_empty());
    let group = Group::new().set("shape-rendering", "crispEdges");
    painted.fold(group, |group, (class, data)| group.add(page::area(data, &class_colour(class))))
}

/// Path data per class of a grid of cells: equal neighbours in a row become one rectangle.
fn runs(cells: &[Option<usize>], columns: usize, bounds: &Rect, cell: f64) -> Vec<String> {
    let mut paths = vec![String::new(); CLASSES];
    for (row, line) in cells.chunks(columns).enumerate() {
        let mut column = 0;
        for run in line.chunk_by(|a, b| a == b) {
            if let Some(class) = run[0] {
                let x = number(bounds.x0 + cell * column as f64, 2);
                let y = number(bounds.y0 + cell * row as f64, 2);
                let width = number(cell * run.len() as f64, 2);
                _ = write!(paths[class], "M{x},{y}h{width}v{cell}h-{width}z");
            }
            column += run.len();
        }
    }
    paths
}

/// Hatches the chosen ones of triangles that do not hide each other.
pub fn hatch(triangles: &[[Point; 3]], chosen: &[bool], detail: Detail) -> Group {
    let cell = detail.cell;
    let picked = triangles.iter().zip(chosen).filter(|(_, chosen)| **chosen).map(|(corners, _)| corners);
    let mut data = String::new();
    if triangles.len() <= detail.triangles {
        picked.for_each(|corners| page::push_polyline(&mut data, *corners, true, 2));
    } else {
        let bounds = page::bounds(triangles.iter().flatten().copied());
        let (columns, rows) = grid(&bounds, cell);
        let mut cells = vec![None; columns * rows];
        for (column, row) in picked.flat_map(|corners| covered(corners, &bounds, cell)) {
            cells[row * columns + column] = Some(0);
        }
        data = runs(&cells, columns, &bounds, cell).swap_remove(0);
    }
    if data.is_empty() { Group::new() } else { Group::new().add(page::area(data, HATCH)) }
}

/// Columns and rows of the cells over some bounds.
fn grid(bounds: &Rect, cell: f64) -> (usize, usize) {
    ((bounds.width() / cell) as usize + 1, (bounds.height() / cell) as usize + 1)
}

/// Fill of hatched areas; the drawing holds [`hatching`].
pub const HATCH: &str = "url(#beyond)";

/// The definition of the hatching: thin black lines, 2 mm apart.
pub fn hatching() -> Definitions {
    let line = page::stroke("M0,2L2,0M-0.5,0.5L0.5,-0.5M1.5,2.5L2.5,1.5".into(), "#000000", 0.2);
    let pattern = Pattern::new().set("id", "beyond").set("width", "2").set("height", "2");
    Definitions::new().add(pattern.set("patternUnits", "userSpaceOnUse").add(line))
}

/// The cells whose centres a triangle covers, and the one that holds its own centre.
fn covered(corners: &[Point; 3], bounds: &Rect, cell: f64) -> Vec<(usize, usize)> {
    let [a, b, c] = *corners;
    let middle = ((a.to_vec2() + b.to_vec2() + c.to_vec2()) / 3.0).to_point();
    let index = |length: f64| (length / cell).max(0.0) as usize;
    let place = |p: Point| (index(p.x - bounds.x0), index(p.y - bounds.y0));
    let area = page::bounds(*corners);
    let ((left, low), (right, high)) =
        (place(Point::new(area.x0, area.y0)), place(Point::new(area.x1, area.y1)));
    let mut cells = vec![place(middle)];
    for row in low..=high {
        for column in left..=right {
            let centre =
                Point::new(bounds.x0 + cell * (column as f64 + 0.5), bounds.y0 + cell * (row as f64 + 0.5));
            let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| (q - p).cross(centre - p));
            if sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0) {
                cells.push((column, row));
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_even_about_one_and_hold_all_values() {
        for class in 0..CLASSES {
            let inside = (class_limits(class) * class_limits(class + 1)).sqrt();
            assert_eq!(class_of(inside), class);
            assert!((class_limits(class) * class_limits(CLASSES - class) - 1.0).abs() < 1e-12);
        }
        assert_eq!([0.0, 1e-9, 5.0, f64::INFINITY].map(class_of), [0, 0, CLASSES - 1, CLASSES - 1]);
        assert_ne!(class_colour(0), class_colour(CLASSES - 1));
    }

    #[test]
    fn a_fine_mesh_covers_what_it_covers() {
        // Two triangles make a square of 20 x 20 cells; the one in front hides the other.
        let [a, b, c, d] = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(Point::from);
        let drawn =
            paint_cells(&[[a, b, c], [a, c, d], [a, b, d]], &[1.0, 1.0, 0.0], &[0.8, 0.8, 1.2], FINE.cell)
                .to_string();
        let area = |class: usize| -> f64 {
            let path = drawn.split("<path").find(|path| path.contains(&class_colour(class))).unwrap();
            let widths = path
                .split('h')
                .filter_map(|part| part.split_once('v').and_then(|(w, _)| w.parse::<f64>().ok()));
            widths.map(|width| width * FINE.cell).sum()
        };
        // Half of the square each, but for the cells along the diagonal.
        assert!((area(class_of(1.2)) - 50.0).abs() < 6.0, "{}", area(class_of(1.2)));
        assert!((area(class_of(0.8)) - 50.0).abs() < 6.0);
    }
}
