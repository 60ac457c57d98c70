//! The surface with its coordinates, ready to be walked along grid lines: charts of triangles, whole-number
//! transitions between them, and a narrow skirt beyond the boundary.
//!
//! Walking decides on which side of a line a corner lies, and must never be in doubt. So the corners it looks at
//! are moved by tiny amounts, the same in both triangles of an edge; positions come from the true ones.

use super::comb::Combed;
use super::fit::Grid;
use super::links::Links;
use super::map::SurfaceMap;
use crate::geometry::{Point3, Vector2, Vector3};
use std::collections::BTreeMap;

/// Way over an edge: where it leads, and how coordinates change.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// The triangle on the other side.
    pub face: usize,
    /// The edge's number there.
    pub edge: usize,
    /// Quarter turns of coordinates.
    pub quarters: u8,
    /// Shift after the turn, whole numbers.
    pub shift: Vector2,
}

impl Crossing {
    /// Coordinates on the other side.
    pub fn point(&self, p: Vector2) -> Vector2 {
        quarter_turns(p, self.quarters) + self.shift
    }
}

/// A vector after quarter turns.
pub fn quarter_turns(p: Vector2, quarters: u8) -> Vector2 {
    match quarters {
        0 => p,
        1 => Vector2::new(-p.y, p.x),
        2 => -p,
        _ => Vector2::new(p.y, -p.x),
    }
}

/// Triangles with charts. Those of the surface come first, then those of the skirt.
pub struct Atlas {
    /// #T by 3: coordinates of the corners, in cells.
    pub uv: Vec<[Vector2; 3]>,
    /// #T by 3: the same, moved by tiny amounts, for decisions.
    pub moved: Vec<[Vector2; 3]>,
    /// #T by 3: ways over the edges; `None` at the end of the skirt.
    pub across: Vec<[Option<Crossing>; 3]>,
    /// #T by 3: position of each corner in the closed and in the open state.
    pub points: Vec<[[Point3; 2]; 3]>,
    /// Number of triangles of the surface.
    pub surface: usize,
}

/// How far the corners are moved for decisions, in cells: far above rounding, far below what is cut.
const MOVED: f64 = 1e-6;

impl Atlas {
    /// The atlas of a fitted grid. The skirt is `skirt` cells wide; `shift` is added to all coordinates, which only
    /// a grid without cuts may ask for.
    pub fn new(
        map: &SurfaceMap,
        links: &Links,
        combed: &Combed,
        grid: &Grid,
        skirt: f64,
        shift: Vector2,
    ) -> Self {
        let faces = &map.open().faces;
        let uv: Vec<[Vector2; 3]> = grid.uv.iter().map(|row| row.map(|p| p + shift)).collect();
        let moved = (0..faces.len())
            .map(|f| {
                std::array::from_fn(|i| uv[f][i] + quarter_turns(nudge(faces[f][i]), grid.quarters[f][i]))
            })
            .collect();
        let across = (0..faces.len()).map(|f| {
            std::array::from_fn(|i| {
                let (face, edge) = links.across[f][i]?;
                let quarters = combed.jumps[f][i];
                let shift = uv[face][(edge + 1) % 3] - quarter_turns(uv[f][i], quarters);
                Some(Crossing { face, edge, quarters, shift: shift.map(f64::round) })
            })
        });
        let across = across.collect();
        let state = |v: usize| [map.closed().vertices[v], map.open().vertices[v]];
        let points = faces.iter().map(|face| face.map(state)).collect();
        let mut atlas = Self { uv, moved, across, points, surface: faces.len() };
        atlas.add_skirt(map, links, grid, skirt);
        atlas
    }

    /// The point of a triangle with these coordinates, in the closed and in the open state.
    pub fn position(&self, t: usize, p: Vector2) -> [Point3; 2] {
        let [a, b, c] = self.uv[t];
        let double = (b - a).perp(&(c - a));
        let weights = [(b - p).perp(&(c - p)) / double, (c - p).perp(&(a - p)) / double];
        let weights = [weights[0], weights[1], 1.0 - weights[0] - weights[1]];
        std::array::from_fn(|state| {
            Point3::from((0..3).map(|i| self.points[t][i][state].coords * weights[i]).sum::<Vector3>())
        })
    }

    /// Whether a point lies in a triangle.
    pub fn holds(&self, t: usize, p: Vector2) -> bool {
        let corners = &self.moved[t];
        (0..3).all(|i| side(corners[i], corners[(i + 1) % 3], p) >= 0.0)
    }

    /// Walks straight from a point of triangle `t` to another of the same chart; returns the triangle where it
    /// arrives, the quarter turns and the point's coordinates there. `None` where the way leaves the skirt.
    pub fn walk(&self, t: usize, from: Vector2, to: Vector2) -> Option<(usize, u8, Vector2)> {
        let (mut t, mut from, mut to, mut quarters) = (t, from, to, 0);
        let mut entered = None;
        for _ in 0..self.uv.len() {
            let corners = &self.moved[t];
            let left: [bool; 3] = std::array::from_fn(|i| side(from, to, corners[i]) >= 0.0);
            let exit = match entered {
                None => (0..3).find(|&i| !left[i] && left[(i + 1) % 3]),
                Some(edge) if left[(edge + 2) % 3] => Some((edge + 1) % 3),
                Some(edge) => Some((edge + 2) % 3),
            };
            let Some(exit) = exit.filter(|&i| side(corners[i], corners[(i + 1) % 3], to) < 0.0) else {
                return Some((t, quarters, to));
            };
            let crossing = self.across[t][exit]?;
            (from, to) = (crossing.point(from), crossing.point(to));
            quarters = (quarters + crossing.quarters) % 4;
            (t, entered) = (crossing.face, Some(crossing.edge));
        }
        None
    }

    /// Adds two triangles along each boundary edge, as wide as `width` in the parameter plane.
    fn add_skirt(&mut self, map: &SurfaceMap, links: &Links, grid: &Grid, width: f64) {
        let faces = &map.open().faces;
        let boundary = map.boundary();
        let mut at = BTreeMap::new();
        for &v in boundary {
            let Some(first) = links.first[v] else { continue };
            at.insert(v, self.hem(&links.fan(first).collect::<Vec<_>>(), grid, width));
        }
        // The first triangle of each edge's skirt, by the edge's first vertex; none where it would be turned over.
        let mut begun: BTreeMap<usize, usize> = BTreeMap::new();
        for (k, &v) in boundary.iter().enumerate() {
            let next = boundary[(k + 1) % boundary.len()];
            let Some((f, i)) = links.first[v] else { continue };
            let j = (i + 1) % 3;
            debug_assert_eq!(faces[f][j], next);
            let (start, end) = (&at[&v], &at[&next]);
            let (near, far) = (start.outer[0], end.outer[1]);
            // Corners: end, start, start's hem; end, start's hem, end's hem.
            let quad = [self.uv[f][j], self.uv[f][i], near, far];
            if side(quad[0], quad[1], near) <= 0.0 || side(quad[0], near, far) <= 0.0 {
                continue;
            }
            let nudges = [
                self.moved[f][j] - self.uv[f][j],
                self.moved[f][i] - self.uv[f][i],
                quarter_turns(nudge(usize::MAX - v), grid.quarters[f][i]),
                quarter_turns(nudge(usize::MAX - next), grid.quarters[f][j]),
            ];
            let points = [self.points[f][j], self.points[f][i], start.points, end.points];
            let t = self.uv.len();
            for corners in [[0, 1, 2], [0, 2, 3]] {
                self.uv.push(corners.map(|c| quad[c]));
                self.moved.push(corners.map(|c| quad[c] + nudges[c]));
                self.points.push(corners.map(|c| points[c]));
                self.across.push([None; 3]);
            }
            self.join((f, i), (t, 0), 0, Vector2::zeros());
            self.join((t, 2), (t + 1, 0), 0, Vector2::zeros());
            begun.insert(v, t);
        }
        for (k, &v) in boundary.iter().enumerate() {
            let before = boundary[(k + boundary.len() - 1) % boundary.len()];
            if let (Some(&t), Some(&previous)) = (begun.get(&v), begun.get(&before)) {
                // From the chart of the vertex's last triangle to that of its first.
                let quarters = (4 - at[&v].quarters) % 4;
                let shift = self.uv[t][1] - quarter_turns(self.uv[previous][0], quarters);
                self.join((previous + 1, 2), (t, 1), quarters, shift.map(f64::round));
            }
        }
    }

    /// The end of the skirt at a boundary vertex.
    fn hem(&self, fan: &[(usize, usize)], grid: &Grid, width: f64) -> Hem {
        let (&(f, i), &(g, j)) = (fan.first().expect("a triangle"), fan.last().expect("a triangle"));
        let quarters = (4 + grid.quarters[g][j] - grid.quarters[f][i]) % 4;
        let back = |p: Vector2| quarter_turns(p, (4 - quarters) % 4);
        let outgoing = self.uv[f][(i + 1) % 3] - self.uv[f][i];
        let incoming = back(self.uv[g][j] - self.uv[g][(j + 2) % 3]);
        let outwards = |along: Vector2| Vector2::new(along.y, -along.x).normalize();
        let (one, two) = (outwards(outgoing), outwards(incoming));
        // Both sides move outwards by the width; a sharp tip is cut short.
        let sum = one + two;
        let offset = sum * (width / (0.5 * sum.norm_squared()).max(0.25));
        let mut points = [Point3::origin(); 2];
        for (state, point) in points.iter_mut().enumerate() {
            let steps = fan.iter().map(|&(t, corner)| {
                let turn = (4 + grid.quarters[t][corner] - grid.quarters[f][i]) % 4;
                let p = self.uv[t][corner] + quarter_turns(offset, turn);
                (self.position(t, p)[state] - self.points[t][corner][state]) / fan.len() as f64
            });
            *point = self.points[f][i][state] + steps.sum::<Vector3>();
        }
        let outer = [self.uv[f][i] + offset, self.uv[g][j] + quarter_turns(offset, quarters)];
        Hem { outer, quarters, points }
    }

    fn join(&mut self, (f, i): (usize, usize), (g, j): (usize, usize), quarters: u8, shift: Vector2) {
        self.across[f][i] = Some(Crossing { face: g, edge: j, quarters, shift });
        let back = (4 - quarters) % 4;
        self.across[g][j] =
            Some(Crossing { face: f, edge: i, quarters: back, shift: -quarter_turns(shift, back) });
    }
}

/// The end of the skirt at a boundary vertex.
struct Hem {
    /// In the charts of the vertex's first and last triangle.
    outer: [Vector2; 2],
    /// Quarter turns from the first chart to the last.
    quarters: u8,
    /// Closed and open.
    points: [Point3; 2],
}

/// Positive where `p` lies on the left of the line from `a` to `b`.
pub fn side(a: Vector2, b: Vector2, p: Vector2) -> f64 {
    (b - a).perp(&(p - a))
}

/// A small vector that is different for each vertex and the same every time (the mixing of splitmix64).
fn nudge(vertex: usize) -> Vector2 {
    let mixed = |salt: u64| {
        let mut x = (vertex as u64).wrapping_mul(2).wrapping_add(salt).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    Vector2::new(mixed(0), mixed(1)) * MOVED
}
