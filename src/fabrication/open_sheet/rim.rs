//! The rims of an open sheet: one around every window and every border loop, made of sides of hinge polygons.
//!
//! Every side of every piece belongs to one rim and every hinge stands on two, or twice on one. The side along a
//! closed edge faces the window of that edge's end that does not carry the hinge.
//!
//! In a bistable sheet windows belong to crossings of slits, not to corners with hinges. There the rims are followed from
//! side to side: at a hinge to the other piece, at any other vertex to the same piece's next side.

use std::collections::BTreeMap;

use kurbo::{Point, Vec2};

use crate::fabrication::error::FabricationError;
use crate::fabrication::states::motions;
use crate::fabrication::topology::Topology;
use crate::geometry::Vector3;
use crate::geometry::rotation::RigidMotion;
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// A point where two sides of a rim meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The hinge point or free vertex, sheet millimetres.
    pub point: Point,
    /// The hinge that stands there; `None` at a free vertex of the border.
    pub hinge: Option<usize>,
}

/// A side of a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// The piece, to the left.
    pub piece: usize,
    /// Its two vertices in travelling direction.
    pub ends: [Point; 2],
    /// How far the cut runs inside the side, millimetres.
    pub inset: f64,
}

impl Side {
    /// Unit vector in travelling direction.
    pub fn direction(&self) -> Vec2 {
        (self.ends[1] - self.ends[0]).normalize()
    }

    /// The inset side's ends.
    pub fn shifted(&self) -> [Point; 2] {
        let by = self.inset * self.direction().turn_90();
        self.ends.map(|end| end + by)
    }
}

/// A closed line of sides, the pieces to the left: clockwise around a window, counter-clockwise around the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Rim {
    /// The nodes; as many as sides.
    pub nodes: Vec<Node>,
    /// `sides[i]` leads from `nodes[i]` to the next node.
    pub sides: Vec<Side>,
    /// Whether it is part of the sheet's border: the outer one, or around a hole without pieces.
    pub border: bool,
}

/// All rims: first the windows in the corners' order, then the border loops.
///
/// # Errors
/// Hinges that do not alternate around a piece.
pub fn rims(design: &Design, topology: &Topology, profile: &Profile) -> Result<Vec<Rim>, FabricationError> {
    if topology.edges.iter().any(|edge| edge.right.is_some() && edge.hinge.is_none()) {
        return faces(design, topology, profile);
    }
    let weaver =
        Weaver { design, topology, profile, senses: senses(design, topology)?, motions: motions(design) };
    let mut rims = Vec::new();
    for (corner, fan) in topology.fans.iter().enumerate() {
        if !fan.border && !fan.pieces.is_empty() {
            rims.push(weaver.rim(&[corner], false)?);
        }
    }
    for border in &topology.loops {
        let corners: Vec<usize> = border.iter().map(|&edge| topology.edges[edge].ends[1]).collect();
        rims.push(weaver.rim(&corners, true)?);
    }
    Ok(rims)
}

/// The rims of a sheet in which some slits hold nothing, followed from side to side.
fn faces(design: &Design, topology: &Topology, profile: &Profile) -> Result<Vec<Rim>, FabricationError> {
    let weaver = Weaver { design, topology, profile, senses: vec![], motions: motions(design) };
    let mut across = BTreeMap::new();
    for (id, hinge) in design.hinges.iter().enumerate() {
        let [j, k] = [0, 1].map(|side| (hinge.pieces[side], hinge.vertices[side]));
        across.insert(j, (id, k));
        across.insert(k, (id, j));
    }
    let edges = topology.edges.iter().enumerate();
    let edge_of: BTreeMap<[usize; 2], usize> =
        edges.flat_map(|(id, edge)| [(edge.ends, id), ([edge.ends[1], edge.ends[0]], id)]).collect();
    let mut seen: Vec<Vec<bool>> =
        design.pieces.iter().map(|piece| vec![false; piece.corners.len()]).collect();
    let mut rims = Vec::new();
    for first in 0..design.pieces.len() {
        for start in 0..design.pieces[first].corners.len() {
            let mut rim = Rim { nodes: vec![], sides: vec![], border: false };
            let (mut piece, mut vertex) = (first, start);
            while !seen[piece][vertex] {
                seen[piece][vertex] = true;
                let corners = &design.pieces[piece].corners;
                let next = (vertex + 1) % corners.len();
                let edge = edge_of[&[corners[vertex], corners[next]]];
                let hinge = across.get(&(piece, vertex)).map(|&(id, _)| id);
                weaver.add_side(&mut rim, piece, [vertex, next], hinge, edge)?;
                rim.border |= topology.edges[edge].right.is_none();
                (piece, vertex) = across.get(&(piece, next)).map_or((piece, next), |&(_, other)| other);
            }
            if !rim.sides.is_empty() {
                rims.push(rim);
            }
        }
    }
    Ok(rims)
}

/// Whether each piece carries its hinges at the starts of its sides (it turns counter-clockwise from the closed to
/// the open state) or at their ends.
fn senses(design: &Design, topology: &Topology) -> Result<Vec<bool>, FabricationError> {
    let mut senses: Vec<Option<bool>> = vec![None; design.pieces.len()];
    for edge in &topology.edges {
        let (Some(hinge), Some(right)) = (edge.hinge, edge.right) else { continue };
        for (piece, from) in [(edge.left, edge.ends[0]), (right, edge.ends[1])] {
            let start = hinge.corner == from;
            if *senses[piece].get_or_insert(start) != start {
                let reason = "its hinges stand at the starts of some sides and at the ends of others: they do not \
                              alternate around its corners";
                return Err(FabricationError::BadPiece { piece, reason: reason.into() });
            }
        }
    }
    Ok(senses.into_iter().map(|sense| sense.unwrap_or(true)).collect())
}

struct Weaver<'a> {
    design: &'a Design,
    topology: &'a Topology,
    profile: &'a Profile,
    senses: Vec<bool>,
    motions: Vec<RigidMotion>,
}

impl Weaver<'_> {
    fn rim(&self, corners: &[usize], border: bool) -> Result<Rim, FabricationError> {
        let mut rim = Rim { nodes: vec![], sides: vec![], border };
        for &corner in corners {
            let fan = &self.topology.fans[corner];
            // Fans run counter-clockwise around the corner, rims clockwise.
            for i in (0..fan.pieces.len()).rev() {
                let (from, to) = (fan.edges[(i + 1) % fan.edges.len()], fan.edges[i]);
                let piece = fan.pieces[i];
                let (Some(start), Some(end)) = (self.vertex(piece, from), self.vertex(piece, to)) else {
                    return Err(self.damaged(piece));
                };
                if (start + 1) % self.design.pieces[piece].open.len() != end {
                    return Err(self.damaged(piece));
                }
                let hinge = self.topology.edges[from].hinge.map(|hinge| hinge.id);
                let along = if self.senses[piece] { from } else { to };
                self.add_side(&mut rim, piece, [start, end], hinge, along)?;
            }
        }
        Ok(rim)
    }

    /// Adds a piece's side between two of its vertices, of which the first may stand at a hinge; closed, it lies along
    /// `edge`.
    fn add_side(
        &self,
        rim: &mut Rim,
        piece: usize,
        vertices: [usize; 2],
        hinge: Option<usize>,
        edge: usize,
    ) -> Result<(), FabricationError> {
        let open = &self.design.pieces[piece].open;
        let ends = vertices.map(|v| Point::new(open[v].x, open[v].y));
        if ends[0].distance(ends[1]) < self.profile.cut.kerf {
            let (length, Point { x, y }) = (ends[0].distance(ends[1]), ends[0].midpoint(ends[1]));
            let needed = self.profile.cut.kerf;
            return Err(FabricationError::ShortSide { piece, x, y, length, needed });
        }
        rim.nodes.push(Node { point: ends[0], hinge });
        rim.sides.push(Side { piece, ends, inset: self.inset(edge) });
        Ok(())
    }

    fn damaged(&self, piece: usize) -> FabricationError {
        FabricationError::BadPiece { piece, reason: "its corners and vertices do not belong together".into() }
    }

    /// The vertex that a piece has on one of its edges: that edge's hinge, or a free vertex.
    fn vertex(&self, piece: usize, edge: usize) -> Option<usize> {
        let corners = &self.design.pieces[piece].corners;
        let [from, to] = self.topology.edges[edge].ends;
        let start = if self.topology.edges[edge].left == piece { from } else { to };
        let side = corners.iter().position(|&corner| corner == start)?;
        Some(if self.senses[piece] { side } else { (side + 1) % corners.len() })
    }

    /// Closed, the two sides along an edge keep a kerf between them; where the pieces are tilted against each other,
    /// as much as keeps their faces apart.
    fn inset(&self, edge: usize) -> f64 {
        let edge = &self.topology.edges[edge];
        let Some(right) = edge.right else { return 0.0 };
        let [a, b] = [edge.left, right].map(|piece| self.motions[piece].rotation * Vector3::z());
        // Beyond a right angle the pieces meet in space otherwise than along this edge.
        let tilt = a.angle(&b).min(std::f64::consts::FRAC_PI_2);
        let room = self.profile.sheet.thickness * (0.5 * tilt).tan();
        (0.5 * (room - self.profile.cut.kerf)).max(0.0)
    }
}
