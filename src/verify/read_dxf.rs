//! Reads the cuts of a DXF: R2000 with LWPOLYLINE, or R12 with LINE and ARC.
//!
//! A reader of its own, of the few things that a cut file holds, so that a misunderstanding between the writer and
//! the crate that it uses cannot hide here. Anything else among the entities is a fault.

use kurbo::{Point, Vec2};

use super::fault::Check;
use super::machine_file::{ENGRAVE, MachineFile, NOTE, ReadError, kind_of};
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};

const NAME: &str = "cut.dxf";

/// Ends of LINE and ARC that are this close belong to one path, millimetres: a thousand times the rounding of the
/// twelve decimals that a radius of a metre multiplies.
const SAME_POINT: f64 = 1e-6;

/// A group code and its value, with its line.
struct Pair<'a> {
    line: usize,
    code: i32,
    value: &'a str,
}

/// One entity: what is needed of it.
struct Entity<'a> {
    line: usize,
    name: &'a str,
    layer: &'a str,
    /// Numbers of the groups 10 to 79 and 230, in order.
    groups: Vec<(i32, f64)>,
}

impl Entity<'_> {
    /// The first number with this code; NaN where there is none.
    fn number(&self, code: i32) -> f64 {
        self.groups.iter().find(|group| group.0 == code).map_or(f64::NAN, |group| group.1)
    }

    fn called(&self) -> String {
        format!("{} in line {} (layer {})", self.name, self.line, self.layer)
    }
}

/// Reads a DXF.
///
/// # Errors
/// Not pairs of a code and a value, a value that is no number where one must stand, no end.
pub(super) fn read(bytes: &[u8]) -> Result<MachineFile, ReadError> {
    let text = String::from_utf8_lossy(bytes);
    let mut file = MachineFile::new(NAME);
    let mut header = Header::default();
    let mut section = "";
    let mut variable = "";
    let mut entity: Option<Entity> = None;
    let mut chain = None;
    let mut lines = text.lines().enumerate();
    let mut previous = "";
    let mut ended = false;
    while let Some(pair) = next_pair(&mut lines)? {
        match (pair.code, section) {
            (999, _) => file.comment(pair.value),
            (0, _) => {
                if let Some(entity) = entity.take() {
                    take(&mut file, &mut chain, &entity);
                }
                ended = pair.value == "EOF";
                match pair.value {
                    "ENDSEC" | "EOF" => section = "",
                    name if section == "ENTITIES" => {
                        entity = Some(Entity { line: pair.line, name, layer: "0", groups: Vec::new() });
                    }
                    _ => (),
                }
            }
            (2, "") if previous == "SECTION" => section = pair.value,
            (9, "HEADER") => variable = pair.value,
            (_, "HEADER") => header.take(variable, pair.value),
            (8, "ENTITIES") => entity.iter_mut().for_each(|entity| entity.layer = pair.value),
            (10..=79 | 230, "ENTITIES") => {
                let number = number(&pair)?;
                entity.iter_mut().for_each(|entity| entity.groups.push((pair.code, number)));
            }
            _ => (),
        }
        previous = pair.value;
    }
    if !ended {
        return Err(error(None, "the file ends without EOF: it is truncated or no DXF"));
    }
    header.check(&mut file);
    if file.paths.is_empty() {
        file.fault(Check::Layer, "the drawing", None, "holds no cut");
    }
    Ok(file)
}

fn error(line: Option<usize>, reason: impl Into<String>) -> ReadError {
    ReadError { file: NAME, line, reason: reason.into() }
}

fn next_pair<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<Option<Pair<'a>>, ReadError> {
    let Some((line, code)) = lines.next() else { return Ok(None) };
    let code = code.trim();
    if code.is_empty() {
        return Ok(None); // the empty line that some programs end with
    }
    let code = code
        .parse()
        .map_err(|_| error(Some(line + 1), format!("{:?} is no group code of a DXF", shortened(code))))?;
    let Some((_, value)) = lines.next() else {
        return Err(error(Some(line + 1), "a group code without a value: the file is truncated"));
    };
    Ok(Some(Pair { line: line + 1, code, value: value.trim() }))
}

fn number(pair: &Pair) -> Result<f64, ReadError> {
    let says = || format!("{:?} is no number (group {})", shortened(pair.value), pair.code);
    pair.value.parse().map_err(|_| error(Some(pair.line + 1), says()))
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

/// What the header says of units.
#[derive(Default)]
struct Header {
    version: String,
    units: Option<String>,
}

impl Header {
    fn take(&mut self, variable: &str, value: &str) {
        match variable {
            "$ACADVER" => self.version = value.to_owned(),
            "$INSUNITS" => self.units = Some(value.to_owned()),
            _ => (),
        }
    }

    /// R12 has no place for units.
    fn check(&self, file: &mut MachineFile) {
        match (self.version.as_str(), self.units.as_deref()) {
            ("AC1009", None) | (_, Some("4")) => (),
            (version, None) => {
                let says = format!("is missing in a file of version {version:?}; it must be 4 (millimetres)");
                file.fault(Check::Units, "$INSUNITS", None, says);
            }
            (_, Some(found)) => {
                let unit = match found {
                    "1" => " (inches)",
                    "5" => " (centimetres)",
                    "6" => " (metres)",
                    _ => "",
                };
                file.fault(Check::Units, "$INSUNITS", None, format!("is {found}{unit}, not 4 (millimetres)"));
            }
        }
    }
}

/// Makes a cut of an entity, or lengthens the one before.
fn take(file: &mut MachineFile, chain: &mut Option<usize>, entity: &Entity) {
    if entity.name == "TEXT" && entity.layer == NOTE {
        return;
    }
    if !matches!(entity.name, "LWPOLYLINE" | "LINE" | "ARC") {
        file.fault(Check::Layer, entity.called(), None, "is neither a cut nor a note");
        return;
    }
    if entity.groups.iter().any(|&(code, value)| code == 230 && value != 1.0) {
        file.fault(Check::Layer, entity.called(), None, "is drawn in a turned plane; cuts lie in x and y");
    }
    if entity.layer == ENGRAVE && entity.name != "ARC" {
        let vertices = if entity.name == "LINE" { line(entity).to_vec() } else { vertices(entity) };
        file.engraved.push(vertices.iter().map(|vertex| vertex.point).collect());
        return;
    }
    let kind = kind_of(entity.layer).unwrap_or_else(|| {
        file.fault(
            Check::Layer,
            entity.called(),
            None,
            "is on no layer that is cut (SLIT, RELIEF, WINDOW, BORDER, LEAD)",
        );
        CutKind::Slit
    });
    if entity.name == "LWPOLYLINE" {
        *chain = None;
        let closed = entity.number(70) as i64 & 1 == 1;
        file.paths.push(CutPath { kind, vertices: vertices(entity), closed });
        return;
    }
    let segment = if entity.name == "LINE" { line(entity) } else { arc(entity) };
    match chain.filter(|&last| file.paths[last].kind == kind && join(&mut file.paths[last], &segment)) {
        Some(last) => *chain = (!file.paths[last].closed).then_some(last),
        None => {
            *chain = Some(file.paths.len());
            file.paths.push(CutPath { kind, vertices: segment.to_vec(), closed: false });
        }
    }
}

fn vertices(entity: &Entity) -> Vec<PathVertex> {
    let mut vertices: Vec<PathVertex> = Vec::new();
    for &(code, value) in &entity.groups {
        match (code, vertices.last_mut()) {
            (10, _) => vertices.push(PathVertex { point: Point::new(value, f64::NAN), bulge: 0.0 }),
            (20, Some(vertex)) => vertex.point.y = value,
            (42, Some(vertex)) => vertex.bulge = value,
            _ => (),
        }
    }
    vertices
}

fn line(entity: &Entity) -> [PathVertex; 2] {
    let at =
        |x: i32, y: i32| PathVertex { point: Point::new(entity.number(x), entity.number(y)), bulge: 0.0 };
    [at(10, 20), at(11, 21)]
}

fn arc(entity: &Entity) -> [PathVertex; 2] {
    let centre = Point::new(entity.number(10), entity.number(20));
    let [from, to] = [50, 51].map(|code| entity.number(code));
    let at = |degrees: f64| centre + entity.number(40) * Vec2::from_angle(degrees.to_radians());
    let sweep = (to - from).rem_euclid(360.0).to_radians();
    [PathVertex { point: at(from), bulge: (0.25 * sweep).tan() }, PathVertex { point: at(to), bulge: 0.0 }]
}

/// Lengthens a path by a segment that begins or ends at its end; an ARC is always counter-clockwise.
fn join(path: &mut CutPath, segment: &[PathVertex; 2]) -> bool {
    let meets = |a: Point, b: Point| a.distance(b) <= SAME_POINT;
    let [start, end] = [segment[0].point, segment[1].point];
    let touches = |point: Point| meets(point, start) || meets(point, end);
    let last = path.vertices.len() - 1;
    if last == 1 && !touches(path.vertices[1].point) && touches(path.vertices[0].point) {
        path.vertices.reverse();
        path.vertices[0].bulge = -path.vertices[1].bulge;
        path.vertices[1].bulge = 0.0;
    }
    let tail = path.vertices[last].point;
    let (bulge, next) = match (meets(tail, start), meets(tail, end)) {
        (true, _) => (segment[0].bulge, end),
        (_, true) => (-segment[0].bulge, start),
        _ => return false,
    };
    path.vertices[last].bulge = bulge;
    if last > 0 && meets(next, path.vertices[0].point) {
        path.closed = true;
    } else {
        path.vertices.push(PathVertex { point: next, bulge: 0.0 });
    }
    true
}
