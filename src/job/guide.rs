//! The `[[guide]]` tables: what a state without a target is to come near.
//!
//! ```toml
//! [[guide]]
//! closed = [0.0, 0.0, 12.5]   # a place on the closed surface, in the coordinates and units of the mesh file
//! open = [0.0, 0.0, 40.0]     # where it shall be in the open state, likewise; or: fixed = true, where it is
//! weight = 1.0                # may be left out
//!
//! [[guide]]
//! closed_curve = "seam.obj"   # polylines (`l` elements) on the closed surface
//! open_curve = "arch.obj"     # polylines that these places shall come to lie on; or: fixed = true, on the first
//! ```
//!
//! All coordinates are scaled as the closed mesh is. Open curves go on straight beyond their ends.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::read::mesh_path;
use super::{Shape, Target};
use crate::geometry::Point3;
use crate::toml_source::{Limits, TomlError, TomlSource};

/// A guide in the units of the mesh file.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    /// What is guided, and where it shall be.
    pub way: GuideWay,
    /// Factor of the squares beside other guides.
    pub weight: f64,
}

/// What is guided, and where it shall be.
#[derive(Debug, Clone, PartialEq)]
pub enum GuideWay {
    /// A place of the closed surface, and its place in the open state.
    Point {
        /// In the closed state.
        closed: Point3,
        /// In the open one.
        open: Point3,
    },
    /// Polylines on the closed surface, and those that they shall lie on: paths of OBJ files.
    Curve {
        /// In the closed state.
        closed: PathBuf,
        /// In the open one.
        open: PathBuf,
    },
}

impl Guide {
    /// Its files, each once.
    pub fn files(&self) -> Vec<&Path> {
        match &self.way {
            GuideWay::Point { .. } => Vec::new(),
            GuideWay::Curve { closed, open } if closed == open => vec![closed],
            GuideWay::Curve { closed, open } => vec![closed, open],
        }
    }
}

const WEIGHT: Limits = Limits::new(
    1.0e-3,
    1.0e3,
    "",
    "beyond a thousand the guide bends pieces, below a thousandth it does nothing",
);

const COORDINATE: Limits =
    Limits::new(-1.0e6, 1.0e6, "", "a place near the target, in the units of its mesh file");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawGuide {
    closed: Option<Spanned<Vec<Spanned<f64>>>>,
    open: Option<Spanned<Vec<Spanned<f64>>>>,
    closed_curve: Option<Spanned<String>>,
    open_curve: Option<Spanned<String>>,
    fixed: Option<Spanned<bool>>,
    weight: Option<Spanned<f64>>,
}

/// The guides of a job.
pub(super) fn guides(
    source: &TomlSource,
    raw: &[Spanned<RawGuide>],
    target: &Target,
    folder: &Path,
) -> Result<Vec<Guide>, TomlError> {
    if let (Some(first), true) = (raw.first(), target.open != Shape::Free) {
        let help = "a guide shapes an open state without a target; where there is one, that decides";
        return Err(source.error(first.span(), "guides go with open = \"free\" only", help));
    }
    raw.iter().map(|guide| read(source, guide, folder)).collect()
}

fn read(source: &TomlSource, raw: &Spanned<RawGuide>, folder: &Path) -> Result<Guide, TomlError> {
    let guide = raw.get_ref();
    let fixed = match &guide.fixed {
        Some(value) if !value.get_ref() => {
            let help = "say where the guided place shall be with open or open_curve, and leave fixed out";
            return Err(source.value_error(value.span(), "not a guide: allowed is true", help));
        }
        value => value.is_some(),
    };
    let wrong = |what: &str| {
        let help =
            "a guide has closed with open, closed_curve with open_curve, or either with fixed = true alone";
        source.error(raw.span(), what, help)
    };
    let way = match (&guide.closed, &guide.open, &guide.closed_curve, &guide.open_curve, fixed) {
        (Some(closed), Some(open), None, None, false) => {
            GuideWay::Point { closed: point(source, closed)?, open: point(source, open)? }
        }
        (Some(closed), None, None, None, true) => {
            let place = point(source, closed)?;
            GuideWay::Point { closed: place, open: place }
        }
        (None, None, Some(closed), Some(open), false) => GuideWay::Curve {
            closed: mesh_path(source, closed, folder)?,
            open: mesh_path(source, open, folder)?,
        },
        (None, None, Some(closed), None, true) => {
            let path = mesh_path(source, closed, folder)?;
            GuideWay::Curve { closed: path.clone(), open: path }
        }
        (None, _, None, _, _) => return Err(wrong("the guide has neither closed nor closed_curve")),
        (Some(_), _, Some(_), _, _) => return Err(wrong("the guide has both closed and closed_curve")),
        (_, None, _, None, false) => return Err(wrong("the guide does not say where to")),
        _ => return Err(wrong("the guide's keys do not go together")),
    };
    let weight = source.optional(guide.weight.as_ref(), &WEIGHT)?.unwrap_or(1.0);
    Ok(Guide { way, weight })
}

fn point(source: &TomlSource, value: &Spanned<Vec<Spanned<f64>>>) -> Result<Point3, TomlError> {
    let [x, y, z] = &value.get_ref()[..] else {
        let what = format!("{} numbers: allowed are three", value.get_ref().len());
        return Err(source.value_error(value.span(), &what, "x, y and z"));
    };
    let read = |number| source.number(number, &COORDINATE);
    Ok(Point3::new(read(x)?, read(y)?, read(z)?))
}
