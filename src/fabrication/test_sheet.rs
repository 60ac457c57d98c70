//! Exact flat designs for tests, without an optimiser: the rotating-rectangle mechanism in closed form.
//!
//! With hinge points g apart the hinge polygons of a lattice of cells a x b are congruent parallelograms and their
//! mirror images; turned by +phi and -phi they still form a mechanism with flat open states. Border corners
//! without a passing slit are moved inwards by g/2, on to the lattice's own hinge points, so the border's cut runs
//! on the lattice lines.

use std::collections::BTreeMap;

use kurbo::Point;

use crate::fabrication::layout::CutPath;
use crate::geometry::{Point3, Vector3};
use crate::kirigami::design::{Design, Hinge, PatternKind, Piece, State};
use crate::profile::{Beam, Cut, Ligament, Machine, Material, Pole, Process, Profile, Shape, Sheet};

/// Rounding of coordinates of some 100 mm through a few dozen operations.
pub const ROUNDING: f64 = 1e-9;

/// A lattice sheet.
#[derive(Debug, Clone, Copy)]
pub struct TestSheet {
    /// Cells in x and y.
    pub cells: [usize; 2],
    /// Cell size a and b, millimetres.
    pub size: [f64; 2],
    /// Gap between hinge points, millimetres.
    pub gap: f64,
    /// Whether a cell holds a piece.
    pub present: fn(usize, usize) -> bool,
}

impl TestSheet {
    /// A full rectangle of cells.
    pub fn rectangle(cells: [usize; 2], size: [f64; 2], gap: f64) -> Self {
        TestSheet { cells, size, gap, present: |_, _| true }
    }

    fn has(&self, i: i64, j: i64) -> bool {
        let [nx, ny] = self.cells.map(|n| n as i64);
        (0..nx).contains(&i) && (0..ny).contains(&j) && (self.present)(i as usize, j as usize)
    }

    /// The angle that opens the lattice's holes of side a to squares; each piece turns by it.
    pub fn full_angle(&self) -> f64 {
        std::f64::consts::FRAC_PI_4 - (0.5 * self.gap).atan2(self.size[0] - 0.5 * self.gap)
    }

    /// Corner midpoint and, for each piece around (by its offset), its closed vertex.
    fn corner(&self, i: i64, j: i64) -> ([f64; 2], impl Fn(i64, i64) -> [f64; 2]) {
        let has = |di: i64, dj: i64| self.has(i - 1 + di, j - 1 + dj); // di, dj: 0 = low side, 1 = high side
        let vertical_slit = (i + j) % 2 == 0;
        let interior = |side: i64| {
            if vertical_slit { has(0, side) && has(1, side) } else { has(side, 0) && has(side, 1) }
        };
        let passing = interior(0) || interior(1);
        let half = 0.5 * self.gap;
        let count = |pieces: [(i64, i64); 2]| pieces.iter().filter(|(di, dj)| has(*di, *dj)).count() as f64;
        let inward = [
            (count([(1, 0), (1, 1)]) - count([(0, 0), (0, 1)])).clamp(-1.0, 1.0),
            (count([(0, 1), (1, 1)]) - count([(0, 0), (1, 0)])).clamp(-1.0, 1.0),
        ];
        let pieces = [(0, 0), (1, 0), (0, 1), (1, 1)].iter().filter(|(di, dj)| has(*di, *dj)).count();
        let shift = if pieces <= 2 { half } else { 0.0 };
        let middle =
            [i as f64 * self.size[0] + shift * inward[0], j as f64 * self.size[1] + shift * inward[1]];
        let vertex = move |di: i64, dj: i64| {
            let sign = |side: i64| if side == 1 { half } else { -half };
            match (passing, vertical_slit) {
                (false, _) => middle,
                (true, true) => [middle[0] + sign(di), middle[1]],
                (true, false) => [middle[0], middle[1] + sign(dj)],
            }
        };
        (middle, vertex)
    }

    /// The design, each piece turned by `phi` in the open state.
    pub fn design(&self, phi: f64) -> Design {
        let mut corner_ids = BTreeMap::new();
        let mut corners = Vec::new();
        let mut pieces = Vec::new();
        let mut senses = Vec::new();
        let [nx, ny] = self.cells.map(|n| n as i64);
        for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
            if !self.has(i, j) {
                continue;
            }
            let mut piece = Piece { corners: vec![], closed: vec![], open: vec![] };
            for (ci, cj) in [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)] {
                let (middle, vertex) = self.corner(ci, cj);
                let id = *corner_ids.entry((ci, cj)).or_insert_with(|| {
                    corners.push(Point3::new(middle[0], middle[1], 0.0));
                    corners.len() - 1
                });
                let [x, y] = vertex(i - ci + 1, j - cj + 1);
                piece.corners.push(id);
                piece.closed.push(Point3::new(x, y, 0.0));
            }
            pieces.push(piece);
            senses.push(if (i + j) % 2 == 0 { 1.0 } else { -1.0 });
        }
        let hinges = hinges(&pieces, &senses, phi);
        open(&mut pieces, &hinges, &senses, phi);
        Design {
            pattern: PatternKind::RotatingRectangles,
            sheet_state: Some(State::Closed),
            gap: self.gap,
            corners,
            pieces,
            hinges,
        }
    }
}

/// The same pieces cut in the open state.
pub fn cut_open(mut design: Design) -> Design {
    design.sheet_state = Some(State::Open);
    for hinge in &mut design.hinges {
        hinge.point = design.pieces[hinge.pieces[0]].open[hinge.vertices[0]];
        // In the plane both frames share the axis; closing turns the other way.
        hinge.axis = -hinge.axis;
    }
    design
}

fn hinges(pieces: &[Piece], senses: &[f64], phi: f64) -> Vec<Hinge> {
    let mut hinges = Vec::new();
    for (j, piece) in pieces.iter().enumerate().filter(|&(j, _)| senses[j] > 0.0) {
        for v in 0..4 {
            // A counter-clockwise piece is hinged at each side's start, where its neighbour's side ends.
            let side = [piece.corners[v], piece.corners[(v + 1) % 4]];
            for (k, other) in pieces.iter().enumerate() {
                let w =
                    (0..4).find(|&w| [other.corners[(w + 3) % 4], other.corners[w]] == [side[1], side[0]]);
                let Some(w) = w else { continue };
                // Seen from j (turned by +phi), k turns by -2 phi; ids alternate in order to test both signs.
                let (pieces, vertices, axis) = if hinges.len() % 2 == 0 {
                    ([j, k], [v, w], -Vector3::z())
                } else {
                    ([k, j], [w, v], Vector3::z())
                };
                hinges.push(Hinge { pieces, vertices, point: piece.closed[v], axis, angle: 2.0 * phi });
            }
        }
    }
    hinges
}

/// Places all pieces from the first one across the hinges.
fn open(pieces: &mut [Piece], hinges: &[Hinge], senses: &[f64], phi: f64) {
    let turn = |sense: f64, p: Point3| {
        let (sin, cos) = (sense * phi).sin_cos();
        Point3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, 0.0)
    };
    let place = |piece: &mut Piece, sense: f64, by: Vector3| {
        piece.open = piece.closed.iter().map(|&p| turn(sense, p) + by).collect();
    };
    place(&mut pieces[0], senses[0], Vector3::zeros());
    let mut changed = true;
    while changed {
        changed = false;
        for hinge in hinges {
            for (from, to) in [(0, 1), (1, 0)] {
                let [a, b] = [hinge.pieces[from], hinge.pieces[to]];
                if pieces[a].open.is_empty() || !pieces[b].open.is_empty() {
                    continue;
                }
                let target = pieces[a].open[hinge.vertices[from]];
                let by = target - turn(senses[b], pieces[b].closed[hinge.vertices[to]]);
                place(&mut pieces[b], senses[b], by);
                changed = true;
            }
        }
    }
}

/// A steel-like profile: 0.5 mm ligaments, 0.05 mm kerf, 600 x 600 mm stock.
pub fn profile() -> Profile {
    Profile {
        name: "test-steel".into(),
        process: Process::Laser,
        sheet: Sheet { width: 600.0, height: 600.0, margin: 5.0, thickness: 0.5 },
        material: Material {
            name: "test steel".into(),
            youngs_modulus: 193e3,
            conditioned_modulus: None,
            yield_strain: 0.00106,
            strain_limit: 0.4,
            elongation: 0.4,
            endurance_strain: Some(0.00124),
            coffin_manson: None,
        },
        cut: Cut { kerf: 0.05, min_web: 0.35, speed: 10.0, ruled: false, heat_affected: None },
        ligament: Ligament {
            width: 0.5,
            pole: Pole::Part(0.0),
            shape: Shape::Beam(Beam { min_length: 0.5, max_length: 2.0, root_compliance: 1.2 }),
        },
        machine: Some(Machine {
            rapid_speed: 500.0,
            pierce_time: 0.1,
            engrave_speed: None,
            hourly_rate: None,
        }),
        tool: None,
    }
}

#[test]
fn hinge_vertices_coincide_in_both_states() {
    for (sheet, phi) in sheets() {
        let design = sheet.design(phi);
        assert!(design.hinges.len() > 10);
        for hinge in &design.hinges {
            let [j, k] = [0, 1].map(|s| &design.pieces[hinge.pieces[s]]);
            let [v, w] = hinge.vertices;
            // Rounding of coordinates below 100 mm.
            assert!((j.closed[v] - k.closed[w]).norm() < 1e-12);
            assert!((j.open[v] - k.open[w]).norm() < 1e-11, "{hinge:?}");
        }
    }
}

/// A motion of the sheet: a turn by 0.7 radians and a shift.
pub fn turn(x: f64, y: f64) -> [f64; 2] {
    let (sin, cos) = 0.7_f64.sin_cos();
    [cos * x - sin * y + 3.0, sin * x + cos * y - 40.0]
}

/// Asserts that cuts are others after a motion of the sheet, up to rounding.
pub fn assert_moved(before: &[CutPath], after: &[CutPath], motion: impl Fn(f64, f64) -> [f64; 2]) {
    assert_eq!(before.len(), after.len());
    for (a, b) in before.iter().zip(after) {
        assert_eq!((a.kind, a.vertices.len()), (b.kind, b.vertices.len()));
        for (p, q) in a.vertices.iter().zip(&b.vertices) {
            let [x, y] = motion(p.point.x, p.point.y);
            assert!(q.point.distance(Point::new(x, y)) < ROUNDING);
            assert!((p.bulge - q.bulge).abs() < ROUNDING);
        }
    }
}

/// The design after a motion of the sheet plane, its pieces, vertices and hinges unchanged in number.
pub fn moved(design: &Design, motion: impl Fn(f64, f64) -> [f64; 2]) -> Design {
    let apply = |p: &mut Point3| {
        let [x, y] = motion(p.x, p.y);
        *p = Point3::new(x, y, p.z);
    };
    let mut design = design.clone();
    design.corners.iter_mut().for_each(apply);
    design.pieces.iter_mut().flat_map(|piece| &mut piece.closed).for_each(apply);
    design.hinges.iter_mut().map(|hinge| &mut hinge.point).for_each(apply);
    design
}

/// Sheets that the tests share: square and oblong cells, a trimmed outline, one with a window.
pub fn sheets() -> Vec<(TestSheet, f64)> {
    let gap = profile().hinge_gap();
    let square = TestSheet::rectangle([4, 3], [10.0, 10.0], gap);
    let oblong = TestSheet::rectangle([3, 4], [12.0, 9.0], gap);
    let stairs = TestSheet {
        cells: [6, 6],
        size: [8.0, 8.0],
        gap,
        present: |i, j| (i + j >= 2) && (i + j < 9) && !(i >= 4 && j == 0),
    };
    let window = TestSheet {
        cells: [7, 6],
        size: [9.0, 8.0],
        gap,
        present: |i, j| !((2..5).contains(&i) && (2..4).contains(&j)),
    };
    [square, oblong, stairs, window].map(|sheet| (sheet, sheet.full_angle())).into()
}
