//! Whether two files hold the same cuts, in the same order.

use kurbo::{Point, Vec2};

use super::fault::{Check, Fault};
use super::machine_file::{MachineFile, layer_name};
use crate::fabrication::layout::{CutPath, PathVertex};

/// Largest distance between the two files, millimetres: twice the last digit of the SVG.
pub(super) const APART: f64 = 2e-6;
/// The same for the middles of arcs, which depend on a rounded radius as well.
const MIDDLES_APART: f64 = 1e-5;

/// How two files compare.
pub(super) struct Agreement {
    /// Largest distance between vertices that stand for each other.
    pub apart: f64,
    /// The first cut that differs.
    pub fault: Option<Fault>,
}

/// Compares two files cut by cut. The second one's arcs are split in parts of at most a quarter turn.
pub(super) fn compare(first: &MachineFile, second: &MachineFile) -> Agreement {
    let mut apart = 0.0_f64;
    let counts = [first, second].map(|file| file.paths.len());
    let fault = |what: String, at, says| Some(Fault::new(Check::Agreement, second.name, what, at, says));
    for (index, (a, b)) in first.paths.iter().zip(&second.paths).enumerate() {
        let at = b.vertices.first().map(|vertex| vertex.point);
        let what = format!("cut {index} ({})", layer_name(b.kind));
        if (a.kind, a.closed) != (b.kind, b.closed) {
            let open = |path: &CutPath| if path.closed { "closed" } else { "open" };
            let says =
                format!("is {}, in {} it is on {} and {}", open(b), first.name, layer_name(a.kind), open(a));
            return Agreement { apart, fault: fault(what, at, says) };
        }
        let (a, b) = (quarters(a), &b.vertices);
        if a.len() != b.len() {
            let says = format!("has {} vertices, in {} {}", b.len(), first.name, a.len());
            return Agreement { apart, fault: fault(what, at, says) };
        }
        for (i, (p, q)) in a.iter().zip(b).enumerate() {
            let distance = p.point.distance(q.point);
            apart = apart.max(distance);
            let next = |path: &[PathVertex]| path[(i + 1) % path.len()].point;
            let rise = |path: &[PathVertex]| 0.5 * path[i].bulge * path[i].point.distance(next(path));
            let middles = (rise(&a) - rise(b)).abs();
            // NaN is a difference.
            if !(distance <= APART && middles <= MIDDLES_APART) {
                let says = format!(
                    "vertex {i} is {:.6} mm from where it is in {}, the limit is {APART} mm",
                    distance.max(middles),
                    first.name
                );
                return Agreement { apart, fault: fault(what, Some(q.point), says) };
            }
        }
    }
    let differ = || {
        let says = format!("{} cuts, in {} {}", counts[1], first.name, counts[0]);
        fault("the drawing".to_owned(), None, format!("holds {says}"))
    };
    Agreement { apart, fault: if counts[0] == counts[1] { None } else { differ() } }
}

/// The vertices of a path with every arc split in equal parts of at most a quarter turn.
fn quarters(path: &CutPath) -> Vec<PathVertex> {
    let mut vertices = Vec::with_capacity(path.vertices.len());
    for (i, &vertex) in path.vertices.iter().enumerate() {
        let sweep = 4.0 * vertex.bulge.atan();
        // A quarter turn whose bulge is rounded up stays one part.
        let parts = (sweep.abs() / std::f64::consts::FRAC_PI_2 - 1e-9).ceil();
        if !(2.0..=4.0).contains(&parts) {
            vertices.push(vertex);
            continue;
        }
        let bulge = (0.25 * sweep / parts).tan();
        let (from, to) = (vertex.point, path.vertices[(i + 1) % path.vertices.len()].point);
        let centre = from.midpoint(to) + (0.5 / (0.5 * sweep).tan()) * (to - from).turn_90();
        for part in 0..parts as usize {
            let turn = Vec2::from_angle(sweep * part as f64 / parts);
            let arm = from - centre;
            let arm = Vec2::new(arm.x * turn.x - arm.y * turn.y, arm.x * turn.y + arm.y * turn.x);
            let point: Point = centre + arm;
            vertices.push(PathVertex { point, bulge });
        }
    }
    vertices
}
