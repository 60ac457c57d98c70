//! The energy of a whole sheet on its way between its states, by constrained minimisation.
//!
//! Pieces are rigid; all compliance is in the hinges ([`super::joint`]). The way's parameter is the share of the hinges'
//! turns: springs drive every hinge to a part of its angle, step by step, and the energy without them is kept, at the
//! share that the hinges really reach. So all cells go at the same time: that energy is an upper bound for a sheet that
//! snaps cell by cell. At the end the springs are let go: either the sheet stays near its open state, in a second minimum,
//! or it goes back.

use std::ops::ControlFlow;

use super::cell::wells;
use super::joint::{Joint, Parting, Turning};
use super::ligament::Ligament;
use super::pose::{Layout, Pose};
use crate::geometry::rotation::{RigidMotion, axis_angle};
use crate::geometry::{Point3, Vector3, centroid};
use crate::kirigami::design::{Design, Hinge, State};
use crate::kirigami::hinges::relative_turn;
use crate::solver::{Coupling, Options, System, Weighted};

/// A sheet's hinges as springs, ready to be moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    layout: Layout,
    joints: Vec<Joint>,
    /// Stiffness of the springs that drive the hinges, N mm per radian.
    drive: Vec<f64>,
    /// Unknowns of the open state as designed.
    open: Vec<f64>,
    /// Whether the open state is the one that is cut, from which the way then leads.
    cut_open: bool,
}

/// A point on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Turn of the hinges from the state that is cut, as a share of their full angles, in sum.
    pub share: f64,
    /// Energy, mJ.
    pub energy: f64,
    /// Largest nominal strain of a ligament.
    pub strain: f64,
    /// Its hinge.
    pub hinge: usize,
}

/// A sheet's way.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetSnap {
    /// From the state that is cut to the other, equal steps of the drive.
    pub path: Vec<Sample>,
    /// And back, in the same order as `path`.
    pub back: Vec<Sample>,
    /// Energy to get over on the way out, mJ.
    pub barrier: f64,
    /// Energy to get over from the second minimum back, mJ; 0 where there is none.
    pub back_barrier: f64,
    /// Where the sheet comes to rest when it is let go in the other state.
    pub released: Sample,
    /// The sample of the largest strain.
    pub worst: Sample,
    /// Whether it stays near the other state when it is let go there.
    pub bistable: bool,
}

/// Accuracy of a minimum: the last step lowers the energy by less than this fraction.
const TOLERANCE: f64 = 1e-9;
/// The same for positions that are only to be seen: ten times as much and a tenth of it give the way of the default dome to the
/// same three digits.
const WAY_TOLERANCE: f64 = 1e-3;
/// Most steps to a minimum. Where the bending nearly overcomes the misfit they converge slowly.
const MOST_STEPS: usize = 200;
/// A well counts from this part of the hill's energy: what the minimisation leaves uncertain is less.
const LEAST_WELL: f64 = 1e-6;
/// Heights and tilts below this part of the sheet's size are flat: rounding.
const FLAT: f64 = 1e-9;

impl Sheet {
    /// The sheet of a design with these ligaments, one per hinge. Rest is the sheet state, or the closed one without it.
    pub fn new(design: &Design, ligaments: &[Ligament]) -> Self {
        let motions = open_motions(design);
        let unit = design.mean_edge();
        let centres: Vec<Point3> = design.pieces.iter().map(|piece| centroid(&piece.closed)).collect();
        let cut_open = design.sheet_state == Some(State::Open);
        let at_rest = if cut_open { 1.0 } else { 0.0 };
        let joint = |(hinge, ligament): (&Hinge, &Ligament)| {
            let [j, k] = hinge.pieces;
            let (axis, angle) = relative_turn(&motions[j], &motions[k]);
            let at = [0, 1].map(|i| design.pieces[hinge.pieces[i]].closed[hinge.vertices[i]]);
            let along = ligament_direction(design, hinge, &axis);
            Joint {
                pieces: hinge.pieces,
                arms: [at[0] - centres[j], at[1] - centres[k]],
                frame: [along, axis.cross(&along), axis],
                angle,
                rest: at_rest * angle,
                ligament: *ligament,
            }
        };
        let joints: Vec<Joint> = design.hinges.iter().zip(ligaments).map(joint).collect();
        let planar = is_flat(&design.pieces.iter().map(|p| &p.closed).collect::<Vec<_>>(), unit)
            && motions.iter().all(|m| (m.rotation * Vector3::z() - Vector3::z()).norm() < FLAT);
        let layout = Layout { centres, planar, unit };
        let mut open = vec![0.0; layout.places().len()];
        for (piece, motion) in motions.iter().enumerate() {
            let (axis, angle) = axis_angle(&motion.rotation);
            let w = axis.map_or_else(Vector3::zeros, |axis| axis * angle);
            layout.set(&mut open, piece, &motion.apply(&layout.centres[piece]), &w);
        }
        let drive = joints.iter().map(|joint| drive_stiffness(design, joint)).collect();
        Self { layout, joints, drive, open, cut_open }
    }

    /// Unknowns of the state that is cut and of the other one. Those of the closed state are zero.
    fn ends(&self) -> [Vec<f64>; 2] {
        let (closed, open) = (vec![0.0; self.open.len()], self.open.clone());
        if self.cut_open { [open, closed] } else { [closed, open] }
    }

    /// Follows the way in `steps` equal steps of the drive, to the other state and back.
    pub fn snap(&self, steps: usize) -> SheetSnap {
        let mut system = System::new(self.layout.places());
        let share = |i: usize| i as f64 / steps as f64;
        let [start, mut x] = self.ends();
        let path = self.follow(&mut system, start, (0..=steps).map(share));
        let mut back = self.follow(&mut system, x.clone(), (0..=steps).rev().map(share));
        back.reverse();
        self.minimise(&mut system, &mut x, None);
        let released = self.sample(&x);
        // Of two ways the one with less energy counts.
        let lower = |(p, q): (&Sample, &Sample)| p.energy.min(q.energy);
        let mut energies: Vec<f64> = path.iter().zip(&back).map(lower).collect();
        let top = wells(&energies).top;
        let bistable = released.share > 0.5 * (path[top].share.min(1.0))
            && energies[top] - released.energy > LEAST_WELL * energies[top];
        if bistable {
            energies.push(released.energy);
        }
        let found = wells(&energies);
        let all = path.iter().chain(&back);
        let worst = all.max_by(|p, q| p.strain.total_cmp(&q.strain)).expect("a way has samples");
        SheetSnap {
            barrier: found.barrier,
            back_barrier: if bistable { found.back_barrier } else { 0.0 },
            bistable,
            released,
            worst: *worst,
            path,
            back,
        }
    }

    /// The minima at these shares of the drive, each from the ones before.
    fn follow(&self, system: &mut System, start: Vec<f64>, shares: impl Iterator<Item = f64>) -> Vec<Sample> {
        let (mut before, mut x) = (start.clone(), start);
        let mut samples = Vec::new();
        for share in shares {
            let ahead: Vec<f64> = x.iter().zip(&before).map(|(now, then)| 2.0 * now - then).collect();
            before = std::mem::replace(&mut x, ahead);
            self.minimise(system, &mut x, Some(share));
            samples.push(self.sample(&x));
        }
        samples
    }

    /// The way of least misfit: motions of the pieces from the closed state where the drive turns every hinge by these parts
    /// of its full angle, one after the other from the state that `openings` begins with, 0 or 1. Ligaments do not resist
    /// the turn, so that both states are free of energy. The sheet as a whole stands where the closed one does, on the
    /// mean: the motion from there to the open state is left out.
    pub fn way(&self, openings: &[f64]) -> Vec<Vec<RigidMotion>> {
        let mut system = System::new(self.layout.places());
        let from_open = openings.first().is_some_and(|&opening| opening > 0.5);
        let mut x = if from_open { self.open.clone() } else { vec![0.0; self.open.len()] };
        let mut before = x.clone();
        let mut way = Vec::new();
        let options = Options {
            energy_tolerance: WAY_TOLERANCE,
            damping: 1e-8,
            energy_floor: 1e-12 * self.drive.iter().sum::<f64>(),
            ..Options::default()
        };
        for (i, &opening) in openings.iter().enumerate() {
            // Straight on, by the steps' lengths.
            let ratio = match i {
                0 | 1 => 0.0,
                _ => (opening - openings[i - 1]) / (openings[i - 1] - openings[i - 2]),
            };
            let ahead: Vec<f64> =
                x.iter().zip(&before).map(|(now, then)| now + ratio * (now - then)).collect();
            before = std::mem::replace(&mut x, ahead);
            self.settle(&mut system, &mut x, opening, [0.0, 1.0], &options);
            way.push((0..self.layout.centres.len()).map(|piece| self.motion(&x, piece)).collect());
        }
        way
    }

    /// The motion of a piece from the closed state.
    fn motion(&self, x: &[f64], piece: usize) -> RigidMotion {
        let Pose { centre, rotation, .. } = self.layout.pose(x, piece);
        RigidMotion { rotation, translation: centre.coords - rotation * self.layout.centres[piece].coords }
    }

    /// Minimises the energy, with the drive at a share or without it.
    fn minimise(&self, system: &mut System, x: &mut [f64], share: Option<f64>) {
        let drive = if share.is_some() { 1.0 } else { 0.0 };
        let options = Options {
            iterations: MOST_STEPS,
            energy_tolerance: TOLERANCE,
            damping: 1e-8,
            energy_floor: 1e-18 * self.drive.iter().sum::<f64>(),
            ..Options::default()
        };
        self.settle(system, x, share.map_or(0.0, |share| self.opening(share)), [1.0, drive], &options);
    }

    /// Minimises the energy with the drive at a part of the full angles; weights of bending and drive.
    fn settle(
        &self,
        system: &mut System,
        x: &mut [f64],
        opening: f64,
        [bending, driving]: [f64; 2],
        options: &Options,
    ) {
        let Self { layout, joints, drive, .. } = self;
        let weighted = |term, weight| Weighted { term, weight, coupling: Coupling::Full };
        let mut terms = [
            weighted(Box::new(Parting::new(layout, joints)) as _, 1.0),
            weighted(Box::new(Turning::bending(layout, joints)) as _, bending),
            weighted(Box::new(Turning::drive(layout, joints, drive, opening)) as _, driving),
        ];
        system.minimize(&mut terms, x, options, &mut |_| ControlFlow::Continue(()));
    }

    /// The part of the full angles, from the closed state, at a share of the way; and the other way round.
    fn opening(&self, share: f64) -> f64 {
        if self.cut_open { 1.0 - share } else { share }
    }

    /// What the sheet is like at these unknowns.
    fn sample(&self, x: &[f64]) -> Sample {
        let Self { layout, joints, .. } = self;
        let turned: f64 = joints.iter().map(|joint| joint.turned(layout, x)).sum();
        let full: f64 = joints.iter().map(|joint| joint.angle).sum();
        let strains = joints.iter().map(|joint| joint.strain(layout, x)).enumerate();
        let (hinge, strain) = strains.max_by(|p, q| p.1.total_cmp(&q.1)).unwrap_or((0, 0.0));
        let share = if full > 0.0 { self.opening(turned / full) } else { 0.0 };
        Sample { share, energy: self.energies(x).iter().sum(), strain, hinge }
    }

    /// Energy of each hinge at these unknowns, mJ.
    fn energies(&self, x: &[f64]) -> Vec<f64> {
        use crate::solver::Term;
        let Self { layout, joints, .. } = self;
        let (parting, bending) = (Parting::new(layout, joints), Turning::bending(layout, joints));
        let (mut residuals, mut jacobian) = ([0.0; 5], [0.0; 60]);
        let mut half_squares = |term: &dyn Term, b: usize| {
            let rows = term.rows(b);
            jacobian.fill(0.0);
            term.evaluate(b, x, &mut residuals[..rows], &mut jacobian[..rows * term.unknowns(b).len()]);
            0.5 * residuals[..rows].iter().map(|r| r * r).sum::<f64>()
        };
        (0..joints.len()).map(|b| half_squares(&parting, b) + half_squares(&bending, b)).collect()
    }
}

/// Motions of the pieces from the closed to the open state, without the motion of the sheet as a whole.
fn open_motions(design: &Design) -> Vec<RigidMotion> {
    let all = |state: State| -> Vec<Point3> {
        design.pieces.iter().flat_map(|piece| piece.vertices(state).iter().copied()).collect()
    };
    let home = RigidMotion::fit(&all(State::Open), &all(State::Closed));
    let flat = |points: &[Point3]| points.iter().all(|p| p.z == 0.0);
    let motion = |closed: &[Point3], open: &[Point3]| {
        let open: Vec<Point3> = open.iter().map(|p| home.apply(p)).collect();
        RigidMotion::fit(closed, &open)
    };
    // In the plane nothing is to be undone; a fit would only bring rounding into the third direction.
    let plane = flat(&all(State::Closed)) && flat(&all(State::Open));
    let motion = |piece: &crate::kirigami::design::Piece| {
        if plane { planar_fit(&piece.closed, &piece.open) } else { motion(&piece.closed, &piece.open) }
    };
    design.pieces.iter().map(motion).collect()
}

/// The best rigid motion of points in the plane z = 0 within that plane.
fn planar_fit(from: &[Point3], to: &[Point3]) -> RigidMotion {
    let (start, end) = (centroid(from), centroid(to));
    let (mut sin, mut cos) = (0.0, 0.0);
    for (p, q) in from.iter().zip(to) {
        let (u, v) = ((p - start).xy(), (q - end).xy());
        sin += u.perp(&v);
        cos += u.dot(&v);
    }
    let rotation = *nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), sin.atan2(cos)).matrix();
    RigidMotion { rotation, translation: end.coords - rotation * start.coords }
}

fn is_flat(polygons: &[&Vec<Point3>], size: f64) -> bool {
    let height = polygons.first().and_then(|polygon| polygon.first()).map_or(0.0, |p| p.z);
    polygons.iter().all(|polygon| polygon.iter().all(|p| (p.z - height).abs() < FLAT * size))
}

/// Unit direction of a ligament from piece to piece, perpendicular to the axis: across the slit that ends at the hinge,
/// which runs along the side that the two pieces share. Without one, from the middle of the one piece to the other's.
fn ligament_direction(design: &Design, hinge: &Hinge, axis: &Vector3) -> Vector3 {
    let [j, k] = hinge.pieces.map(|piece| &design.pieces[piece]);
    let neighbours = |i: usize| {
        let (piece, vertex) = (&design.pieces[hinge.pieces[i]], hinge.vertices[i]);
        let n = piece.corners.len();
        [(vertex + 1) % n, (vertex + n - 1) % n].map(|at| piece.corners[at])
    };
    let at = j.closed[hinge.vertices[0]];
    let others = neighbours(1);
    let shared = neighbours(0).into_iter().find(|corner| others.contains(corner));
    let between = centroid(&k.closed) - centroid(&j.closed);
    let across = match shared.and_then(|corner| design.corners.get(corner)) {
        Some(corner) => axis.cross(&(corner - at)),
        None => between,
    };
    let across = across - axis * axis.dot(&across);
    let fallback = axis.cross(&Vector3::x()).try_normalize(1e-3).unwrap_or_else(Vector3::y);
    let unit = across.try_normalize(1e-12).unwrap_or(fallback);
    if unit.dot(&between) < 0.0 { -unit } else { unit }
}

/// Stiffness of the spring that drives a hinge: stiffer than the energy's hill is steep, so that each step has one minimum.
/// The hill's curvature is at most the misfit's stiffness times the square of the piece's size and half the angle.
fn drive_stiffness(design: &Design, joint: &Joint) -> f64 {
    let size = |i: usize| {
        let piece = joint.pieces[i];
        let middle = centroid(&design.pieces[piece].closed);
        design.pieces[piece].closed.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max)
    };
    let lever = size(0).min(size(1));
    joint.ligament.series() * (lever * joint.angle).powi(2) + 10.0 * joint.ligament.spring.bending
}

#[cfg(test)]
pub(crate) mod tests;
