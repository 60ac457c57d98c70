//! What a plan takes: lengths, travel, time, cost.

use kurbo::{Point, Vec2};

use super::engrave::Engraved;
use super::{CutOptions, CutOrder, LeadShape, Pierce};
use crate::fabrication::cuts::end_gap;
use crate::fabrication::layout::{CutKind, CutPath, Tabs};
use crate::fabrication::order::{Rest, Travel, least_way, travel};
use crate::profile::{Machine, Profile};

/// Seconds, estimated at constant speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Along the cuts, all passes together.
    pub cutting: f64,
    /// Between cuts, and back to the beginning of open ones between passes.
    pub travel: f64,
    /// Piercing, once per cut and pass.
    pub piercing: f64,
    /// Along and between the engraved strokes; 0 without any, and where the profile does not tell the speed.
    pub engraving: f64,
    /// What an hour costs, in the profile's currency.
    pub hourly_rate: Option<f64>,
}

impl Times {
    /// Seconds in all.
    pub fn total(&self) -> f64 {
        self.cutting + self.travel + self.piercing + self.engraving
    }

    /// What that costs.
    pub fn cost(&self) -> Option<f64> {
        self.hourly_rate.map(|rate| rate * self.total() / 3600.0)
    }
}

/// The leads of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeadReport {
    /// Their shape.
    pub shape: LeadShape,
    /// How many there are.
    pub count: usize,
    /// Least and largest length, millimetres.
    pub lengths: [f64; 2],
    /// Windows, and stretches of a border, that have none because there is no room; they are pierced on their line.
    pub without: usize,
}

/// What is engraved on each part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngraveReport {
    /// Number of texts.
    pub texts: usize,
    /// Length of the strokes, millimetres.
    pub length: f64,
    /// Whether that is in the time: whether the profile tells how fast it goes.
    pub timed: bool,
    /// Pieces that are too small for their number.
    pub too_small: usize,
    /// Whether the part's name found room.
    pub named: bool,
}

/// What another place of piercing, or another order, costs beside slits pierced at their ends in the order of the least way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Price {
    /// More cuts.
    pub cuts: usize,
    /// More way between cuts, millimetres.
    pub travel: f64,
    /// More time, seconds; `None` where the profile does not tell the machine's speeds.
    pub time: Option<f64>,
}

/// What is done besides the cuts.
pub(super) struct Finish<'a> {
    pub tabs: Option<Tabs>,
    pub without_lead: usize,
    pub engraved: Option<&'a Engraved>,
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
    /// A way than which none is shorter, millimetres, by a better bound than the tree's; `None` for many cuts.
    pub least_way: Option<f64>,
    /// The time; `None` where the profile does not tell the machine's speeds.
    pub times: Option<Times>,
    /// Where slits are pierced.
    pub pierce: Pierce,
    /// What the order saves.
    pub order: CutOrder,
    /// The rest of hinges between cuts.
    pub rest: Rest,
    /// What the choice of piercing and order costs; `None` where both are the cheapest.
    pub price: Option<Price>,
    /// The leads, where there are any asked for.
    pub leads: Option<LeadReport>,
    /// The tabs of the first copy.
    pub tabs: Option<Tabs>,
    /// What is engraved on each copy.
    pub engraved: Option<EngraveReport>,
    /// Least distance between ends of different cuts that do not coincide, millimetres; infinite where there are none.
    pub end_gap: f64,
}

impl CutReport {
    /// The largest tolerance with which a program may join ends of cuts without welding different cuts together,
    /// millimetres: half of the least distance between them, as both ends may be moved.
    pub fn join_tolerance(&self) -> f64 {
        0.5 * self.end_gap
    }

    /// `plain`: the cuts with slits pierced at their ends, in the order of the least way, without leads and tabs.
    pub(super) fn new(
        paths: &[CutPath],
        plain: &[CutPath],
        finish: Finish,
        rest: Rest,
        copies: Vec<Vec2>,
        profile: &Profile,
        options: &CutOptions,
    ) -> Self {
        let CutOptions { pierce, order, passes, .. } = *options;
        let (mut taken, end_gap) = rayon::join(|| Taken::new(paths, profile, passes), || end_gap(paths));
        let dear = pierce == Pierce::MidSlit || order != CutOrder::Travel;
        let price = dear.then(|| taken.beside(&Taken::new(plain, profile, passes)));
        let leads = options.leads.map(|leads| {
            let lengths = paths.iter().filter(|path| path.kind == CutKind::Lead).map(CutPath::length);
            let range = |[low, high]: [f64; 2], length: f64| [low.min(length), high.max(length)];
            LeadReport {
                shape: leads.shape,
                count: lengths.clone().count(),
                lengths: lengths.fold([leads.length, 0.0], range),
                without: finish.without_lead,
            }
        });
        let engraved = finish.engraved.map(|engraved| {
            let [length, between] = strokes(engraved);
            let machine = profile.machine.as_ref();
            let speeds = machine.and_then(|machine| Some((machine.engrave_speed?, machine.rapid_speed)));
            if let (Some(times), Some((speed, rapid))) = (&mut taken.times, speeds) {
                times.engraving = copies.len() as f64 * (length / speed + between / rapid);
            }
            EngraveReport {
                texts: engraved.engravings.len(),
                length,
                timed: speeds.is_some(),
                too_small: engraved.too_small,
                named: engraved.named,
            }
        });
        CutReport {
            copies,
            kerf: profile.cut.kerf,
            passes,
            cuts: taken.cuts,
            length: taken.length,
            travel: taken.travel,
            least_way: least_way(paths, taken.travel),
            times: taken.times,
            pierce,
            order,
            rest,
            price,
            leads,
            tabs: finish.tabs,
            engraved,
            end_gap,
        }
    }
}

/// Length of the strokes on one part, and of the ways from one to the next, millimetres.
fn strokes(engraved: &Engraved) -> [f64; 2] {
    let strokes: Vec<&[Point]> =
        engraved.engravings.iter().flat_map(|engraving| &engraving.strokes).map(Vec::as_slice).collect();
    let along = strokes.iter().flat_map(|stroke| stroke.windows(2)).map(|pair| pair[0].distance(pair[1]));
    let between = strokes.windows(2).filter_map(|pair| Some(pair[0].last()?.distance(*pair[1].first()?)));
    [along.sum(), between.sum()]
}

/// What cuts take.
struct Taken {
    cuts: usize,
    length: f64,
    travel: Travel,
    times: Option<Times>,
}

impl Taken {
    fn new(paths: &[CutPath], profile: &Profile, passes: usize) -> Self {
        let travel = travel(paths);
        let length: f64 = paths.iter().map(CutPath::length).sum();
        let again = (passes - 1) as f64;
        // A lead is the beginning of the cut after it.
        let cuts = paths.iter().filter(|path| path.kind != CutKind::Lead).count();
        let open = paths.iter().filter(|path| !path.closed && path.kind != CutKind::Lead);
        let back: f64 = open
            .map(|path| path.vertices[0].point.distance(path.vertices[path.vertices.len() - 1].point))
            .sum();
        let times =
            profile.machine.as_ref().map(|&Machine { rapid_speed, pierce_time, hourly_rate, .. }| Times {
                cutting: length / profile.cut.speed,
                travel: (travel.length + again * back) / rapid_speed,
                piercing: pierce_time * (passes * cuts) as f64,
                engraving: 0.0,
                hourly_rate,
            });
        Self { cuts, length, travel, times }
    }

    fn beside(&self, plain: &Taken) -> Price {
        let time = |taken: &Taken| taken.times.as_ref().map(Times::total);
        Price {
            cuts: self.cuts.saturating_sub(plain.cuts),
            travel: self.travel.length - plain.travel.length,
            time: time(self).zip(time(plain)).map(|(own, plain)| own - plain),
        }
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

impl CutReport {
    /// What is printed, line by line.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.cuts_line()];
        lines.extend(self.times.as_ref().map(times_line));
        lines.extend(self.heat_line());
        lines.extend(self.price.map(price_line));
        lines.extend(self.leads.map(leads_line));
        lines.extend(self.tabs.as_ref().map(tabs_line));
        lines.extend(self.engraved.map(engraved_line));
        lines.push(match self.join_tolerance() {
            tolerance if tolerance.is_finite() => format!(
                "kerf {} mm applied; ends of different cuts are {:.3} mm apart or more: join them with up to {tolerance:.3} mm",
                self.kerf, self.end_gap
            ),
            _ => format!("kerf {} mm applied; every cut is closed: ends may be joined with any tolerance", self.kerf),
        });
        lines
    }

    fn cuts_line(&self) -> String {
        let copies = match self.copies.len() {
            1 => String::new(),
            count => format!("{count} copies, "),
        };
        let passes = match self.passes {
            1 => String::new(),
            count => format!(", {count} passes"),
        };
        let Travel { length, bound } = self.travel;
        let ratio = |bound: f64| if bound > 0.0 { length / bound } else { 1.0 };
        let least = self.least_way.map_or(String::new(), |least| {
            format!(", {:.3} of the ascent's bound ({:.2} m)", ratio(least), 1e-3 * least)
        });
        format!(
            "{copies}{} cuts of {:.2} m{passes}; {:.2} m between them, {:.3} of the tree's bound ({:.2} m){least}",
            self.cuts,
            1e-3 * self.length,
            1e-3 * length,
            ratio(bound),
            1e-3 * bound,
        )
    }

    fn heat_line(&self) -> Option<String> {
        let CutOrder::Heat { cool, .. } = self.order else { return None };
        let Rest { least, early, apart } = self.rest;
        let least = if least.is_finite() { duration(least) } else { "none".to_owned() };
        let mut line = format!("{early} cuts begin before a hinge has rested {cool} s, the least is {least}");
        if apart.is_finite() {
            line += &format!("; a cut at a hinge follows one at least {apart:.2} mm away");
        }
        Some(line)
    }
}

fn times_line(times: &Times) -> String {
    let mut line = format!(
        "about {}: cutting {}, travel {}, piercing {}",
        duration(times.total()),
        duration(times.cutting),
        duration(times.travel),
        duration(times.piercing),
    );
    if times.engraving > 0.0 {
        line += &format!(", engraving {}", duration(times.engraving));
    }
    if let Some((cost, rate)) = times.cost().zip(times.hourly_rate) {
        line += &format!("; cost {cost:.2} at {rate:.2} an hour");
    }
    line
}

fn price_line(Price { cuts, travel, time }: Price) -> String {
    let time = time.map_or(String::new(), |time| format!(", {} more", duration(time.max(0.0))));
    format!(
        "that is {cuts} cuts and {:.2} m of travel more{time} than slits pierced at their ends on the shortest way",
        1e-3 * travel
    )
}

fn leads_line(LeadReport { shape, count, lengths: [least, most], without }: LeadReport) -> String {
    let shape = match shape {
        LeadShape::Line => "straight leads",
        LeadShape::Arc => "arcs as leads",
    };
    let without = match without {
        0 => String::new(),
        count => format!("; {count} cuts have no room for one and are pierced on their line"),
    };
    format!("{count} {shape} of {least:.2} to {most:.2} mm in scrap, on layer LEAD{without}")
}

fn tabs_line(tabs: &Tabs) -> String {
    format!(
        "{} tabs of {} mm hold each part: when it is cool, cut them through or bend them until they break, holding the part \
         beside the tab, and file the stubs flush",
        tabs.places.len(),
        tabs.width
    )
}

fn engraved_line(EngraveReport { texts, length, timed, too_small, named }: EngraveReport) -> String {
    let timed = if timed { "" } else { ", not in the time: the profile has no engrave_speed_mm_per_s" };
    let small = match too_small {
        0 => String::new(),
        count => format!("; {count} pieces are too small for their number"),
    };
    let name = if named { "" } else { "; no piece has room for the part's name" };
    format!(
        "{texts} texts of {:.2} m to engrave on each part, on layer ENGRAVE{timed}{small}{name}",
        1e-3 * length
    )
}
