//! One cell whose ligaments yield: elastic, perfectly plastic, step by step along the path of [`super::cell`].
//!
//! A nylon notch at 36 degrees strains by nearly 30 %, far above its yield strain, so its moment stays at that of the fully
//! plastic section while its elastic model lets it grow. The forces that the misfit puts on a ligament are limited too:
//! a shear force V bends the section at the lever `reach`. The loads stay within
//!
//! ```text
//! |M| + reach |V| <= M_p,   |N| <= N_p        M_p = sigma_y b t^2 / 4, N_p = sigma_y b t
//! ```
//!
//! and flow normal to these bounds (the closest point in the norm of the elastic energy). That axial force weakens a
//! section in bending is left out. What decides is the torque that the rectangle must be turned with: where it turns
//! negative the cell goes on by itself, it snaps.

use nalgebra::{Matrix2, Vector2};

use super::cell::{Cell, Corner};
use super::ligament::Ligament;

/// Loads of a ligament: axial force, shear force, moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Loads {
    axial: f64,
    shear: f64,
    moment: f64,
}

/// A ligament's place: misfit along and across, turn.
type Place = [f64; 3];

/// One passage of a cell from one state to the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Passage {
    /// Torque against the motion at equal turns of the rectangle, N mm; it lacks the start.
    pub torques: Vec<f64>,
    /// Largest torque against the motion, N mm.
    pub resistance: f64,
    /// Largest torque with the motion, N mm: 0 or less means that nothing snaps.
    pub release: f64,
    /// Work against the torque until it first changes its sign, or to the end, mJ.
    pub work: f64,
}

impl Passage {
    fn new(torques: Vec<f64>, turn: f64) -> Self {
        let resistance = torques.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let release = -torques.iter().copied().fold(f64::INFINITY, f64::min);
        let work = torques.iter().take_while(|torque| **torque > 0.0).sum::<f64>() * turn;
        Self { torques, resistance, release, work }
    }

    /// Whether the cell goes on by itself somewhere.
    pub fn snaps(&self) -> bool {
        self.release > 0.0
    }
}

/// Turns the rectangle of a cell that was cut at +phi to -phi, in `steps` equal steps.
pub fn pass(cell: &Cell, ligament: &Ligament, steps: usize) -> Passage {
    let turn = 2.0 * cell.phi / steps as f64;
    let mut state = Cycle::new(cell, ligament);
    let torques = (1..=steps).map(|i| state.go(cell.phi - turn * i as f64)).collect();
    Passage::new(torques, turn)
}

/// A cell under way.
struct Cycle<'a> {
    cell: &'a Cell,
    ligament: &'a Ligament,
    corners: [Corner; 2],
    loads: [Loads; 2],
    places: [Place; 2],
    expansion: Vector2<f64>,
}

/// Steps of Newton's method for the two expansions; the forces are piecewise nearly linear.
const NEWTON_STEPS: usize = 30;

impl<'a> Cycle<'a> {
    fn new(cell: &'a Cell, ligament: &'a Ligament) -> Self {
        let corners = cell.corners();
        let (loads, places) = ([Loads::default(); 2], [[0.0; 3]; 2]);
        Self { cell, ligament, corners, loads, places, expansion: Vector2::zeros() }
    }

    /// Turns the rectangle to `angle` and returns the torque against turning it to smaller angles.
    fn go(&mut self, angle: f64) -> f64 {
        let expansion = self.balance(angle);
        let mut torque = 0.0;
        for (i, corner) in self.corners.into_iter().enumerate() {
            let (loads, place) = self.loads_at(i, angle, &expansion);
            // Two corners of each kind. The energy's derivative by the angle, at constant plastic parts.
            let h = 1e-6;
            let moved = |sign: f64| self.cell.misfit(&corner, angle + sign * h, &expansion).along;
            let along = (moved(1.0) - moved(-1.0)) / (2.0 * h);
            torque -= 2.0 * (loads.axial * along.x + loads.shear * along.y + loads.moment);
            (self.loads[i], self.places[i]) = (loads, place);
        }
        self.expansion = expansion;
        torque
    }

    fn loads_at(&self, i: usize, angle: f64, expansion: &Vector2<f64>) -> (Loads, Place) {
        let along = self.cell.misfit(&self.corners[i], angle, expansion).along;
        let place = [along.x, along.y, angle - self.cell.phi];
        let step = [0, 1, 2].map(|k| place[k] - self.places[i][k]);
        (yielded(self.ligament, &self.loads[i], &step), place)
    }

    /// Force on the 8-gons in the direction of X and Y.
    fn force(&self, angle: f64, expansion: &Vector2<f64>) -> Vector2<f64> {
        let force = |(i, corner): (usize, &Corner)| {
            let (loads, _) = self.loads_at(i, angle, expansion);
            let frame = self.cell.misfit(corner, angle, expansion).frame;
            corner.moves.component_mul(&(frame * Vector2::new(loads.axial, loads.shear)))
        };
        self.corners.iter().enumerate().map(force).sum()
    }

    /// The expansions at which nothing pulls on the 8-gons.
    fn balance(&self, angle: f64) -> Vector2<f64> {
        let scale = self.ligament.full_force().min(self.ligament.full_moment() / self.ligament.reach);
        let mut x = self.expansion;
        let mut force = self.force(angle, &x);
        for _ in 0..NEWTON_STEPS {
            if force.norm() < 1e-11 * scale {
                break;
            }
            let h = 1e-7;
            let slope = |e: Vector2<f64>| (self.force(angle, &(x + e * h)) - force) / h;
            let jacobian = Matrix2::from_columns(&[slope(Vector2::x()), slope(Vector2::y())]);
            let Some(inverse) = jacobian.try_inverse() else { break };
            let step = -(inverse * force);
            // Halved until the force falls: kinks where a ligament begins or ceases to yield.
            let shorter = (0..20).map(|i| x + step * 0.5_f64.powi(i));
            let tried = shorter.map(|to| (to, self.force(angle, &to)));
            let Some((to, left)) = tried.into_iter().find(|(_, left)| left.norm() < force.norm()) else {
                break;
            };
            (x, force) = (to, left);
        }
        // Where everything yields the forces do not change with X and Y, and Newton's method has nothing to go by.
        if force.norm() < 1e-6 * scale { x } else { self.bisected(angle) }
    }

    /// The same by bisection. Loads follow from a convex potential: the force along Y falls with Y, and at the Y where it
    /// vanishes the force along X falls with X.
    fn bisected(&self, angle: f64) -> Vector2<f64> {
        let [a, b] = self.cell.rectangle;
        // No step moves an 8-gon by more than half of the rectangle's circumference.
        let around = |middle: f64| [middle - 0.5 * (a + b), middle + 0.5 * (a + b)];
        let beside =
            |x: f64| falling_root(around(self.expansion.y), |y| self.force(angle, &Vector2::new(x, y)).y);
        let at = |x: f64| Vector2::new(x, beside(x));
        at(falling_root(around(self.expansion.x), |x| self.force(angle, &at(x)).x))
    }
}

/// Halvings of an interval: to a billionth of its length.
const HALVINGS: usize = 30;

/// Where a function that falls, or stays, passes zero in an interval.
fn falling_root([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if value(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The loads after a step: elastic, and brought back to the bounds where they are exceeded.
fn yielded(ligament: &Ligament, loads: &Loads, step: &Place) -> Loads {
    let spring = &ligament.spring;
    let force = ligament.full_force();
    let axial = (loads.axial + spring.axial * step[0]).clamp(-force, force);
    let shear = loads.shear + spring.shear * step[1];
    let moment = loads.moment + spring.bending * step[2];
    let (reach, full) = (ligament.reach, ligament.full_moment());
    let excess = moment.abs() + reach * shear.abs() - full;
    if excess <= 0.0 {
        return Loads { axial, shear, moment };
    }
    let flow = excess / (spring.bending + spring.shear * reach * reach);
    let (left_moment, left_shear) =
        (moment.abs() - spring.bending * flow, shear.abs() - spring.shear * reach * flow);
    // Beyond a corner of the bounds that corner is the closest point.
    let (moment_size, shear_size) = if left_moment < 0.0 {
        (0.0, full / reach)
    } else if left_shear < 0.0 {
        (full, 0.0)
    } else {
        (left_moment, left_shear)
    };
    Loads { axial, shear: shear_size.copysign(shear), moment: moment_size.copysign(moment) }
}

#[cfg(test)]
mod tests {
    use super::super::ligament::tests::nylon;
    use super::*;

    fn cell(side: f64, degrees: f64) -> Cell {
        Cell { rectangle: [side; 2], phi: f64::to_radians(degrees) }
    }

    #[test]
    fn without_yield_the_torque_is_the_slope_of_the_elastic_energy() {
        let cell = Cell { rectangle: [7.2, 6.5], phi: 0.28 };
        let ligament = Ligament { yield_strain: 1e6, ..nylon(0.0) };
        let passage = pass(&cell, &ligament, 56);
        for (i, torque) in passage.torques.iter().enumerate() {
            let (angle, h) = (cell.phi - 0.01 * (i + 1) as f64, 1e-5);
            let slope = (cell.energy(&ligament, angle - h) - cell.energy(&ligament, angle + h)) / (2.0 * h);
            // Central differences, and finite differences in the torque itself.
            assert!((torque - slope).abs() < 1e-5 * passage.resistance, "{i}: {torque} {slope}");
        }
    }

    #[test]
    fn loads_stay_within_their_bounds() {
        let ligament = nylon(0.0);
        let mut loads = Loads::default();
        let mut yields = 0;
        for i in 0..200 {
            let t = f64::from(i);
            let step = [0.01 * (0.3 * t).sin(), 0.01 * (0.2 * t).cos(), 0.02 * (0.11 * t).sin()];
            loads = yielded(&ligament, &loads, &step);
            let used = (loads.moment.abs() + ligament.reach * loads.shear.abs()) / ligament.full_moment();
            assert!(used < 1.0 + 1e-12 && loads.axial.abs() <= ligament.full_force());
            yields += usize::from(used > 1.0 - 1e-9);
        }
        assert!(yields > 20, "{yields}");
    }

    #[test]
    fn nothing_pulls_on_the_pieces_even_where_all_hinges_yield() {
        let cell = Cell { rectangle: [16.8, 12.0], phi: 0.31 };
        for yield_strain in [0.0016, 0.025] {
            let ligament = Ligament { yield_strain, ..nylon(0.0) };
            let mut state = Cycle::new(&cell, &ligament);
            for i in 1..=24 {
                let angle = cell.phi * (1.0 - f64::from(i) / 12.0);
                let expansion = state.balance(angle);
                let force = state.force(angle, &expansion);
                assert!(force.norm() < 1e-4 * ligament.full_force(), "{yield_strain} {i} {force}");
                state.go(angle);
            }
        }
    }

    #[test]
    fn torque_scales_with_modulus_alone() {
        let cell = cell(7.2, 15.0);
        let soft = nylon(0.0);
        let mut stiff = soft;
        let spring = &mut stiff.spring;
        for constant in [&mut spring.bending, &mut spring.axial, &mut spring.shear] {
            *constant *= 2.0;
        }
        stiff.unit_force *= 2.0;
        stiff.unit_moment *= 2.0;
        let (one, two) = (pass(&cell, &soft, 48), pass(&cell, &stiff, 48));
        for (p, q) in one.torques.iter().zip(&two.torques) {
            assert!((q - 2.0 * p).abs() < 1e-6 * two.resistance);
        }
    }

    #[test]
    fn notches_snap_and_a_millimetre_more_makes_them_too_loose() {
        // The paper's observation (section 4.2), on a sheet of cells of 20 mm: rectangle 7.2 mm, 13 degrees.
        let cell = cell(7.2, 13.0);
        let (short, long) = (pass(&cell, &nylon(0.0), 60), pass(&cell, &nylon(1.0), 60));
        assert!(short.snaps() && !long.snaps(), "{} {}", short.release, long.release);
        assert!(long.resistance < 0.75 * short.resistance);
        // A sheet that opens further snaps with both, but with a fraction of the torque.
        let wide = super::tests::cell(8.4, 18.0);
        let (short, long) = (pass(&wide, &nylon(0.0), 60), pass(&wide, &nylon(1.0), 60));
        assert!(short.snaps() && long.snaps());
        assert!(long.release < 0.5 * short.release, "{} {}", short.release, long.release);
    }
}
