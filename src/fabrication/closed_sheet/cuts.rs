//! All cuts of a sheet before they are put in order, and which cuts bound which ligament.

use kurbo::{Point, Vec2};

use super::border::border_vertices;
use super::frame::CornerKind;
use super::slit::{Plan, Slit, relief_bar, slits};
use crate::fabrication::cuts::{ARC_TOLERANCE, Touch};
use crate::fabrication::error::FabricationError;
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};
use crate::fabrication::topology::Edge;
use crate::fabrication::web::nearest_on_segment;

/// The cuts, in no useful order: slits, then one relief bar per hinge that is no round notch, then the border loops.
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
    /// Its relief bar; `None` where the slit's own round end is the notch.
    pub relief: Option<usize>,
    /// The slit that ends on the relief bar; two where its walls are cut each for itself.
    pub slits: Vec<usize>,
    /// What bounds the ligament on its other side: the slit that passes, the border, or several cuts.
    pub passing: Vec<usize>,
    /// The relief bars and slits of the corner's other hinges, across the slits that pass.
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
    let bars: Vec<Option<usize>> = reliefs
        .iter()
        .map(|(_, bar)| {
            // Nanometres of rounding make no bar.
            let drawn = bar[0].distance(bar[1]) > 1e-6;
            drawn.then(|| paths.push(open_path(CutKind::Relief, bar)));
            drawn.then(|| paths.len() - 1)
        })
        .collect();
    let mut cuts_at = cuts_at_corners(plan, &slits, paths.len());
    paths.extend(loops);
    for (&corner, junction) in plan.junctions.iter().filter(|(_, junction)| junction.closed) {
        cuts_at[corner].push(paths.len());
        let mut window = open_path(CutKind::Window, &junction.outline);
        window.vertices.reverse(); // clockwise, as all windows
        window.closed = true;
        paths.push(window);
    }
    let (hinges, mut touches) = hinge_cuts(plan, &slits, &reliefs, &bars, &cuts_at);
    touches.extend(slit_touches(&slits, &paths, &cuts_at));
    touches.extend(wall_touches(&slits, plan.kerf));
    Ok(CutSet { paths, hinges, touches, slits })
}

/// With every side longer than the hinge points' shifts at its ends all directions are well defined.
fn check_sides(plan: &Plan<'_>) -> Result<(), FabricationError> {
    for edge in &plan.topology.edges {
        let limit = plan.gap
            * match edge.right {
                _ if !is_plain(plan, edge) => 2.0,
                Some(_) => 1.0,
                // Half a ligament stands outside of the border's corner: so a flap there is a ligament's width wide.
                None => 0.5,
            };
        let [from, to] = edge.ends.map(|corner| plan.frames[corner].middle);
        let (length, Point { x, y }) = (from.distance(to), from.midpoint(to));
        if length <= limit {
            return Err(FabricationError::ShortEdge { corners: edge.ends, x, y, length, limit });
        }
    }
    Ok(())
}

/// Whether no hinge points are shifted at the ends of an edge: along slits of bistable sheets that hold nothing, and at
/// the border where only such slits run out.
fn is_plain(plan: &Plan<'_>, edge: &Edge) -> bool {
    let plain = |corner: usize| match plan.frames[corner].kind {
        CornerKind::Exit { exit } => plan.topology.edges[exit].hinge.is_none(),
        kind => kind == CornerKind::Free,
    };
    edge.hinge.is_none() && (edge.right.is_some() || edge.ends.into_iter().all(plain))
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

/// The slits at each corner and the border loop that passes it: indices of paths.
fn cuts_at_corners(plan: &Plan<'_>, slits: &[Slit], first_loop: usize) -> Vec<Vec<usize>> {
    let mut cuts = vec![Vec::new(); plan.frames.len()];
    for (index, slit) in slits.iter().enumerate() {
        slit.corners.iter().for_each(|&corner| cuts[corner].push(index));
    }
    for (index, border) in plan.topology.loops.iter().enumerate() {
        for &edge in border {
            cuts[plan.topology.edges[edge].ends[0]].push(first_loop + index);
        }
    }
    cuts
}

/// Where slits meet other cuts of their corner: points on one another to within rounding.
fn slit_touches(slits: &[Slit], paths: &[CutPath], cuts_at: &[Vec<usize>]) -> Vec<Touch> {
    let mut touches = Vec::new();
    for (index, slit) in slits.iter().enumerate() {
        let [first, last] = [slit.points[0], slit.points[slit.points.len() - 1]];
        let mut others: Vec<usize> =
            slit.corners.iter().flat_map(|&corner| &cuts_at[corner]).copied().collect();
        others.sort_unstable();
        others.dedup();
        others.retain(|&other| other != index);
        for point in [first, last] {
            let on = |&other: &usize| {
                let mut segments = paths[other].segments(ARC_TOLERANCE).into_iter();
                segments.any(|segment| nearest_on_segment(point, segment).distance(point) < 1e-6)
            };
            touches.extend(others.iter().copied().filter(on).map(|o| Touch { paths: [index, o], point }));
        }
        if slit.hinges == [None, None] {
            // The short slit of a cut's end: what it joins comes near each other too.
            touches.extend(pairs(&others).map(|paths| Touch { paths, point: first.midpoint(last) }));
        }
    }
    touches
}

/// Along the two walls of a slit that are cut each for itself; a kerf apart, so that no place between is far from one.
fn wall_touches(slits: &[Slit], kerf: f64) -> Vec<Touch> {
    let mut touches = Vec::new();
    for (first, pair) in slits.windows(2).enumerate() {
        if pair[0].corners != pair[1].corners || pair[0].hinges != pair[1].hinges {
            continue;
        }
        for ends in pair[0].points.windows(2) {
            let count = (ends[0].distance(ends[1]) / kerf).ceil().max(1.0);
            let at = (0..=count as usize).map(|i| ends[0].lerp(ends[1], i as f64 / count));
            touches.extend(at.map(|point| Touch { paths: [first, first + 1], point }));
        }
    }
    touches
}

fn pairs(items: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    (0..items.len()).flat_map(move |i| (i + 1..items.len()).map(move |j| [items[i], items[j]]))
}

fn hinge_cuts(
    plan: &Plan<'_>,
    slits: &[Slit],
    reliefs: &[(usize, [Point; 2])],
    bars: &[Option<usize>],
    cuts_at: &[Vec<usize>],
) -> (Vec<HingeCuts>, Vec<Touch>) {
    let mut slits_of_hinge = vec![Vec::new(); reliefs.len()];
    for (index, slit) in slits.iter().enumerate() {
        for hinge in slit.hinges.iter().flatten() {
            slits_of_hinge[*hinge].push(index);
        }
    }
    let mut hinges = Vec::with_capacity(reliefs.len());
    let mut touches = Vec::new();
    for (id, &(edge, _)) in reliefs.iter().enumerate() {
        let (Some((end, normal)), Some(hinge)) = (plan.slit_end(edge), plan.topology.edges[edge].hinge)
        else {
            continue; // reliefs exist for hinged edges only
        };
        let relief = bars[id];
        let passing = cuts_at[hinge.corner].clone();
        let edges = &plan.topology.fans[hinge.corner].edges;
        let others = edges.iter().filter_map(|&other| plan.topology.edges[other].hinge_at(hinge.corner));
        let others = others.filter(|&other| other != id);
        let across =
            others.flat_map(|other| bars[other].into_iter().chain(slits_of_hinge[other].iter().copied()));
        let across = across.collect();
        let own = slits_of_hinge[id].clone();
        let meet = relief.into_iter().flat_map(|relief| own.iter().map(move |&slit| [slit, relief]));
        touches.extend(meet.map(|paths| Touch { paths, point: end }));
        hinges.push(HingeCuts { relief, slits: own, passing, across, normal });
    }
    (hinges, touches)
}
