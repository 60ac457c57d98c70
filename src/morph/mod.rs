//! The path between the two states: where every piece stands on the way, and what that costs.
//!
//! In general only the two end states are free of strain. `way` finds positions in between by constrained minimisation
//! ([`crate::snap::sheet`]): pieces are rigid, hinges are springs against all but the turn about their axes, and every hinge
//! is driven to the same part of its full angle. `measure` tells how far the hinges' points part there, how the hinges turn,
//! how much area the sheet covers, and where thick pieces run into each other.
//!
//! Frames: poses take a piece from where the design's sheet state has it (the closed state where neither is flat) to the
//! step. The first step is the closed state and the last one the open state, both as the design has them; in between the
//! sheet as a whole goes evenly from the one place to the other (`gauge`).

mod gauge;

mod measure;

mod way;

#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::geometry::rotation::RigidMotion;
use crate::kirigami::design::Design;
use crate::solid::clash::Clash;

pub use measure::Thick;

/// Steps from one state to the other.
pub const STEPS: usize = 24;

/// With more hinges `make` leaves the path out: these take some 7 s, and twice as many more than twice as long.
pub const MOST_HINGES: usize = 6000;

/// A sheet on its way from the closed to the open state.
#[derive(Debug, Clone, PartialEq)]
pub struct Morph {
    /// [`STEPS`] and one more, from the closed to the open state.
    pub steps: Vec<Step>,
    /// How far, in mean edges, the way that was found ends beside the closed state. More than a small part means that it
    /// found another position of the same angles, and that the first step jumps from there.
    pub jump: f64,
    /// Whether collisions were looked for.
    pub thick: bool,
}

/// A position on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// How far on the way, 0 (closed) to 1 (open), in equal steps.
    pub at: f64,
    /// The part of the hinges' full angles that they have turned, in sum.
    pub share: f64,
    /// One per piece, in the design's order: from its place in the sheet state (closed, where neither is flat).
    pub poses: Vec<RigidMotion>,
    /// Largest distance between the two points of a hinge, millimetres, and its hinge.
    pub parting: (f64, usize),
    /// Mean distance between the two points of a hinge, millimetres.
    pub mean_parting: f64,
    /// Largest distance between the two points of a hinge over the mean edge: the path's strain.
    pub strain: f64,
    /// Largest angle between a hinge's axis as its two pieces carry it, radians.
    pub lean: f64,
    /// Least, mean and largest turn of the hinges since the closed state, radians.
    pub angles: [f64; 3],
    /// Area of the sheet, holes filled, over that of the closed sheet: 1 and the design's own figure at the ends. In between
    /// holes count with their vector area, and a hinge's two points as one of them.
    pub area_expansion: f64,
    /// The two thick pieces that run farthest into each other beyond what may pass; `None` where none do, and at the ends,
    /// which [`crate::solid`] and the cut files' check answer for.
    pub collision: Option<Clash>,
}

impl Morph {
    /// The step of the largest strain.
    pub fn worst(&self) -> &Step {
        let all = self.steps.iter();
        all.max_by(|p, q| p.strain.total_cmp(&q.strain)).expect("a way has steps")
    }

    /// The step of the deepest collision, and the collision.
    pub fn collision(&self) -> Option<(&Step, &Clash)> {
        let all = self.steps.iter().filter_map(|step| Some((step, step.collision.as_ref()?)));
        all.max_by(|(_, p), (_, q)| p.excess().total_cmp(&q.excess()))
    }
}

/// Follows a design from its closed to its open state.
///
/// `thick`: the pieces as solids, where collisions are to be found.
pub fn morph(design: &Design, thick: Option<&Thick>) -> Morph {
    let way = way::poses(design);
    let measure = measure::Measure::new(design);
    let step = |(i, poses): (usize, Vec<RigidMotion>)| {
        let mut step = measure.step(poses);
        step.at = place(i);
        // The end states have checks of their own.
        let thick = thick.filter(|_| (1..STEPS).contains(&i));
        step.collision = thick.and_then(|thick| thick.collision(&step.poses));
        step
    };
    let mut steps: Vec<Step> = way.poses.into_par_iter().enumerate().map(step).collect();
    steps[0].area_expansion = 1.0;
    steps[STEPS].area_expansion = measure.open_expansion();
    Morph { steps, jump: way.jump, thick: thick.is_some() }
}

/// How far on the way a step is.
fn place(step: usize) -> f64 {
    step as f64 / STEPS as f64
}
