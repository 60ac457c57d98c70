//! Reads the cuts of an SVG: every `<path>` is a cut, `<text>` is a note.

use kurbo::Point;
use svg::node::Attributes;
use svg::parser::Event;

use super::fault::Check;
use super::machine_file::{MachineFile, ReadError, colour_of, kind_of};
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};
use crate::profile::Profile;

const NAME: &str = "cut.svg";

/// Points that are this close are one, millimetres: the last digit that is written.
const SAME_POINT: f64 = 1e-6;

/// Reads an SVG; its sheet is held against the profile's.
///
/// # Errors
/// No SVG, or path data of another kind than ours.
pub(super) fn read(bytes: &[u8], profile: &Profile) -> Result<MachineFile, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|_| error("the file is not text in UTF-8"))?;
    let mut file = MachineFile::new(NAME);
    let mut page: Option<Page> = None;
    let mut complete = false;
    for event in svg::read(text).map_err(|source| error(source.to_string()))? {
        match event {
            Event::Error(source) => return Err(error(source.to_string())),
            Event::Comment(comment) => {
                file.comment(comment.trim_start_matches("<!--").trim_end_matches("-->"));
            }
            Event::Tag("svg", svg::node::element::tag::Type::End, _) => complete = true,
            Event::Tag("svg", _, attributes) => page = Some(Page::read(&attributes, profile, &mut file)),
            Event::Tag("path", _, attributes) => {
                let page = page.as_ref().ok_or_else(|| error("a path stands before the <svg> element"))?;
                let path = cut(&attributes, page, &mut file)?;
                file.paths.push(path);
            }
            Event::Tag("text", ..) => (),
            Event::Tag(name, ..) => {
                file.fault(Check::Layer, format!("<{name}>"), None, "is neither a cut nor a note");
            }
            _ => (),
        }
    }
    if !complete {
        return Err(error("the file ends without </svg>: it is truncated or no SVG"));
    }
    if file.paths.is_empty() {
        file.fault(Check::Layer, "the drawing", None, "holds no cut");
    }
    Ok(file)
}

fn error(reason: impl Into<String>) -> ReadError {
    ReadError { file: NAME, line: None, reason: reason.into() }
}

fn attribute<'a>(attributes: &'a Attributes, name: &str) -> &'a str {
    attributes.get(name).map_or("", |value| value)
}

/// Millimetres per unit of the path data, and the sheet's height.
struct Page {
    scale: f64,
    height: f64,
}

impl Page {
    /// The page of an `<svg>`; where its size is no use, one unit is a millimetre.
    fn read(attributes: &Attributes, profile: &Profile, file: &mut MachineFile) -> Self {
        let [width, height] = ["width", "height"].map(|key| {
            let value = attribute(attributes, key);
            value.strip_suffix("mm").and_then(|number| number.trim().parse::<f64>().ok()).or_else(|| {
                file.fault(Check::Units, key, None, format!("is {value:?}, not a size in mm"));
                None
            })
        });
        let sheet = [profile.sheet.width, profile.sheet.height];
        let size = [width.unwrap_or(sheet[0]), height.unwrap_or(sheet[1])];
        if (size[0] - sheet[0]).abs().max((size[1] - sheet[1]).abs()) > SAME_POINT {
            let says =
                format!("is {} x {} mm, the stock is {} x {} mm", size[0], size[1], sheet[0], sheet[1]);
            file.fault(Check::Units, "the page", None, says);
        }
        let view = attribute(attributes, "viewBox");
        let numbers: Vec<f64> = view.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let scale = match numbers[..] {
            [0.0, 0.0, x, y] if x > 0.0 && y > 0.0 => size[0] / x,
            _ => f64::NAN,
        };
        // A unit that is a millimetre to nine digits is one to a micrometre on a sheet of a metre.
        if !((scale - 1.0).abs() < 1e-9 && (size[1] / numbers[3] - 1.0).abs() < 1e-9) {
            let says = format!(
                "is {view:?}: one unit must be one millimetre on a page of {} x {} mm",
                size[0], size[1]
            );
            file.fault(Check::Units, "viewBox", None, says);
        }
        let scale = if scale.is_finite() { scale } else { 1.0 };
        Self { scale, height: size[1] }
    }

    fn point(&self, x: f64, y: f64) -> Point {
        Point::new(x * self.scale, self.height - y * self.scale)
    }
}

fn cut(attributes: &Attributes, page: &Page, file: &mut MachineFile) -> Result<CutPath, ReadError> {
    let number = file.paths.len();
    let class = attribute(attributes, "class");
    let kind = kind_of(&class.to_uppercase()).unwrap_or_else(|| {
        file.fault(
            Check::Layer,
            format!("path {number}"),
            None,
            format!("is of the class {class:?}, which is not cut"),
        );
        CutKind::Slit
    });
    let stroke = attribute(attributes, "stroke");
    if !stroke.eq_ignore_ascii_case(colour_of(kind)) {
        let says = format!("is drawn in {stroke:?}, its layer's colour is {}", colour_of(kind));
        file.fault(Check::Layer, format!("path {number} ({class})"), None, says);
    }
    if let Some(transform) = attributes.get("transform") {
        let says = format!("is moved by {:?}, which some machines drop", &**transform);
        file.fault(Check::Layer, format!("path {number} ({class})"), None, says);
    }
    let (vertices, closed) = path_data(attribute(attributes, "d"), page)
        .map_err(|reason| error(format!("path {number} ({class}): {reason}")))?;
    Ok(CutPath { kind, vertices, closed })
}

/// Vertices and whether the path is closed, from the commands M, L, A and Z.
fn path_data(data: &str, page: &Page) -> Result<(Vec<PathVertex>, bool), String> {
    let mut vertices: Vec<PathVertex> = Vec::new();
    let mut closed = false;
    let mut words = data.split([' ', ',', '\n', '\t']).filter(|word| !word.is_empty());
    while let Some(word) = words.next() {
        let mut letters = word.chars();
        let command = letters.next().unwrap_or_default();
        let mut rest = Some(letters.as_str()).filter(|rest| !rest.is_empty());
        let mut number = || -> Result<f64, String> {
            let word = rest.take().or_else(|| words.next()).ok_or("the path data ends early")?;
            word.parse().map_err(|_| format!("{word:?} is no number"))
        };
        match command {
            'M' if vertices.is_empty() => (),
            'L' if !vertices.is_empty() => (),
            'A' if !vertices.is_empty() => {
                let [rx, ry, _, large, sweep] = [number()?, number()?, number()?, number()?, number()?];
                let to = page.point(number()?, number()?);
                if rx != ry {
                    return Err(format!("an ellipse of {rx} and {ry} mm"));
                }
                let last = vertices.len() - 1;
                vertices[last].bulge =
                    bulge(vertices[last].point, to, rx * page.scale, large != 0.0, sweep != 0.0);
                vertices.push(PathVertex { point: to, bulge: 0.0 });
                continue;
            }
            'Z' => {
                closed = true;
                continue;
            }
            _ => return Err(format!("{word:?} is none of the commands M, L, A, Z")),
        }
        vertices.push(PathVertex { point: page.point(number()?, number()?), bulge: 0.0 });
    }
    // A closed path whose last segment is an arc comes back to its first point before the Z.
    if closed
        && vertices.len() > 2
        && vertices[0].point.distance(vertices[vertices.len() - 1].point) <= SAME_POINT
    {
        vertices.pop();
    }
    Ok((vertices, closed))
}

/// The bulge of an arc of this radius; sweep is clockwise with y up.
fn bulge(from: Point, to: Point, radius: f64, large: bool, sweep: bool) -> f64 {
    let half_angle = (0.5 * from.distance(to) / radius).min(1.0).asin();
    let angle = if large { std::f64::consts::TAU - 2.0 * half_angle } else { 2.0 * half_angle };
    let bulge = (0.25 * angle).tan();
    if sweep { -bulge } else { bulge }
}
