//! Once around every opening: the order in which a tool follows the centre lines.
//!
//! The tool goes round with the material to its right, so a tool that turns clockwise cuts in climb everywhere, and every
//! groove is passed twice, once for either wall: there and back along one centre line, or where two hinges face each other
//! along the line of each. At a groove's end it turns in its place.

use std::f64::consts::PI;

use kurbo::Point;

use super::toolpath::Contour;
use crate::fabrication::layout::CutKind;
use crate::solid::strokes::Strokes;

/// A closed walk along a network.
#[derive(Debug, Clone, PartialEq)]
pub struct Walk {
    /// What it goes around.
    pub contour: Contour,
    /// Nodes of the network, the first not repeated at the end.
    pub nodes: Vec<usize>,
}

/// All walks: openings in the order of the layout's paths, then borders. Every stretch of the network is on one.
pub fn walks(strokes: &Strokes) -> Vec<Walk> {
    let mut inner = Tracer::new(strokes, |kind| kind != CutKind::Border);
    let mut border = Tracer::new(strokes, |kind| kind == CutKind::Border);
    let mut walks = inner.openings();
    walks.extend(border.borders());
    walks
}

/// Follows half edges: 2 e runs along edge e, 2 e + 1 against it.
struct Tracer<'a> {
    strokes: &'a Strokes,
    /// Half edges that leave each node, counter-clockwise from the direction -x.
    leaving: Vec<Vec<usize>>,
    seen: Vec<bool>,
}

impl<'a> Tracer<'a> {
    fn new(strokes: &'a Strokes, wanted: impl Fn(CutKind) -> bool) -> Self {
        let mut leaving = vec![Vec::new(); strokes.nodes.len()];
        for (index, edge) in strokes.edges.iter().enumerate().filter(|(_, edge)| wanted(edge.kind)) {
            leaving[edge.ends[0]].push(2 * index);
            leaving[edge.ends[1]].push(2 * index + 1);
        }
        let mut tracer = Self { strokes, leaving, seen: vec![false; strokes.edges.len()] };
        for node in 0..tracer.leaving.len() {
            let mut around = std::mem::take(&mut tracer.leaving[node]);
            around.sort_by(|&a, &b| tracer.angle(a).total_cmp(&tracer.angle(b)));
            tracer.leaving[node] = around;
        }
        tracer
    }

    fn tail(&self, half: usize) -> usize {
        self.strokes.edges[half / 2].ends[half % 2]
    }

    fn at(&self, node: usize) -> Point {
        self.strokes.nodes[node].at
    }

    fn angle(&self, half: usize) -> f64 {
        let angle = (self.at(self.tail(half ^ 1)) - self.at(self.tail(half))).atan2();
        if angle == PI { -PI } else { angle }
    }

    /// The half edges around the face to the right of one.
    fn face(&mut self, start: usize) -> Vec<usize> {
        let mut face = Vec::new();
        let mut half = start;
        loop {
            face.push(half);
            self.seen[half / 2] = true;
            let back = half ^ 1;
            let around = &self.leaving[self.tail(back)];
            let place = around.iter().position(|&other| other == back).unwrap_or(0);
            half = around[(place + 1) % around.len()];
            if half == start {
                return face;
            }
        }
    }

    fn walk(&self, contour: Contour, face: &[usize]) -> Walk {
        Walk { contour, nodes: face.iter().map(|&half| self.tail(half)).collect() }
    }

    /// Around each connected part, its outside to the right; then around what that leaves out.
    fn openings(&mut self) -> Vec<Walk> {
        let mut walks: Vec<(usize, Walk)> = Vec::new();
        let mut known = vec![false; self.leaving.len()];
        for node in 0..self.leaving.len() {
            if known[node] || self.leaving[node].is_empty() {
                continue;
            }
            let part = self.part(node, &mut known);
            let key = |&node: &usize| (self.at(node).x, self.at(node).y);
            let leftmost = part.iter().copied().min_by(|a, b| {
                let ((ax, ay), (bx, by)) = (key(a), key(b));
                ax.total_cmp(&bx).then(ay.total_cmp(&by))
            });
            let Some(start) = leftmost.and_then(|node| self.leaving[node].first().copied()) else { continue };
            let mut faces = vec![self.face(start)];
            let all: Vec<usize> = part.iter().flat_map(|&node| self.leaving[node].clone()).collect();
            for half in all {
                if !self.seen[half / 2] {
                    faces.push(self.face(half));
                }
            }
            for face in faces {
                let first = face.iter().map(|half| self.strokes.edges[half / 2].path).min().unwrap_or(0);
                walks.push((first, self.walk(Contour::Opening, &face)));
            }
        }
        walks.sort_by_key(|(first, _)| *first);
        walks.into_iter().map(|(_, walk)| walk).collect()
    }

    /// Around each part of the network, the stock's rest to the left.
    fn borders(&mut self) -> Vec<Walk> {
        let mut walks = Vec::new();
        for half in (0..self.leaving.len()).flat_map(|node| self.leaving[node].clone()).collect::<Vec<_>>() {
            if self.seen[half / 2] {
                continue;
            }
            let mut walk = {
                let face = self.face(half);
                self.walk(Contour::Border, &face)
            };
            let corner = |i: usize| self.at(walk.nodes[i % walk.nodes.len()]).to_vec2();
            let area: f64 = (0..walk.nodes.len()).map(|i| corner(i).cross(corner(i + 1))).sum();
            if area > 0.0 {
                walk.nodes.reverse();
            }
            walks.push(walk);
        }
        walks
    }

    /// The nodes that hang together with one.
    fn part(&self, node: usize, known: &mut [bool]) -> Vec<usize> {
        let mut part = vec![node];
        known[node] = true;
        let mut next = 0;
        while next < part.len() {
            for &half in &self.leaving[part[next]] {
                let far = self.tail(half ^ 1);
                if !known[far] {
                    known[far] = true;
                    part.push(far);
                }
            }
            next += 1;
        }
        part
    }
}
