//! Programs with spoiled lines.

use std::collections::HashSet;

use kirimorph::machine::{self, Header, Machine, Motion};
use kirimorph::milling::sweep::{Neck, Wanted as WantedPart};
use kirimorph::milling::toolpath::Pose;
use kirimorph::pipeline::mill::{Milled, Order, measure, mill, walls};
use kirimorph::profile::Profile;
use kirimorph::solid::{ThickSheet, thicken};
use kurbo::{Point, Rect, Vec2};

use super::{HASH, Sample, distance, places};

/// Parts of the thickness, from the top, at which the tool's way is looked at.
const HEIGHTS: [f64; 5] = [0.02, 0.27, 0.5, 0.73, 0.98];

/// A sample's program with what it is held against.
pub struct Program<'a> {
    pub sample: &'a Sample,
    machine: &'a Machine,
    thick: ThickSheet,
    necks: Vec<Neck>,
    milled: Milled,
}

pub fn program(sample: &Sample) -> Program<'_> {
    let profile: &Profile = &sample.job.fabrication.profile;
    let (machine, tool) = (sample.job.fabrication.machine.as_ref().unwrap(), profile.tool.unwrap());
    let thick = thicken(&sample.sheet, profile.sheet.thickness, walls(profile)).unwrap();
    let order = Order {
        sheet: &sample.sheet,
        part: &thick.part,
        profile,
        tool: &tool,
        copies: &[Vec2::ZERO],
        machine,
    };
    let header = Header { hash: HASH.to_owned(), spindle_rpm: tool.spindle, ..Header::default() };
    let milled = mill(&order, &header).unwrap();
    let necks = sample.sheet.hinges.iter().map(|row| Neck::new(row, false)).collect();
    Program { sample, machine, thick, necks, milled }
}

impl Program<'_> {
    pub fn text(&self) -> &str {
        let [(_, text)] = self.milled.program.files.as_slice() else { panic!("more than one file") };
        text
    }

    /// Whether a changed program is refused.
    pub fn refuses(&self, text: &str) -> bool {
        let profile = &self.sample.job.fabrication.profile;
        let wanted = WantedPart {
            part: &self.thick.part,
            copies: 1,
            necks: &self.necks,
            stock: [profile.sheet.width, profile.sheet.height],
            thickness: profile.sheet.thickness,
            radius: 0.5 * profile.cut.kerf,
            tool: &self.milled.tool,
            tabs: &self.milled.planned.tabs,
        };
        let found = measure(&[("mill.ngc".to_owned(), text.to_owned())], 0, self.machine, &wanted);
        found.map_or(true, |(_, findings)| !findings.is_empty())
    }

    /// How far the tool of a changed program strays from where it went, or does not come where it did, at any height of the
    /// stock, millimetres.
    pub fn differs(&self, text: &str) -> f64 {
        let [before, after] = [self.text(), text].map(|text| machine::read(text, self.machine).unwrap());
        let thickness = self.sample.job.fabrication.profile.sheet.thickness;
        let strays = |of: &[Motion], from: &[Motion]| {
            let known: HashSet<[u64; 12]> = from.iter().map(bits).collect();
            let changed: Vec<&Motion> = of.iter().filter(|motion| !known.contains(&bits(motion))).collect();
            let at_height = |part: f64| stray(&changed, from, -part * thickness);
            HEIGHTS.into_iter().map(at_height).fold(0.0, f64::max)
        };
        strays(&before, &after).max(strays(&after, &before))
    }
}

/// The ends of a move, to be compared exactly.
fn bits(motion: &Motion) -> [u64; 12] {
    let ends =
        [motion.from, motion.pose].map(|Pose { tip, axis }| [tip.x, tip.y, tip.z, axis.x, axis.y, axis.z]);
    std::array::from_fn(|i| ends[i / 6][i % 6].to_bits())
}

/// How far the axis of the tool of some moves is from those of others, at a height that it has reached.
fn stray(changed: &[&Motion], from: &[Motion], z: f64) -> f64 {
    let lines: Vec<[Point; 2]> = changed.iter().filter_map(|motion| axis_way(motion, z)).collect();
    let Some(first) = lines.first() else { return 0.0 };
    let start = Rect::from_points(first[0], first[1]);
    let place = lines.iter().flatten().fold(start, |place, end| place.union_pt(*end)).inflate(1.0, 1.0);
    let near = |line: &[Point; 2]| Rect::from_points(line[0], line[1]).overlaps(place);
    let others: Vec<[Point; 2]> = from.iter().filter_map(|motion| axis_way(motion, z)).filter(near).collect();
    let off = |line: &[Point; 2]| places(*line, 0.05).map(|at| distance(at, &others)).fold(0.0, f64::max);
    lines.iter().map(off).fold(0.0, f64::max)
}

/// The straight way of the tool's axis at a height, if the tip is below it all the time.
fn axis_way(motion: &Motion, z: f64) -> Option<[Point; 2]> {
    let ends = [motion.from, motion.pose];
    ends.iter().all(|pose| pose.tip.z <= z).then(|| {
        ends.map(|Pose { tip, axis }| {
            Point::new(tip.x, tip.y) + (z - tip.z) * Vec2::new(axis.x, axis.y) / axis.z
        })
    })
}
