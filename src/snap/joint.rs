//! The energy of hinges as sums of squares: the terms that the solver minimises.
//!
//! A hinge's two points may part, its pieces may turn about its axis and, stiffly, about the others. Directions are
//! those of the frame midway between the two pieces, so that both sides are alike.

use super::ligament::Ligament;
use super::pose::{Layout, Pose, Wrench};
use crate::geometry::Vector3;
use crate::solver::Term;

/// A hinge between pieces j and k, everything in the frame of the closed state.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// The two pieces.
    pub pieces: [usize; 2],
    /// The hinge point from the middle of each piece.
    pub arms: [Vector3; 2],
    /// Unit directions: along the ligament, across it, and the hinge axis; right-handed.
    pub frame: [Vector3; 3],
    /// Turn about the axis, as j sees k, from the closed to the open state, radians.
    pub angle: f64,
    /// Turn at which the ligament is as cut: 0 where the closed sheet is cut, `angle` where the open one is.
    pub rest: f64,
    /// Its ligament.
    pub ligament: Ligament,
}

/// Where the two pieces of a hinge stand.
struct Pair {
    poses: [Pose; 2],
}

impl Pair {
    fn new(joint: &Joint, layout: &Layout, x: &[f64]) -> Self {
        Self { poses: joint.pieces.map(|piece| layout.pose(x, piece)) }
    }

    /// A direction of the closed state as each piece carries it.
    fn turned(&self, direction: &Vector3) -> [Vector3; 2] {
        [0, 1].map(|i| self.poses[i].rotation * direction)
    }

    /// From the hinge point on j to the one on k.
    fn parting(&self, joint: &Joint) -> Vector3 {
        let [j, k] = [0, 1].map(|i| self.poses[i].centre + self.poses[i].rotation * joint.arms[i]);
        k - j
    }
}

/// A direction midway between two others of unit length; the derivative of a product with it by each of the two.
fn midway([j, k]: &[Vector3; 2]) -> (Vector3, f64) {
    let sum = j + k;
    let norm = sum.norm();
    (sum / norm, norm)
}

/// `scale` times the component of `vector` midway along a direction, with the wrenches of the direction's turning.
fn component(
    scale: f64,
    vector: &Vector3,
    carried: &[Vector3; 2],
    wrenches: &mut [Wrench; 2],
) -> (f64, Vector3) {
    let (direction, norm) = midway(carried);
    let along = vector.dot(&direction);
    let slope = (vector - direction * along) * (scale / norm);
    for (wrench, carried) in wrenches.iter_mut().zip(carried) {
        wrench.turn(carried, &slope);
    }
    (scale * along, direction * scale)
}

impl Joint {
    /// Turn about the axis as j sees k, in -pi to pi, and its wrenches.
    fn turn(&self, pair: &Pair) -> (f64, [Wrench; 2]) {
        let ([u_j, u_k], [v_j, _]) = (pair.turned(&self.frame[0]), pair.turned(&self.frame[1]));
        let (sin, cos) = (u_k.dot(&v_j), u_k.dot(&u_j));
        let square = sin * sin + cos * cos;
        let mut wrenches = [Wrench::default(); 2];
        wrenches[1].turn(&u_k, &((v_j * cos - u_j * sin) / square));
        wrenches[0].turn(&v_j, &(u_k * (cos / square)));
        wrenches[0].turn(&u_j, &(u_k * (-sin / square)));
        (sin.atan2(cos), wrenches)
    }

    /// Turn about the axis as j sees k.
    pub fn turned(&self, layout: &Layout, x: &[f64]) -> f64 {
        self.turn(&Pair::new(self, layout, x)).0
    }

    /// Nominal strain of the ligament.
    pub fn strain(&self, layout: &Layout, x: &[f64]) -> f64 {
        let pair = Pair::new(self, layout, x);
        let parting = pair.parting(self);
        let along = |i: usize| parting.dot(&midway(&pair.turned(&self.frame[i])).0);
        let spring = &self.ligament.spring;
        let turn = self.turn(&pair).0 - self.rest;
        self.ligament.strain(turn, spring.axial * along(0), spring.shear * along(1))
    }
}

/// The unknowns of each joint: those of its two pieces.
fn unknowns(layout: &Layout, joints: &[Joint]) -> Vec<Vec<usize>> {
    joints
        .iter()
        .map(|joint| joint.pieces.iter().flat_map(|&piece| layout.unknowns(piece)).collect())
        .collect()
}

/// Writes a row of the Jacobian.
fn write(layout: &Layout, pair: &Pair, wrenches: &[Wrench; 2], row: &mut [f64]) {
    let n = layout.per_piece();
    for i in 0..2 {
        layout.slopes(&pair.poses[i], &wrenches[i], &mut row[i * n..(i + 1) * n]);
    }
}

/// Everything but the turn about the axis: hinge points that part, pieces that tilt against each other. The sum of squares is twice
/// the energy, N mm.
pub struct Parting<'a> {
    layout: &'a Layout,
    joints: &'a [Joint],
    unknowns: Vec<Vec<usize>>,
}

impl<'a> Parting<'a> {
    /// The term of these joints.
    pub fn new(layout: &'a Layout, joints: &'a [Joint]) -> Self {
        Self { layout, joints, unknowns: unknowns(layout, joints) }
    }
}

impl Term for Parting<'_> {
    fn name(&self) -> &'static str {
        "parting"
    }
    fn blocks(&self) -> usize {
        self.joints.len()
    }
    fn rows(&self, _: usize) -> usize {
        if self.layout.planar { 2 } else { 5 }
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[b]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let joint = &self.joints[b];
        let pair = Pair::new(joint, self.layout, x);
        let carried = [0, 1, 2].map(|i| pair.turned(&joint.frame[i]));
        let arms = [0, 1].map(|i| pair.poses[i].rotation * joint.arms[i]);
        let spring = &joint.ligament.spring;
        let columns = self.unknowns[b].len();
        let parting = pair.parting(joint);
        let mut rows = residuals.iter_mut().zip(jacobian.chunks_mut(columns));
        let directions = if self.layout.planar { 2 } else { 3 };
        for (carried, stiffness) in
            carried.iter().zip([spring.axial, spring.shear, spring.lift]).take(directions)
        {
            let mut wrenches = [Wrench::default(); 2];
            let (value, slope) = component(stiffness.sqrt(), &parting, carried, &mut wrenches);
            wrenches[1].push(&arms[1], &slope);
            wrenches[0].push(&arms[0], &-slope);
            let (residual, row) = rows.next().expect("a row per direction");
            *residual = value;
            write(self.layout, &pair, &wrenches, row);
        }
        if self.layout.planar {
            return;
        }
        // The axis of k leans along the ligament where the pieces turn about the direction across it, and the other way.
        let lean = carried[2][1] - carried[2][0];
        for (carried_along, stiffness) in carried.iter().zip([spring.tilt, spring.twist]) {
            let mut wrenches = [Wrench::default(); 2];
            let (value, slope) = component(stiffness.sqrt(), &lean, carried_along, &mut wrenches);
            wrenches[1].turn(&carried[2][1], &slope);
            wrenches[0].turn(&carried[2][0], &-slope);
            let (residual, row) = rows.next().expect("a row per direction");
            *residual = value;
            write(self.layout, &pair, &wrenches, row);
        }
    }
}

/// Turns about the axes against given ones, one row per joint.
pub struct Turning<'a> {
    name: &'static str,
    layout: &'a Layout,
    joints: &'a [Joint],
    unknowns: Vec<Vec<usize>>,
    /// Root of the stiffness and the turn without moment, per joint.
    springs: Vec<[f64; 2]>,
}

impl<'a> Turning<'a> {
    /// The ligaments' bending: the sum of squares is twice the energy, N mm.
    pub fn bending(layout: &'a Layout, joints: &'a [Joint]) -> Self {
        let spring = |joint: &Joint| [joint.ligament.spring.bending.sqrt(), joint.rest];
        let springs = joints.iter().map(spring).collect();
        Self { name: "bending", layout, joints, unknowns: unknowns(layout, joints), springs }
    }

    /// Springs of these stiffnesses that turn every hinge to the part `share` of its angle.
    pub fn drive(layout: &'a Layout, joints: &'a [Joint], stiffness: &[f64], share: f64) -> Self {
        let spring = |(joint, k): (&Joint, &f64)| [k.sqrt(), share * joint.angle];
        let springs = joints.iter().zip(stiffness).map(spring).collect();
        Self { name: "drive", layout, joints, unknowns: unknowns(layout, joints), springs }
    }
}

impl Term for Turning<'_> {
    fn name(&self) -> &'static str {
        self.name
    }
    fn blocks(&self) -> usize {
        self.joints.len()
    }
    fn rows(&self, _: usize) -> usize {
        1
    }
    fn unknowns(&self, b: usize) -> &[usize] {
        &self.unknowns[b]
    }
    fn evaluate(&self, b: usize, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
        let [root, rest] = self.springs[b];
        let pair = Pair::new(&self.joints[b], self.layout, x);
        let (turn, mut wrenches) = self.joints[b].turn(&pair);
        residuals[0] = root * (turn - rest);
        wrenches.iter_mut().for_each(|wrench| wrench.moment *= root);
        write(self.layout, &pair, &wrenches, jacobian);
    }
}

#[cfg(test)]
mod tests {
    use super::super::ligament::tests::nylon;
    use super::*;
    use crate::geometry::Point3;
    use crate::solver::derivative_check::largest_jacobian_error;

    /// Two pieces with two hinges between them, in general position.
    fn joints() -> (Layout, Vec<Joint>) {
        let layout = Layout {
            centres: vec![Point3::new(0.0, 0.0, 0.0), Point3::new(5.0, 1.0, 0.3)],
            planar: false,
            unit: 3.0,
        };
        let joint = |axis: Vector3, at: Vector3| {
            let e = Vector3::new(0.6, 0.8, 0.1).cross(&axis).normalize();
            Joint {
                pieces: [0, 1],
                arms: [at, at - Vector3::new(5.0, 1.0, 0.3)],
                frame: [e, axis.cross(&e), axis],
                angle: 0.6,
                rest: 0.1,
                ligament: nylon(0.0),
            }
        };
        let joints = vec![
            joint(Vector3::new(0.1, -0.05, 1.0).normalize(), Vector3::new(2.0, 1.0, 0.0)),
            joint(Vector3::new(-0.1, 0.2, 1.0).normalize(), Vector3::new(2.5, -1.0, 0.2)),
        ];
        (layout, joints)
    }

    const X: [f64; 12] = [0.1, -0.2, 0.05, 0.3, 0.1, 0.5, 0.2, 0.1, -0.1, -0.2, 0.3, 1.2];

    #[test]
    fn derivatives_agree_with_differences() {
        let (layout, joints) = joints();
        let terms: [Box<dyn Term>; 3] = [
            Box::new(Parting::new(&layout, &joints)),
            Box::new(Turning::bending(&layout, &joints)),
            Box::new(Turning::drive(&layout, &joints, &[2.0, 5.0], 0.4)),
        ];
        for term in &terms {
            // Rounding of central differences with this step, relative to the largest entry.
            let error = largest_jacobian_error(&**term, &X, 1e-5);
            assert!(error < 1e-8, "{} {error}", term.name());
        }
        let plane = Layout { planar: true, ..layout.clone() };
        let joints: Vec<Joint> = joints.iter().cloned().map(flattened).collect();
        for term in [&Parting::new(&plane, &joints) as &dyn Term, &Turning::bending(&plane, &joints)] {
            assert!(largest_jacobian_error(term, &X[..6], 1e-5) < 1e-8);
        }
    }

    fn flattened(joint: Joint) -> Joint {
        let e = Vector3::new(0.6, 0.8, 0.0);
        Joint { frame: [e, Vector3::z().cross(&e), Vector3::z()], ..joint }
    }

    #[test]
    fn rigid_motions_of_all_pieces_change_nothing() {
        let (layout, joints) = joints();
        let term = Parting::new(&layout, &joints);
        let values = |x: &[f64]| {
            let (mut r, mut j) = ([0.0; 5], [0.0; 60]);
            term.evaluate(1, x, &mut r, &mut j);
            (r, joints[1].turned(&layout, x))
        };
        let motion = nalgebra::Rotation3::from_euler_angles(0.4, -0.8, 0.3);
        let mut moved = X;
        for piece in 0..2 {
            let pose = layout.pose(&X, piece);
            let rotation = motion.matrix() * pose.rotation;
            let w = nalgebra::Rotation3::from_matrix_unchecked(rotation).scaled_axis();
            let centre = Point3::from(motion * pose.centre.coords + Vector3::new(1.0, 2.0, 3.0));
            layout.set(&mut moved, piece, &centre, &w);
        }
        let ((before, turn), (after, turned)) = (values(&X), values(&moved));
        assert!(before.iter().zip(&after).all(|(p, q)| (p - q).abs() < 1e-9));
        assert!((turn - turned).abs() < 1e-12 && turn.abs() > 0.1);
        assert!(before.iter().all(|r| r.abs() > 1e-3));
    }
}
