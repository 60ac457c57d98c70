//! One cell of the regular bistable pattern (section 2.2, Fig. 5) in the plane, along its symmetric path.
//!
//! The rectangle of hinge points turns about its middle from +phi to -phi. Each of its corners is hinged to an 8-gon that
//! only moves: by (X, Y) and its mirror images. X and Y, the expansions of the cell, are free; they take the values of
//! least energy. Rectangle and 8-gons would fit exactly at +-phi; between, the rectangle is too large by the factor
//! cos(angle) - cos(phi) of its own size, which is at most 1 - cos(phi).

use nalgebra::{Matrix2, Rotation2, Vector2};

use super::ligament::Ligament;

/// The rectangle of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Sides a and b of the rectangle of hinge points, millimetres.
    pub rectangle: [f64; 2],
    /// Half the angle by which it turns, radians.
    pub phi: f64,
}

/// One of the two kinds of corners, each of which occurs twice, at opposite corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// The hinge point on the rectangle, the rectangle not turned.
    pub at: Vector2<f64>,
    /// Signs of X and Y in the motion of its 8-gon.
    pub moves: Vector2<f64>,
    /// Direction of the ligament's axis on the rectangle, the rectangle not turned.
    pub axis: Vector2<f64>,
}

/// Displacement of a hinge's two points against each other, in the frame midway between its two pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// Along the ligament's axis and across it, millimetres.
    pub along: Vector2<f64>,
    /// Columns: the directions along and across, in the cell's frame.
    pub frame: Matrix2<f64>,
}

impl Cell {
    /// The corners: upper left, at the end of the slit along the upper side, and upper right, at the end of the right one.
    pub fn corners(&self) -> [Corner; 2] {
        let [a, b] = self.rectangle;
        [
            Corner {
                at: Vector2::new(-0.5 * a, 0.5 * b),
                moves: Vector2::new(1.0, 1.0),
                axis: Vector2::new(0.0, 1.0),
            },
            Corner {
                at: Vector2::new(0.5 * a, 0.5 * b),
                moves: Vector2::new(1.0, -1.0),
                axis: Vector2::new(1.0, 0.0),
            },
        ]
    }

    /// The misfit at a corner where the rectangle stands at `angle` and the cell has expanded by `expansion`.
    pub fn misfit(&self, corner: &Corner, angle: f64, expansion: &Vector2<f64>) -> Misfit {
        let gone = Rotation2::new(angle) * corner.at - Rotation2::new(self.phi) * corner.at;
        // The rectangle has turned by angle - phi since it was cut, the 8-gon not at all.
        let axis = Rotation2::new(0.5 * (angle + self.phi)) * corner.axis;
        let frame = Matrix2::from_columns(&[axis, Vector2::new(-axis.y, axis.x)]);
        Misfit { along: frame.transpose() * (gone - corner.moves.component_mul(expansion)), frame }
    }

    /// The expansions X and Y of least energy with the rectangle at `angle`.
    pub fn expansion(&self, ligament: &Ligament, angle: f64) -> Vector2<f64> {
        let springs = Vector2::new(ligament.spring.axial, ligament.spring.shear);
        let (mut matrix, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for corner in self.corners() {
            let Misfit { along, frame } = self.misfit(&corner, angle, &Vector2::zeros());
            let toward = frame.transpose() * Matrix2::from_diagonal(&corner.moves);
            matrix += toward.transpose() * Matrix2::from_diagonal(&springs) * toward;
            right += toward.transpose() * springs.component_mul(&along);
        }
        matrix.try_inverse().unwrap_or_else(Matrix2::zeros) * right
    }

    /// Energy of the cell's four hinges with the rectangle at `angle`, mJ. Rest is as cut, at phi.
    pub fn energy(&self, ligament: &Ligament, angle: f64) -> f64 {
        let expansion = self.expansion(ligament, angle);
        let spring = &ligament.spring;
        let misfits: f64 = self
            .corners()
            .iter()
            .map(|corner| {
                let Misfit { along, .. } = self.misfit(corner, angle, &expansion);
                spring.axial * along.x.powi(2) + spring.shear * along.y.powi(2)
            })
            .sum();
        misfits + 2.0 * spring.bending * (angle - self.phi).powi(2)
    }

    /// Largest nominal strain of the two kinds of ligaments with the rectangle at `angle`, elastic.
    pub fn strain(&self, ligament: &Ligament, angle: f64) -> f64 {
        let expansion = self.expansion(ligament, angle);
        let spring = &ligament.spring;
        let strain = |corner: &Corner| {
            let Misfit { along, .. } = self.misfit(corner, angle, &expansion);
            ligament.strain(angle - self.phi, spring.axial * along.x, spring.shear * along.y)
        };
        self.corners().iter().map(strain).fold(0.0, f64::max)
    }

    /// The elastic path in `steps` equal turns.
    pub fn path(&self, ligament: &Ligament, steps: usize) -> ElasticPath {
        let angle = |i: usize| self.phi * (1.0 - 2.0 * i as f64 / steps as f64);
        let energies: Vec<f64> = (0..=steps).map(|i| self.energy(ligament, angle(i))).collect();
        let strain = (0..=steps).map(|i| self.strain(ligament, angle(i))).fold(0.0, f64::max);
        let Wells { barrier, back_barrier, .. } = wells(&energies);
        ElasticPath { energies, barrier, back_barrier, largest_strain: strain }
    }
}

/// A cell's energies on its elastic path.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticPath {
    /// Energies at equal turns from +phi to -phi, mJ.
    pub energies: Vec<f64>,
    /// Energy to get over on the way out, mJ.
    pub barrier: f64,
    /// Energy to get over on the way back, mJ; 0 where there is no second minimum.
    pub back_barrier: f64,
    /// Largest nominal strain on the way.
    pub largest_strain: f64,
}

/// What a row of energies has of hills and wells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wells {
    /// The hill's index: the highest point that has a lower one after it; the last index where there is none.
    pub top: usize,
    /// Energy from the first to the hill.
    pub barrier: f64,
    /// Energy from the lowest point after the hill back to it; 0 where there is none.
    pub back_barrier: f64,
}

/// Finds the hill between two wells: the place from which the energies after it fall deepest.
pub fn wells(energies: &[f64]) -> Wells {
    let last = energies.len() - 1;
    let mut found = Wells { top: last, barrier: energies[last] - energies[0], back_barrier: 0.0 };
    let mut lowest_after = energies[last];
    for (i, &energy) in energies.iter().enumerate().rev() {
        lowest_after = lowest_after.min(energy);
        if energy - lowest_after > found.back_barrier {
            found = Wells { top: i, barrier: energy - energies[0], back_barrier: energy - lowest_after };
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::ligament::{Spring, tests::nylon};
    use super::*;

    fn cell() -> Cell {
        Cell { rectangle: [7.2, 6.0], phi: 0.3 }
    }

    /// Springs alike along and across.
    fn even(bending: f64) -> Ligament {
        let ligament = nylon(0.0);
        Ligament { spring: Spring { bending, axial: 900.0, shear: 900.0, ..ligament.spring }, ..ligament }
    }

    #[test]
    fn even_springs_have_the_closed_form() {
        // The four corners stand off by c times their place: E = k c^2 (a^2 + b^2) / 2 + 2 K (angle - phi)^2.
        let cell = cell();
        for angle in [0.3, 0.21, 0.0, -0.17, -0.3] {
            let c = f64::cos(angle) - cell.phi.cos();
            let expected = 450.0 * c * c * (7.2 * 7.2 + 36.0) + 80.0 * (angle - cell.phi).powi(2);
            assert!((cell.energy(&even(40.0), angle) - expected).abs() < 1e-10, "{angle}");
        }
    }

    #[test]
    fn without_bending_both_states_are_alike_and_free_of_strain() {
        let cell = cell();
        let path = cell.path(&even(0.0), 40);
        for (i, energy) in path.energies.iter().enumerate() {
            assert!((energy - path.energies[40 - i]).abs() < 1e-10);
        }
        assert!(path.energies[0].abs() < 1e-20 && path.energies[40].abs() < 1e-20);
        assert!(path.barrier > 1.0 && (path.barrier - path.back_barrier).abs() < 1e-10);
        // Uneven springs: no strain at the ends either.
        let mut uneven = nylon(0.0);
        uneven.spring.bending = 0.0;
        assert!(cell.energy(&uneven, -cell.phi).abs() < 1e-20 && cell.energy(&uneven, 0.0) > 0.1);
        // The expansion of Eq. (2): 2 X = 2 b sin phi, 2 Y = 2 a sin phi.
        let expansion = cell.expansion(&uneven, -cell.phi);
        let expected = Vector2::new(6.0, 7.2) * cell.phi.sin();
        assert!((expansion - expected).norm() < 1e-12);
    }

    #[test]
    fn soft_shear_takes_up_the_misfit() {
        // Along and across share the misfit like springs in series: to first order E = k_s c^2 (a^2 + b^2).
        let cell = Cell { rectangle: [7.0, 7.0], phi: 0.005 };
        let mut ligament = nylon(1.0);
        ligament.spring.bending = 0.0;
        let c = 1.0 - cell.phi.cos();
        let expected = ligament.series() * c * c * 98.0;
        // The ligaments' frames stand off by half of phi: first order.
        assert!((cell.energy(&ligament, 0.0) / expected - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_second_minimum_needs_stiff_springs_beside_soft_hinges() {
        // E = q (phi^2 - x^2)^2 / 4 + 2 K (phi - x)^2 has one below K = q phi^2 / 16, to leading order in phi.
        let cell = Cell { rectangle: [7.0, 7.0], phi: 0.1 };
        let limit = 450.0 * 98.0 * cell.phi.powi(2) / 16.0;
        assert!(cell.path(&even(0.97 * limit), 400).back_barrier > 0.0);
        assert_eq!(cell.path(&even(1.03 * limit), 400).back_barrier, 0.0);
    }

    #[test]
    fn wells_of_plain_rows() {
        assert_eq!(wells(&[0.0, 3.0, 1.0, 2.0]), Wells { top: 1, barrier: 3.0, back_barrier: 2.0 });
        assert_eq!(wells(&[0.0, 1.0, 2.0]), Wells { top: 2, barrier: 2.0, back_barrier: 0.0 });
        assert_eq!(wells(&[0.0, 0.0, 0.0]).back_barrier, 0.0);
    }

    #[test]
    fn finite_elements_of_a_whole_cell_agree() {
        // Energy over modulus and thickness of a cell of 20 mm, rectangle 8.4 mm, phi 18 degrees, of which the pieces are
        // meshed too: largest, and least after it (tests/oracle/snap_cell.py).
        let cell = Cell { rectangle: [8.4; 2], phi: 18_f64.to_radians() };
        for (straight, top, bottom) in [(0.0, 0.00950, 0.00714), (1.0, 0.00476, 0.00372)] {
            let path = cell.path(&nylon(straight), 72);
            let plate = 3300.0 * 5.0;
            let low = path.barrier - path.back_barrier;
            assert!((path.barrier / plate / top - 1.0).abs() < 0.15, "{}", path.barrier / plate);
            assert!((low / plate / bottom - 1.0).abs() < 0.15, "{}", low / plate);
        }
    }
}
