//! What a plan takes: lengths, travel, time, cost.

use std::fmt;

use kurbo::Vec2;

use super::{CutOptions, CutOrder, Pierce};
use crate::fabrication::layout::CutPath;
use crate::fabrication::order::{Rest, Travel, travel};
use crate::profile::{Machine, Profile};

/// Chords stay so near to arcs where lengths are measured, millimetres.
const FLAT: f64 = 1e-3;

/// Seconds, estimated at constant speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Along the cuts, all passes together.
    pub cutting: f64,
    /// Between cuts, and back to the beginning of open ones between passes.
    pub travel: f64,
    /// Piercing, once per cut and pass.
    pub piercing: f64,
    /// What an hour costs, in the profile's currency.
    pub hourly_rate: Option<f64>,
}

impl Times {
    /// Seconds in all.
    pub fn total(&self) -> f64 {
        self.cutting + self.travel + self.piercing
    }

    /// What that costs.
    pub fn cost(&self) -> Option<f64> {
        self.hourly_rate.map(|rate| rate * self.total() / 3600.0)
    }
}

/// Figures of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct CutReport {
    /// Where every copy lies, from the first.
    pub copies: Vec<Vec2>,
    /// Width of the groove, which is applied once, in the paths, millimetres.
    pub kerf: f64,
    /// How often the beam follows each cut.
    pub passes: usize,
    /// Number of cuts; each is pierced once per pass.
    pub cuts: usize,
    /// Length of the cuts, one pass, millimetres.
    pub length: f64,
    /// The way between them.
    pub travel: Travel,
    /// The time; `None` where the profile does not tell the machine's speeds.
    pub times: Option<Times>,
    /// Where slits are pierced.
    pub pierce: Pierce,
    /// What the order saves.
    pub order: CutOrder,
    /// The rest of hinges between cuts.
    pub rest: Rest,
}

impl CutReport {
    pub(super) fn new(
        paths: &[CutPath],
        copies: Vec<Vec2>,
        rest: Rest,
        profile: &Profile,
        options: &CutOptions,
    ) -> Self {
        let travel = travel(paths);
        let length: f64 = paths.iter().map(CutPath::length).sum();
        let again = (options.passes - 1) as f64;
        let open = paths.iter().filter(|path| !path.closed);
        let back: f64 = open
            .map(|path| path.vertices[0].point.distance(path.vertices[path.vertices.len() - 1].point))
            .sum();
        let times =
            profile.machine.as_ref().map(|&Machine { rapid_speed, pierce_time, hourly_rate }| Times {
                cutting: length / profile.cut.speed,
                travel: (travel.length + again * back) / rapid_speed,
                piercing: pierce_time * (options.passes * paths.len()) as f64,
                hourly_rate,
            });
        let (kerf, passes, cuts) = (profile.cut.kerf, options.passes, paths.len());
        let CutOptions { pierce, order, .. } = *options;
        CutReport { copies, kerf, passes, cuts, length, travel, times, pierce, order, rest }
    }
}

impl CutPath {
    /// Length of the centre line, millimetres.
    pub fn length(&self) -> f64 {
        self.segments(FLAT).iter().map(|[a, b]| a.distance(*b)).sum()
    }
}

/// Hours, minutes or seconds, as a person would say.
fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..=119 => format!("{seconds:.1} s"),
        120..=7199 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

impl fmt::Display for CutReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let copies = match self.copies.len() {
            1 => String::new(),
            count => format!("{count} copies, "),
        };
        let passes = match self.passes {
            1 => String::new(),
            count => format!(", {count} passes"),
        };
        let Travel { length, bound } = self.travel;
        let ratio = if bound > 0.0 { length / bound } else { 1.0 };
        write!(
            f,
            "{copies}{} cuts of {:.2} m{passes}; {:.2} m between them, {ratio:.3} of the bound ({:.2} m)",
            self.cuts,
            1e-3 * self.length,
            1e-3 * length,
            1e-3 * bound,
        )?;
        if let CutOrder::Heat(cool) = self.order {
            let Rest { least, early } = self.rest;
            write!(
                f,
                "; {early} begin before a hinge has rested {cool} s, the least is {}",
                duration(least)
            )?;
        }
        if let Some(times) = &self.times {
            write!(
                f,
                "; about {}: cutting {}, travel {}, piercing {}",
                duration(times.total()),
                duration(times.cutting),
                duration(times.travel),
                duration(times.piercing),
            )?;
            if let Some((cost, rate)) = times.cost().zip(times.hourly_rate) {
                write!(f, "; cost {cost:.2} at {rate:.2} an hour")?;
            }
        }
        Ok(())
    }
}
