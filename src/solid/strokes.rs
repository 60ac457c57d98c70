//! The centre lines of all grooves as one network, with the direction of the tool's axis at every node.
//!
//! At a ligament the tool stands along the hinge's axis: in front of it, where a slit or its bar ends, and along the groove
//! or border that passes it. Between ligaments the direction changes evenly along the line; where lines meet it is the
//! mean that keeps it even along all of them (harmonic). A groove has one direction for both walls: where two hinges face
//! each other across a groove, the layout has a line for each.

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::PI;

use kurbo::{Point, Vec2};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

use super::harmonic::fill;
use crate::fabrication::cuts::ARC_TOLERANCE;
use crate::fabrication::gaps::{held_beside, turned_beside};
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::layout::{CutKind, CutPath};
use crate::fabrication::web::{nearest_on_segment, segment_gap};

/// Points nearer to each other than this are one, millimetres: far above rounding, far below any cut.
const SAME: f64 = 1e-4;

/// Hinges whose walls stand as far off a line as this or less, besides ligament and groove, direct it, millimetres.
const PLAY: f64 = 0.02;

/// The network.
#[derive(Debug, Clone)]
pub struct Strokes {
    /// Ends, bends, meeting points, and where a hinge begins and ceases to direct the tool.
    pub nodes: Vec<Node>,
    /// Straight stretches between them.
    pub edges: Vec<Edge>,
    /// The tool's radius, millimetres.
    pub radius: f64,
    tree: RTree<GeomWithData<Line<[f64; 2]>, usize>>,
}

/// A point of a centre line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Where, at mid-plane.
    pub at: Point,
    /// The tool's axis: (dx/dz, dy/dz).
    pub lean: Vec2,
}

/// A stretch between two nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Its nodes.
    pub ends: [usize; 2],
    /// What it cuts.
    pub kind: CutKind,
    /// The path of the layout that it is part of.
    pub path: usize,
}

/// The point of the network that is nearest to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Where.
    pub at: Point,
    /// The tool's axis there.
    pub lean: Vec2,
    /// How far.
    pub distance: f64,
}

impl Strokes {
    /// The network of a layout. `radius`: of the tool or half the beam, millimetres.
    pub fn new(paths: &[CutPath], hinges: &[HingeRow], radius: f64) -> Self {
        let lines = lines(paths);
        let mut splits = joints(&lines);
        let holds = holds(&lines, hinges, radius, &mut splits);
        let mut builder = Builder::default();
        for (index, line) in lines.iter().enumerate() {
            builder.add(line, &mut splits[index], &holds[index]);
        }
        let Builder { nodes, edges, wishes, .. } = builder;
        let held: Vec<Option<Vec2>> = wishes.iter().map(|wishes| wished(wishes)).collect();
        let ends: Vec<[usize; 2]> = edges.iter().map(|edge| edge.ends).collect();
        let leans = fill(&nodes, &ends, &held);
        let nodes: Vec<Node> = nodes.iter().zip(leans).map(|(&at, lean)| Node { at, lean }).collect();
        let line = |(index, edge): (usize, &Edge)| {
            let [a, b] = edge.ends.map(|end| nodes[end].at);
            GeomWithData::new(Line::new([a.x, a.y], [b.x, b.y]), index)
        };
        let tree = RTree::bulk_load(edges.iter().enumerate().map(line).collect());
        Self { nodes, edges, radius, tree }
    }

    /// The nearest point of the network; `None` where it is empty.
    pub fn foot(&self, point: Point) -> Option<Foot> {
        let edge = self.tree.nearest_neighbor(&[point.x, point.y])?.data;
        let [a, b] = self.edges[edge].ends.map(|end| self.nodes[end]);
        let at = nearest_on_segment(point, [a.at, b.at]);
        let part = at.distance(a.at) / a.at.distance(b.at).max(f64::MIN_POSITIVE);
        Some(Foot { at, lean: a.lean.lerp(b.lean, part), distance: at.distance(point) })
    }

    /// Lets the tool stand upright everywhere, as on a machine with three axes.
    pub fn upright(&mut self) {
        self.nodes.iter_mut().for_each(|node| node.lean = Vec2::ZERO);
    }

    /// The largest lean of all.
    pub fn steepest(&self) -> f64 {
        self.nodes.iter().map(|node| node.lean.hypot()).fold(0.0, f64::max)
    }
}

/// A straight piece of a path.
struct Stretch {
    ends: [Point; 2],
    kind: CutKind,
    path: usize,
    /// Whether an open path ends there.
    terminal: [bool; 2],
}

impl Stretch {
    fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }

    /// Where on the stretch a point on it lies, millimetres from its beginning.
    fn along(&self, point: Point) -> f64 {
        self.ends[0].distance(nearest_on_segment(point, self.ends))
    }
}

/// Between which lengths along a stretch a hinge directs the tool, and how far it is.
struct Hold {
    from: f64,
    to: f64,
    /// The part of that in front of the ligament itself.
    ligament: [f64; 2],
    distance: f64,
    lean: Vec2,
}

fn lines(paths: &[CutPath]) -> Vec<Stretch> {
    let mut lines = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        let segments = path.segments(ARC_TOLERANCE);
        let last = segments.len().saturating_sub(1);
        lines.extend(segments.into_iter().enumerate().map(|(i, ends)| Stretch {
            ends,
            kind: path.kind,
            path: index,
            terminal: [!path.closed && i == 0, !path.closed && i == last],
        }));
    }
    lines
}

/// Where stretches meet other stretches, as lengths along each.
fn joints(lines: &[Stretch]) -> Vec<Vec<f64>> {
    let geometry = |(index, line): (usize, &Stretch)| {
        let [a, b] = line.ends;
        GeomWithData::new(Line::new([a.x, a.y], [b.x, b.y]), index)
    };
    let tree = RTree::bulk_load(lines.iter().enumerate().map(geometry).collect());
    let mut splits = vec![Vec::new(); lines.len()];
    for (index, line) in lines.iter().enumerate() {
        let [a, b] = line.ends;
        let low = [a.x.min(b.x) - SAME, a.y.min(b.y) - SAME];
        let high = [a.x.max(b.x) + SAME, a.y.max(b.y) + SAME];
        let near = tree.locate_in_envelope_intersecting(&AABB::from_corners(low, high));
        for other in near.map(|line| line.data).filter(|&other| other != index) {
            let (gap, at) = segment_gap(line.ends, lines[other].ends);
            if gap <= SAME {
                splits[index].push(line.along(at));
            }
        }
    }
    splits
}

/// Who directs the tool where; adds the ends of these intervals to `splits`.
fn holds(lines: &[Stretch], hinges: &[HingeRow], radius: f64, splits: &mut [Vec<f64>]) -> Vec<Vec<Hold>> {
    let geometry = |(index, line): (usize, &Stretch)| {
        let [a, b] = line.ends;
        GeomWithData::new(Line::new([a.x, a.y], [b.x, b.y]), index)
    };
    let tree = RTree::bulk_load(lines.iter().enumerate().map(geometry).collect());
    let mut holds: Vec<Vec<Hold>> = lines.iter().map(|_| Vec::new()).collect();
    for row in hinges {
        let point = Point::new(row.point.x, row.point.y);
        let reach = 0.5 * row.width + radius + row.pole_offset.abs() + row.centre_offset + PLAY;
        // As long as the straight stretch by which a slit passes a ligament.
        let half = 0.5 * row.length + 2.0 * radius;
        let least = held_beside(row.length, radius);
        let lean = Vec2::new(row.axis.x, row.axis.y) / row.axis.z;
        let mut near: Vec<usize> =
            tree.locate_within_distance([point.x, point.y], reach * reach).map(|line| line.data).collect();
        near.sort_unstable();
        for index in near {
            let line = &lines[index];
            let foot = nearest_on_segment(point, line.ends);
            let (at, length) = (line.along(foot), line.length());
            let ends_here = (at <= SAME && line.terminal[0]) || (at >= length - SAME && line.terminal[1]);
            let [half, least] = if ends_here { [0.0; 2] } else { [half, least] };
            let (from, to) = ((at - half).max(0.0), (at + half).min(length));
            let ligament = [at - least, at + least];
            holds[index].push(Hold { from, to, ligament, distance: foot.distance(point), lean });
        }
    }
    give_way(lines, radius, &mut holds);
    for (splits, holds) in splits.iter_mut().zip(&holds) {
        splits.extend(holds.iter().flat_map(|hold| [hold.from, hold.to]));
    }
    holds
}

/// Where two sides of a window meet, each directed by a hinge of its own, both let go beside their ligaments, and
/// close to the place the axis has the mean direction: so it has room to turn, and the walls that meet there run alike. This is so at the corners of the polygon in the middle of three slits.
fn give_way(lines: &[Stretch], radius: f64, holds: &mut [Vec<Hold>]) {
    // Ends beside which a line is held.
    let mut ends: BTreeMap<[i64; 2], Vec<(usize, usize, usize)>> = BTreeMap::new();
    for (index, (line, holds)) in lines.iter().zip(holds.iter()).enumerate() {
        for (number, hold) in holds.iter().enumerate() {
            let beyond = [hold.ligament[0] - hold.from, hold.to - hold.ligament[1]];
            let short = [hold.from, line.length() - hold.to];
            let near = |side: &usize| 2.0 * short[*side] <= line.length() && beyond[*side] > SAME;
            for side in (0..2).filter(|side| line.kind == CutKind::Window && near(side)) {
                let at = line.ends[side];
                let cell = [at.x, at.y].map(|c| (c / SAME).round() as i64);
                ends.entry(cell).or_default().push((index, number, side));
            }
        }
    }
    for meeting in ends.values() {
        let lean = |&(line, number, _): &(usize, usize, usize)| holds[line][number].lean;
        let turns = meeting.iter().any(|end| (lean(end) - lean(&meeting[0])).hypot() > SAME);
        if !turns || meeting.iter().all(|end| end.0 == meeting[0].0) {
            continue;
        }
        let mean = meeting.iter().map(lean).fold(Vec2::ZERO, |sum, lean| sum + lean) / meeting.len() as f64;
        let along = |&(line, _, side): &(usize, usize, usize)| {
            let [from, to] = lines[line].ends;
            if side == 0 { to - from } else { from - to }
        };
        let opening =
            |end| along(end).cross(along(&meeting[0])).abs().atan2(along(end).dot(along(&meeting[0])));
        let turn = PI - meeting.iter().map(opening).fold(0.0, f64::max);
        let apart = turned_beside(turn, radius);
        for &(line, number, side) in meeting {
            let length = lines[line].length();
            let hold = &mut holds[line][number];
            let (from, to) = if side == 0 {
                hold.from = hold.ligament[0];
                (0.0, apart.min(hold.from))
            } else {
                hold.to = hold.ligament[1];
                ((length - apart).max(hold.to), length)
            };
            let turned = Hold { from, to, lean: mean, ..*hold };
            holds[line].push(turned);
        }
    }
}

/// Nodes and edges as they come.
#[derive(Default)]
struct Builder {
    nodes: Vec<Point>,
    edges: Vec<Edge>,
    /// Which hinges want which direction at each node: distance and lean.
    wishes: Vec<Vec<(f64, Vec2)>>,
    cells: HashMap<[i64; 2], Vec<usize>>,
    known: HashMap<[usize; 2], usize>,
}

impl Builder {
    fn add(&mut self, line: &Stretch, splits: &mut Vec<f64>, holds: &[Hold]) {
        let length = line.length();
        splits.retain(|&at| at > 10.0 * SAME && at < length - 10.0 * SAME);
        splits.sort_by(f64::total_cmp);
        splits.dedup_by(|b, a| *b - *a < 10.0 * SAME);
        let [a, b] = line.ends;
        let mut last: Option<usize> = None;
        for at in [0.0].into_iter().chain(splits.iter().copied()).chain([length]) {
            // The ends as they are: rounding must not part them from their neighbours.
            let point = if at == length { b } else { a + at / length.max(f64::MIN_POSITIVE) * (b - a) };
            let node = self.node(point);
            let wanted =
                holds.iter().filter(|hold| at > hold.from - 20.0 * SAME && at < hold.to + 20.0 * SAME);
            self.wishes[node].extend(wanted.map(|hold| (hold.distance, hold.lean)));
            if let Some(last) = last.filter(|&last| last != node) {
                let key = [last.min(node), last.max(node)];
                if self.known.insert(key, self.edges.len()).is_none() {
                    self.edges.push(Edge { ends: [last, node], kind: line.kind, path: line.path });
                }
            }
            last = Some(node);
        }
    }

    /// The node at a point, a new one if there is none yet.
    fn node(&mut self, point: Point) -> usize {
        let cell = [point.x, point.y].map(|c| (c / (4.0 * SAME)).floor() as i64);
        for near in [-1, 0, 1].into_iter().flat_map(|i| [-1, 0, 1].map(|j| [cell[0] + i, cell[1] + j])) {
            let found = self.cells.get(&near).into_iter().flatten();
            if let Some(&node) =
                found.into_iter().find(|&&node| self.nodes[node].distance(point) <= 2.0 * SAME)
            {
                return node;
            }
        }
        let node = self.nodes.len();
        self.nodes.push(point);
        self.wishes.push(Vec::new());
        self.cells.entry(cell).or_default().push(node);
        node
    }
}

/// The direction that the nearest hinge wants; the mean where several are as near.
fn wished(wishes: &[(f64, Vec2)]) -> Option<Vec2> {
    let nearest = wishes.iter().map(|wish| wish.0).reduce(f64::min)?;
    let (sum, count) = wishes
        .iter()
        .filter(|wish| wish.0 < nearest + 10.0 * SAME)
        .fold((Vec2::ZERO, 0.0), |(sum, count), wish| (sum + wish.1, count + 1.0));
    Some(sum / count)
}
