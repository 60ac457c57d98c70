//! What a position on the way is like.

use super::Step;
use crate::fabrication::hinge_table::HingeRow;
use crate::fabrication::states::{motions, sheet_vertices};
use crate::geometry::mesh::PolyMesh;
use crate::geometry::plane::doubled_area;
use crate::geometry::rotation::{RigidMotion, axis_angle};
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, State};
use crate::kirigami::filled::{closed_surface, open_surface};
use crate::kirigami::quality::triangles;
use crate::solid::Walls;
use crate::solid::clash::{Clash, Placed, overlaps};

/// A design ready to be measured in between.
pub struct Measure<'a> {
    design: &'a Design,
    /// Motions of the pieces from the sheet state to the closed one.
    to_closed: Vec<RigidMotion>,
    /// Full angles of the hinges, in sum.
    full: f64,
    edge: f64,
    /// The open sheet: a face per piece, then one per hole.
    surface: PolyMesh,
    closed_area: f64,
}

impl<'a> Measure<'a> {
    /// Of a design.
    pub fn new(design: &'a Design) -> Self {
        let to_closed = match design.sheet_state {
            Some(State::Open) => motions(design),
            _ => vec![RigidMotion::identity(); design.pieces.len()],
        };
        Self {
            design,
            to_closed,
            full: design.hinges.iter().map(|hinge| hinge.angle).sum(),
            edge: design.mean_edge(),
            surface: open_surface(design),
            closed_area: triangles(&closed_surface(design)).area(),
        }
    }

    /// Area of the open sheet over that of the closed one, as the design's own figure has it.
    pub fn open_expansion(&self) -> f64 {
        triangles(&self.surface).area() / self.closed_area
    }

    /// The figures of a position, but for its place on the way and collisions.
    pub fn step(&self, poses: Vec<RigidMotion>) -> Step {
        let Self { design, to_closed, full, edge, closed_area, .. } = self;
        let mut step = Step {
            at: 0.0,
            share: 0.0,
            poses: Vec::new(),
            parting: (0.0, 0),
            mean_parting: 0.0,
            strain: 0.0,
            lean: 0.0,
            angles: [f64::INFINITY, 0.0, 0.0],
            area_expansion: self.area(&poses) / closed_area,
            collision: None,
        };
        let count = design.hinges.len().max(1) as f64;
        for (id, hinge) in design.hinges.iter().enumerate() {
            let [j, k] = [0, 1].map(|end| {
                let (piece, vertex) = (hinge.pieces[end], hinge.vertices[end]);
                poses[piece].apply(&sheet_vertices(design, &design.pieces[piece])[vertex])
            });
            let parting = (k - j).norm();
            if parting > step.parting.0 {
                step.parting = (parting, id);
            }
            step.mean_parting += parting / count;
            let axes: [Vector3; 2] = hinge.pieces.map(|piece| poses[piece].rotation * hinge.axis);
            step.lean = step.lean.max(axes[0].cross(&axes[1]).norm().atan2(axes[0].dot(&axes[1])));
            let [j, k] =
                hinge.pieces.map(|piece| poses[piece].rotation * to_closed[piece].rotation.transpose());
            let (_, angle) = axis_angle(&(j.transpose() * k));
            let [least, mean, most] = step.angles;
            step.angles = [least.min(angle), mean + angle / count, most.max(angle)];
        }
        step.share = if *full > 0.0 { step.angles[1] * count / full } else { 0.0 };
        step.angles[0] = step.angles[0].min(step.angles[2]);
        step.strain = step.parting.0 / edge;
        step.poses = poses;
        step
    }

    /// Area of the sheet at these poses, by its faces: pieces and holes, each as large as its vector area.
    fn area(&self, poses: &[RigidMotion]) -> f64 {
        let PolyMesh { vertices, faces } = &self.surface;
        let mut moved = vertices.clone();
        for ((piece, pose), face) in self.design.pieces.iter().zip(poses).zip(faces) {
            for (&vertex, p) in face.iter().zip(sheet_vertices(self.design, piece)) {
                moved[vertex] = pose.apply(p);
            }
        }
        let area = |face: &Vec<usize>| {
            let corners: Vec<Point3> = face.iter().map(|&v| moved[v]).collect();
            0.5 * doubled_area(&corners).norm()
        };
        faces.iter().map(area).sum()
    }
}

/// Outlines on the way follow those of the pieces within this, millimetres: less than any ligament bends aside, and with a
/// fraction of the points.
const COARSE: f64 = 0.01;

/// Pieces as solids.
pub struct Thick<'a> {
    rows: &'a [HingeRow],
    pieces: Vec<Placed>,
    thickness: f64,
    walls: Walls,
}

impl<'a> Thick<'a> {
    /// Of a design's hinges and its pieces in the sheet state, in the design's order. `thickness`: of the sheet, millimetres.
    pub fn new(rows: &'a [HingeRow], pieces: &[Placed], thickness: f64, walls: Walls) -> Self {
        let coarse = |piece: &Placed| Placed { plate: piece.plate.coarser(COARSE), ..piece.clone() };
        Self { rows, pieces: pieces.iter().map(coarse).collect(), thickness, walls }
    }

    /// The worst collision at these poses beyond what may pass there: the play that pieces have whose hinge points part, and
    /// what the check of the other state excuses.
    pub fn collision(&self, poses: &[RigidMotion]) -> Option<Clash> {
        let mut pieces = self.pieces.clone();
        pieces.iter_mut().zip(poses).for_each(|(piece, pose)| (piece.motion, piece.misfit) = (*pose, COARSE));
        for row in self.rows {
            let [j, k] = row.pieces.map(|piece| poses[piece].apply(&row.point));
            let half = COARSE + 0.5 * (k - j).norm();
            row.pieces.iter().for_each(|&piece| pieces[piece].misfit = pieces[piece].misfit.max(half));
        }
        let [_, worst] = overlaps("partly open", self.rows, &pieces, self.thickness, self.walls);
        worst.filter(|clash| clash.excess() > 0.0)
    }
}
