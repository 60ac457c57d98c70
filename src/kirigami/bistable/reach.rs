//! Whether bistable cells can have the stretches that a target asks for: predicted before anything is optimised.
//!
//! A bistable sheet only grows: both principal stretches are more than 1 (Eq. (2)), and inequalities (3) bound them from
//! above, for square cells by sqrt 2 (both equal) at 22.5 degrees.

use super::cell::BistableCell;
use crate::geometry::Point3;
use crate::kirigami::piece_mesh::PieceMesh;

/// What a place of the target asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// Sides of the cell there in the unexpanded state, millimetres.
    pub cell: [f64; 2],
    /// The stretches along the grid's two directions.
    pub stretches: [f64; 2],
    /// The place, on the target.
    pub at: Point3,
}

/// A target that asks for more, or less, than the cells can give.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", describe(self))]
pub struct OutOfReach {
    /// The part of all cells that cannot be.
    pub share: f64,
    /// Least stretch asked for, and where.
    pub least: (f64, Point3),
    /// The pair of stretches that is farthest beyond the cells' reach, and where; `None` where the least one alone is out of
    /// reach.
    pub most: Option<([f64; 2], Point3)>,
    /// Proportions that would reach everything, and the nearest to those asked for; `None` where there are none.
    pub proposal: Option<BistableCell>,
}

/// What is asked of bistable cells, where, and what would do.
fn describe(reach: &OutOfReach) -> String {
    let place = |at: &Point3| format!("near ({:.2}, {:.2}, {:.2}) mm", at.x, at.y, at.z);
    let (least, at) = &reach.least;
    let mut asked = vec![format!(
        "{:.0} % of the cells are out of reach. The least stretch that the target asks for is {least:.3} {}, and bistable cells \
         only grow, by more than 1",
        100.0 * reach.share,
        place(at)
    )];
    if let Some(([m1, m2], at)) = &reach.most {
        asked.push(format!(
            "the most is {m1:.3} by {m2:.3} {}, for which no rectangle keeps inequalities (3) with necks as wide as hinges need",
            place(at)
        ));
    }
    let remedy = match &reach.proposal {
        Some(BistableCell { cell: [long, wide], rectangle: [a, b], phi, .. }) => format!(
            "with A = 1 and B = {:.3} take phi_deg = {:.1}, a = {:.3}, b = {:.3}",
            wide / long,
            phi.to_degrees(),
            a / long,
            b / long
        ),
        None => String::from(
            "no phi_deg, a and b reach all of it, since a cell's stretches lie between 1 and about 1.4: cut the target into \
             parts that curve less, or take larger cells",
        ),
    };
    format!("the target asks for what bistable cells cannot do: {}; {remedy}", asked.join("; "))
}

/// The part of the cells that may be out of reach: the optimisation levels out what is asked of few cells.
const MOST_SHARE: f64 = 0.02;

/// Checks what a target asks of cells like this `model`, whose necks must be wider than `neck`, millimetres.
///
/// # Errors
/// More than a few cells that would have to shrink, or to grow by more than any rectangle allows.
pub fn check(model: &BistableCell, asked: &[Asked], neck: f64) -> Result<(), Box<OutOfReach>> {
    let possible = |asked: &Asked, factor: f64| {
        let stretches = asked.stretches.map(|m| m * factor);
        BistableCell::with_stretches(asked.cell, stretches, model.gap, neck).is_some()
    };
    let beyond = |asked: &&Asked| !possible(asked, 1.0);
    let share = asked.iter().filter(beyond).count() as f64 / asked.len() as f64;
    if share <= MOST_SHARE {
        return Ok(());
    }
    let least_of = |asked: &Asked| asked.stretches[0].min(asked.stretches[1]);
    let least = asked.iter().map(|asked| (least_of(asked), asked.at)).min_by(|p, q| p.0.total_cmp(&q.0));
    let too_much = asked.iter().filter(beyond).filter(|asked| least_of(asked) > 1.0);
    let most =
        too_much.max_by(|p, q| product(p).total_cmp(&product(q))).map(|asked| (asked.stretches, asked.at));
    let (value, at) = least.unwrap_or((f64::NAN, Point3::origin()));
    Err(Box::new(OutOfReach {
        share,
        least: (value, at),
        most,
        proposal: proposal(model, asked, neck, possible),
    }))
}

fn product(asked: &Asked) -> f64 {
    asked.stretches[0] * asked.stretches[1]
}

/// The model nearest to those asked for with which a target's stretches, all times the factor by which the cell's own
/// change, are within reach.
fn proposal(
    model: &BistableCell,
    asked: &[Asked],
    neck: f64,
    possible: impl Fn(&Asked, f64) -> bool,
) -> Option<BistableCell> {
    const STEPS: i32 = 60;
    let beyond = |factor: f64| asked.iter().filter(|asked| !possible(asked, factor)).count();
    // From no change on, in steps of less than a per cent up and down.
    let factors = (0..=STEPS).flat_map(|i| [i, -i]).map(|i| 1.008_f64.powi(i));
    let mut within = factors.filter(|&factor| beyond(factor) as f64 <= MOST_SHARE * asked.len() as f64);
    let stretches = within.next().map(|factor| model.stretches().map(|m| m * factor))?;
    BistableCell::with_stretches(model.cell, stretches, model.gap, neck)
}

/// How far a target twists against the grid: cells bend along the grid's two directions, not across both at once, because
/// the four pieces around a rectangle would have to leave its plane to opposite sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// Distance between the middles of an open quad's diagonals, square to the quad, millimetres.
    pub by: f64,
    /// Over the quad's mean side.
    pub share: f64,
    /// Where, in the open state.
    pub at: Point3,
}

/// The quad of the open control mesh that is most twisted.
pub fn most_twisted(grid: &PieceMesh, open: &[Point3]) -> Option<Twist> {
    let twist = |quad: &Vec<usize>| {
        let [a, b, c, d] = quad[..] else { return None };
        let [a, b, c, d] = [a, b, c, d].map(|corner| open[corner].coords);
        let normal = (c - a).cross(&(d - b)).try_normalize(0.0)?;
        let by = (0.5 * normal.dot(&(a + c - b - d))).abs();
        let sides = [b - a, c - b, d - c, a - d].map(|side| side.norm());
        let share = by / (0.25 * sides.iter().sum::<f64>());
        Some(Twist { by, share, at: Point3::from(0.25 * (a + b + c + d)) })
    };
    grid.pieces.iter().filter_map(twist).max_by(|p, q| p.share.total_cmp(&q.share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point2, Vector2};
    use crate::kirigami::cover::{PieceSize, cover};

    #[test]
    fn a_saddle_twists_along_its_straight_lines_and_not_along_its_curves() {
        let outline = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]].map(|[x, y]| Point2::new(x, y));
        let grid = cover(&outline, &Vector2::x(), PieceSize::Counts([6, 4]), [1.0; 2], 0.0, None).unwrap();
        let on = |height: &dyn Fn(f64, f64) -> f64| -> Vec<Point3> {
            grid.corners.iter().map(|p| Point3::new(p.x, p.y, height(p.x, p.y))).collect()
        };
        // z = c x y leaves the plane of a quad of sides 10 by c 10 10 / 4 at each corner.
        let twisted = most_twisted(&grid.mesh, &on(&|x, y| 1e-3 * x * y)).unwrap();
        assert!((twisted.by - 0.05).abs() < 1e-4 && (twisted.share - 0.005).abs() < 1e-5, "{twisted:?}");
        let curved = most_twisted(&grid.mesh, &on(&|x, y| 1e-3 * (x * x - y * y))).unwrap();
        assert!(curved.by < 1e-12, "{curved:?}");
    }

    fn asked(stretches: &[[f64; 2]]) -> Vec<Asked> {
        let at = |i: usize| Point3::new(i as f64, 0.0, 0.0);
        let cells = stretches.iter().enumerate();
        cells.map(|(i, &stretches)| Asked { cell: [10.0; 2], stretches, at: at(i) }).collect()
    }

    #[test]
    fn contraction_and_too_much_growth_are_out_of_reach() {
        let cell = BistableCell { cell: [1.0; 2], rectangle: [0.42; 2], phi: 0.314, gap: 0.0 };
        assert!(check(&cell, &asked(&[[1.2, 1.25], [1.3, 1.2], [1.05, 1.1]]), 0.0).is_ok());
        let shrinks = check(&cell, &asked(&[[1.2, 1.25], [0.95, 1.1]]), 0.0).unwrap_err();
        assert_eq!((shrinks.least.0, shrinks.least.1.x, shrinks.share, shrinks.most), (0.95, 1.0, 0.5, None));
        let grows = check(&cell, &asked(&[[1.5, 1.4], [1.1, 1.1]]), 0.0).unwrap_err();
        assert_eq!(grows.most.unwrap().0, [1.5, 1.4]);
    }

    #[test]
    fn a_proposal_reaches_what_was_out_of_reach() {
        let cell = BistableCell { cell: [1.0; 2], rectangle: [0.42; 2], phi: 0.1, gap: 0.0 };
        let stretches = [[0.97, 1.0], [1.1, 1.15]];
        let found = check(&cell, &asked(&stretches), 0.0).unwrap_err().proposal.unwrap();
        assert!(found.misses().is_empty());
        // The target's stretches follow the cell's own.
        let factor = found.stretches()[0] / cell.stretches()[0];
        let moved: Vec<[f64; 2]> = stretches.iter().map(|s| s.map(|m| m * factor)).collect();
        assert!(check(&found, &asked(&moved), 0.0).is_ok());
        // From 1 to more than sqrt 2 no cell reaches.
        assert!(check(&cell, &asked(&[[0.9, 0.9], [1.5, 1.5]]), 0.0).unwrap_err().proposal.is_none());
    }
}
