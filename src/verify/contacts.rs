//! Which cuts meet, which run along each other, and how near the others come.

use std::sync::atomic::{AtomicUsize, Ordering};

use kurbo::{Point, Rect};
use rayon::prelude::*;

use super::grooves::{Grooves, Segment};
use crate::fabrication::web::segment_gap;
use crate::profile::Profile;

/// Two cuts that run within this distance of each other burn the same groove, millimetres.
const SHADOW: f64 = 1e-3;

/// Two cuts that come near each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    /// Their indices; the first is smaller, or both are the same cut.
    pub paths: [usize; 2],
    /// Least distance of their centre lines, millimetres, and where.
    pub gap: f64,
    /// Midway between the nearest points.
    pub at: Point,
    /// Box of the places where their grooves meet; `None` where they do not.
    pub contact: Option<Rect>,
    /// Length over which they run along each other.
    pub shared: f64,
}

/// All pairs of cuts that are near each other, and the cuts whose own groove comes back to itself.
pub(super) struct Contacts {
    /// Pairs of different cuts within a ligament's width and a kerf of each other, by their indices.
    pub pairs: Vec<Pair>,
    /// Cuts that run along themselves, with the length.
    pub folded: Vec<Pair>,
    /// For every cut whether its groove meets itself again.
    pub returns: Vec<bool>,
}

/// Cuts that meet so often that they are no pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crowded;

/// Pairs of segments that may meet, for each segment and besides. Cuts of ours have a few; those of a file that goes over its
/// border a hundred times have so many that neither time nor memory is enough.
const MOST_MEETING: [usize; 2] = [10, 100_000];

impl Contacts {
    /// # Errors
    /// Far more of them than any pattern has.
    pub fn new(grooves: &Grooves, profile: &Profile) -> Result<Self, Crowded> {
        let kerf = profile.cut.kerf;
        // A little more than the grooves of a ligament, so that the least web is always found.
        let range = 1.1 * profile.hinge_gap();
        let most = MOST_MEETING[0] * grooves.segments.len() + MOST_MEETING[1];
        let meeting = AtomicUsize::new(0);
        let search = |index: usize| -> Vec<Pair> {
            if meeting.load(Ordering::Relaxed) > most {
                return Vec::new();
            }
            let pairs = near_pairs(grooves, index, range, kerf);
            let count = pairs.iter().filter(|pair| pair.contact.is_some() || pair.shared > 0.0).count();
            meeting.fetch_add(count, Ordering::Relaxed);
            pairs
        };
        let mut found: Vec<Pair> =
            (0..grooves.segments.len()).into_par_iter().flat_map_iter(search).collect();
        if meeting.into_inner() > most {
            return Err(Crowded);
        }
        // Stable, after a parallel search in the segments' order; ties by place, as the index has no order.
        found.sort_by(|a, b| {
            a.paths
                .cmp(&b.paths)
                .then(a.gap.total_cmp(&b.gap))
                .then(a.at.x.total_cmp(&b.at.x))
                .then(a.at.y.total_cmp(&b.at.y))
        });
        let mut returns = vec![false; grooves.paths.len()];
        let mut pairs: Vec<Pair> = Vec::new();
        for pair in found {
            match pairs.last_mut().filter(|last| last.paths == pair.paths) {
                Some(last) => {
                    last.contact = united(last.contact, pair.contact);
                    last.shared += pair.shared;
                }
                None => pairs.push(pair),
            }
        }
        let (own, pairs): (Vec<Pair>, Vec<Pair>) =
            pairs.into_iter().partition(|pair| pair.paths[0] == pair.paths[1]);
        own.iter().for_each(|pair| returns[pair.paths[0]] |= pair.contact.is_some());
        Ok(Self { pairs, folded: own.into_iter().filter(|pair| pair.shared > 0.0).collect(), returns })
    }
}

/// The pairs of one segment with later ones.
fn near_pairs(grooves: &Grooves, index: usize, range: f64, kerf: f64) -> Vec<Pair> {
    let segment = &grooves.segments[index];
    let place = Rect::from_points(segment.ends[0], segment.ends[1]).inflate(range, range);
    let pair = |other: usize| -> Option<Pair> {
        let next = &grooves.segments[other];
        let own = segment.path == next.path;
        let range = if own { kerf } else { range };
        let boxes = [segment, next].map(|segment| Rect::from_points(segment.ends[0], segment.ends[1]));
        if !boxes[0].inflate(range, range).overlaps(boxes[1]) {
            return None;
        }
        let (gap, at) = segment_gap(segment.ends, next.ends);
        if gap > range {
            return None;
        }
        let shared = if gap <= SHADOW { shared_length(segment, next) } else { 0.0 };
        // Along one cut grooves of neighbours meet anyway; farther on they enclose something.
        let meets = gap < kerf && !(own && separation(grooves, segment, next) <= 2.0 * kerf);
        let contact = meets.then(|| Rect::from_points(at, at));
        let of_use = !own || contact.is_some() || shared > 0.0;
        of_use.then_some(Pair { paths: [segment.path, next.path], gap, at, contact, shared })
    };
    grooves.near(place).filter(|&other| other > index).filter_map(pair).collect()
}

/// Length of the cut between two of its segments, the shorter way round.
fn separation(grooves: &Grooves, first: &Segment, second: &Segment) -> f64 {
    let between = second.start - first.start - first.length();
    match grooves.paths[first.path].closed {
        true => between.min(grooves.lengths[first.path] - (second.start + second.length()) + first.start),
        false => between,
    }
}

/// Length of the part of `second` that lies within [`SHADOW`] of `first` and beside it.
fn shared_length(first: &Segment, second: &Segment) -> f64 {
    let length = first.length();
    if length == 0.0 {
        return 0.0;
    }
    let along = (first.ends[1] - first.ends[0]) / length;
    let [a, b] = second.ends.map(|end| {
        let from = end - first.ends[0];
        [along.dot(from), along.cross(from)]
    });
    // The part of 0..1 where both coordinates, linear in it, are within their limits.
    let mut part = [0.0_f64, 1.0_f64];
    for (k, [low, high]) in [[0.0, length], [-SHADOW, SHADOW]].into_iter().enumerate() {
        let (start, slope) = (a[k], b[k] - a[k]);
        if slope == 0.0 {
            if start < low || start > high {
                return 0.0;
            }
            continue;
        }
        let [s, t] = [(low - start) / slope, (high - start) / slope];
        part = [part[0].max(s.min(t)), part[1].min(s.max(t))];
    }
    (part[1] - part[0]).max(0.0) * second.length()
}

fn united(a: Option<Rect>, b: Option<Rect>) -> Option<Rect> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        (a, b) => a.or(b),
    }
}
