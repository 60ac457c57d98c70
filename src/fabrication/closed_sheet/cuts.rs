//! All cuts of a sheet before they are put in order, and which cuts bound which ligament.

use kurbo::{Point, Vec2};

use super::border::border_vertices;
use super::frame::CornerKind;
use super::slit::{Plan, Slit, relief_bar, slits};
use crate::fabrication::cuts::Touch;
use crate::fabrication::error::FabricationError;
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};

/// The cuts, in no useful order: slits, then one relief bar per hinge, then the border loops.
#[derive(Debug, Clone, PartialEq)]
pub struct CutSet {
    /// The paths.
    pub paths: Vec<CutPath>,
    /// Which paths belong to which hinge, in the hinges' order.
    pub hinges: Vec<HingeCuts>,
    /// Pairs of paths that meet on purpose, and where.
    pub touches: Vec<Touch>,
    /// The slits: `slits[i]` is `paths[i]`.
    pub slits: Vec<Slit>,
}

/// The cuts around one ligament: indices into [`CutSet::paths`].
#[derive(Debug, Clone, PartialEq)]
pub struct HingeCuts {
    /// Its relief bar.
    pub relief: usize,
    /// The slit that ends on the relief bar.
    pub slit: usize,
    /// What bounds the ligament on its other side: the slit that passes, the border, or both.
    pub passing: Vec<usize>,
    /// The opposite hinge's relief bar and slit, across the slit that passes.
    pub across: Vec<usize>,
    /// Unit direction of the hinged edge, from the hinge.
    pub normal: Vec2,
}

/// Builds all cuts.
///
/// # Errors
/// A side shorter than twice the gap, or several outer borders.
pub fn cut_set(plan: &Plan<'_>) -> Result<CutSet, FabricationError> {
    check_sides(plan)?;
    let slits = slits(plan);
    let reliefs = reliefs(plan);
    let loops = loops(plan)?;
    let mut paths: Vec<CutPath> = slits.iter().map(|slit| open_path(CutKind::Slit, &slit.points)).collect();
    paths.extend(reliefs.iter().map(|(_, bar)| open_path(CutKind::Relief, bar)));
    let first_loop = paths.len();
    paths.extend(loops);
    let loop_at = loop_at_corner(plan, first_loop);
    let (hinges, mut touches) = hinge_cuts(plan, &slits, &reliefs, &loop_at);
    for (index, slit) in slits.iter().enumerate() {
        if let (true, Some(border), Some(&point)) = (slit.exits, loop_at[slit.corner], slit.points.last()) {
            touches.push(Touch { paths: [index, border], point });
        }
    }
    Ok(CutSet { paths, hinges, touches, slits })
}

/// With every side longer than the hinge points' shifts at its ends all directions are well defined.
fn check_sides(plan: &Plan<'_>) -> Result<(), FabricationError> {
    let limit = 2.0 * plan.gap;
    for edge in &plan.topology.edges {
        let [from, to] = edge.ends.map(|corner| plan.frames[corner].middle);
        let (length, Point { x, y }) = (from.distance(to), from.midpoint(to));
        if length <= limit {
            return Err(FabricationError::ShortEdge { corners: edge.ends, x, y, length, limit });
        }
    }
    Ok(())
}

fn open_path(kind: CutKind, points: &[Point]) -> CutPath {
    let vertices = points.iter().map(|&point| PathVertex { point, bulge: 0.0 }).collect();
    CutPath { kind, vertices, closed: false }
}

/// Hinged edge and relief bar per hinge, in the hinges' order.
fn reliefs(plan: &Plan<'_>) -> Vec<(usize, [Point; 2])> {
    let mut bars: Vec<_> = (0..plan.topology.edges.len())
        .filter_map(|edge| Some((plan.topology.edges[edge].hinge?.id, (edge, relief_bar(plan, edge)?))))
        .collect();
    bars.sort_by_key(|&(hinge, _)| hinge);
    bars.into_iter().map(|(_, bar)| bar).collect()
}

fn loops(plan: &Plan<'_>) -> Result<Vec<CutPath>, FabricationError> {
    let mut outer = 0;
    let mut paths = Vec::new();
    for border in &plan.topology.loops {
        let vertices = border_vertices(plan, border);
        let area: f64 = (0..vertices.len())
            .map(|i| {
                let next = vertices[(i + 1) % vertices.len()].point;
                0.5 * vertices[i].point.to_vec2().cross(next.to_vec2())
            })
            .sum();
        outer += usize::from(area > 0.0);
        let kind = if area > 0.0 { CutKind::Border } else { CutKind::Window };
        paths.push(CutPath { kind, vertices, closed: true });
    }
    if outer == 1 { Ok(paths) } else { Err(FabricationError::SeveralParts { count: outer }) }
}

/// The path of the border loop that passes each corner.
fn loop_at_corner(plan: &Plan<'_>, first_loop: usize) -> Vec<Option<usize>> {
    let mut loop_at = vec![None; plan.frames.len()];
    for (index, border) in plan.topology.loops.iter().enumerate() {
        for &edge in border {
            loop_at[plan.topology.edges[edge].ends[0]] = Some(first_loop + index);
        }
    }
    loop_at
}

fn hinge_cuts(
    plan: &Plan<'_>,
    slits: &[Slit],
    reliefs: &[(usize, [Point; 2])],
    loop_at: &[Option<usize>],
) -> (Vec<HingeCuts>, Vec<Touch>) {
    let mut slit_of_hinge = vec![0; reliefs.len()];
    let mut slit_at = vec![None; plan.frames.len()];
    for (index, slit) in slits.iter().enumerate() {
        slit_at[slit.corner] = Some(index);
        for hinge in slit.hinges.iter().flatten() {
            slit_of_hinge[*hinge] = index;
        }
    }
    let mut hinges = Vec::with_capacity(reliefs.len());
    let mut touches = Vec::new();
    for (id, &(edge, _)) in reliefs.iter().enumerate() {
        let (Some((end, normal)), Some(hinge)) = (plan.slit_end(edge), plan.topology.edges[edge].hinge)
        else {
            continue; // reliefs exist for hinged edges only
        };
        let relief = slits.len() + id;
        let passing = slit_at[hinge.corner].into_iter().chain(loop_at[hinge.corner]).collect();
        let across = match plan.frames[hinge.corner].kind {
            CornerKind::Inner { hinged, .. } => {
                let others = plan.hinges_of(&hinged).into_iter().filter(|&other| other != id);
                others.flat_map(|other| [slits.len() + other, slit_of_hinge[other]]).collect()
            }
            _ => Vec::new(),
        };
        touches.push(Touch { paths: [slit_of_hinge[id], relief], point: end });
        hinges.push(HingeCuts { relief, slit: slit_of_hinge[id], passing, across, normal });
    }
    (hinges, touches)
}
