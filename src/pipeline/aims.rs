//! What the two states of a job are to become.

use super::surfaces::TargetMesh;
use crate::geometry::closest::ClosestPoints;
use crate::kirigami::control_mesh::{Goal, Goals, Target};
use crate::kirigami::design::State;

/// What a state is to become, with what that needs.
pub(super) enum Aim {
    /// A flat sheet.
    Plane,
    /// A surface, border to boundary or only lying in it.
    Surface(Box<Target>, Outline),
    /// Whatever its pieces make of it.
    Free,
}

/// Whether the border of the sheet is held to the boundary of a surface.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Outline {
    Held,
    Left,
}

impl Aim {
    fn goal(&self) -> Goal<'_> {
        match self {
            Self::Plane => Goal::Plane,
            Self::Surface(target, outline) => Goal::Surface { target, outline: *outline == Outline::Held },
            Self::Free => Goal::Free,
        }
    }
}

/// What both states are to become.
pub(super) struct Aims {
    pub closed: Aim,
    pub open: Aim,
}

impl Aims {
    /// What the optimisation is told of them.
    pub fn goals(&self) -> Goals<'_> {
        Goals { closed: self.closed.goal(), open: self.open.goal(), guides: &[] }
    }

    /// The surfaces, with the states that are to become them.
    pub fn surfaces(self) -> Vec<(State, ClosestPoints)> {
        let surface = |(state, aim)| match aim {
            Aim::Surface(target, _) => Some((state, target.surface)),
            _ => None,
        };
        [(State::Closed, self.closed), (State::Open, self.open)].into_iter().filter_map(surface).collect()
    }
}

/// A target as what a state is to become.
pub(super) fn surface(target: TargetMesh, outline: Outline) -> Aim {
    Aim::Surface(Box::new(Target::new(target.mesh, &target.cycle)), outline)
}
