//! Which state is flat, the sheet's frame, and the scale.

use super::error::ImportError;
use super::source::Source;
use super::{Size, joints::row};
use crate::geometry::plane::{Plane, doubled_area};
use crate::geometry::{Point3, bounds};
use crate::kirigami::design::State;
use crate::kirigami::rigidity::mean_side;

/// A state is flat where no point is farther from its plane, in mean sides of the pieces.
const FLAT: f64 = 1e-4;

/// Largest absolute coordinate, millimetres: a thousand kilometres.
const MAX_COORDINATE: f64 = 1e9;

/// Finds the flat state, the closed one where both are, and lays it on z = 0 such that most pieces run
/// counter-clockwise seen from above. Where neither is flat everything stays as it is.
///
/// # Errors
/// Points that are all one.
pub fn lay_flat(source: &mut Source) -> Result<Option<State>, ImportError> {
    let side = mean_side(&source.closed);
    if side.is_nan() || side <= 0.0 {
        return Err(ImportError::NoExtent);
    }
    for state in [State::Closed, State::Open] {
        let polygons = polygons(source, state);
        let points = row(polygons);
        let mut plane = Plane::fit(&points);
        if points.iter().any(|p| plane.distance(p).abs() > FLAT * side) {
            continue;
        }
        let upwards = polygons.iter().filter(|p| doubled_area(p).dot(&plane.normal) > 0.0).count();
        if 2 * upwards < polygons.len() {
            plane.normal = -plane.normal;
        }
        let motion = plane.laid_flat();
        for p in polygons_mut(source, state).iter_mut().flatten() {
            let laid = motion.apply(p);
            // Adding 0 turns -0 into 0.
            *p = Point3::new(laid.x + 0.0, laid.y + 0.0, 0.0);
        }
        return Ok(Some(state));
    }
    Ok(None)
}

/// Scales both states to millimetres.
///
/// # Errors
/// Coordinates that become too large.
pub fn scale(source: &mut Source, sheet_state: Option<State>, size: Size) -> Result<(), ImportError> {
    let factor = match size {
        Size::Scale(factor) => factor,
        Size::Extent(extent) => {
            let points = row(polygons(source, sheet_state.unwrap_or(State::Closed)));
            let (low, high) = bounds(&points);
            extent / (high - low).max()
        }
    };
    for p in source.closed.iter_mut().chain(&mut source.open).flatten() {
        *p *= factor;
        if let Some(value) = p.iter().find(|c| !c.is_finite() || c.abs() > MAX_COORDINATE) {
            return Err(ImportError::TooLarge { value: *value, limit: MAX_COORDINATE });
        }
    }
    Ok(())
}

fn polygons(source: &Source, state: State) -> &Vec<Vec<Point3>> {
    match state {
        State::Closed => &source.closed,
        State::Open => &source.open,
    }
}

fn polygons_mut(source: &mut Source, state: State) -> &mut Vec<Vec<Point3>> {
    match state {
        State::Closed => &mut source.closed,
        State::Open => &mut source.open,
    }
}
