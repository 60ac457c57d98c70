//! Corners inside of the sheet.

use kurbo::{Point, Vec2};

use super::{Corner, Sheet, between, crossing, towards};

impl Sheet<'_> {
    /// What comes to a corner away from the border; `None` where that is not known.
    pub(super) fn inner_corner(&self, corner: usize) -> Option<Corner> {
        let edges = &self.topology.fans[corner].edges;
        let (hinged, passing): (Vec<usize>, Vec<usize>) =
            edges.iter().partition(|&&edge| self.hinge(corner, edge).is_some());
        match (hinged.len(), passing.as_slice()) {
            (0, []) => Some(Corner::default()),
            // A slit turns.
            (0, &[a, b]) => {
                let at = vec![self.place(corner)];
                Some(Corner { ends: vec![(a, at.clone()), (b, at)], more: Vec::new() })
            }
            (1 | 2, &[a, b]) => Some(self.passed(corner, &hinged, [a, b])),
            (3.., _) => self.junction(corner, edges),
            _ => None,
        }
    }

    /// One slit passes between one or two hinges.
    fn passed(&self, corner: usize, hinged: &[usize], passing: [usize; 2]) -> Corner {
        let at = self.place(corner);
        let first = self.vertex(corner, hinged[0]);
        let opposite = hinged.get(1).map_or(at, |&edge| self.vertex(corner, edge));
        let normal = between(opposite, first).unwrap_or_else(|| self.across(corner, passing, hinged[0]));
        let along = towards(normal.turn_90(), self.far(corner, passing[0]) - at);
        let mut found = Corner::default();
        for (edge, along) in [(passing[0], along), (passing[1], -along)] {
            found.ends.push((edge, vec![at + self.reach(corner, edge, hinged) * along, at]));
        }
        for (&edge, normal) in hinged.iter().zip([normal, -normal]) {
            let end = at + self.gap * normal;
            found.ends.push((edge, vec![end]));
            found.more.extend(self.bar(edge, end, normal));
        }
        found
    }

    /// Several slits meet on a polygon that is cut out: behind every ligament it has a straight side.
    fn junction(&self, corner: usize, edges: &[usize]) -> Option<Corner> {
        let at = self.place(corner);
        let count = edges.len();
        let mut found = Corner::default();
        let mut sides: Vec<(usize, Point, Vec2)> = Vec::new();
        for (i, &edge) in edges.iter().enumerate() {
            let Some(hinge) = self.hinge(corner, edge) else { continue };
            // Hinges without a gap stand beside their ligaments, by what is not known here.
            let point = self.vertex(corner, edge);
            let normal = between(at, point)?;
            let foot = point + (self.pole(hinge) - 0.5 * self.gap) * normal;
            let end = foot + self.gap * normal;
            found.ends.push((edge, vec![end]));
            found.more.extend(self.bar(edge, end, normal));
            sides.push((i, foot, normal.turn_90()));
        }
        for (k, &(i, foot, along)) in sides.iter().enumerate() {
            let (j, next, onwards) = sides[(k + 1) % sides.len()];
            let meet = crossing((foot, along), (next, onwards))?;
            let edge = edges[(i + 1) % count];
            // Where ligaments need more room the polygon is larger than the design's.
            let far = self.far(corner, edge) - meet;
            let ways = [(i, meet - foot), (j, meet - next)];
            if ways.into_iter().any(|(side, way)| way.length() < self.needed(edges[side], way, far)) {
                return None;
            }
            found.ends.push((edge, vec![meet]));
            found.more.extend([(edges[i], [foot, meet]), (edges[j], [meet, next])]);
        }
        Some(found)
    }

    /// How far beside a ligament's middle a cut may begin to turn, so that it keeps away from the end of the bar. `way`: along the
    /// ligament; `onwards`: where the cut goes on to.
    fn needed(&self, hinged: usize, way: Vec2, onwards: Vec2) -> f64 {
        let length = self.topology.edges[hinged].hinge.map_or(0.0, |hinge| self.lengths[hinge.id]);
        let turn = way.cross(onwards).abs().atan2(way.dot(onwards)).clamp(0.0, 0.5 * std::f64::consts::PI);
        0.5 * (length - self.kerf) + self.gap * (0.5 * turn).tan() + 0.3 * self.kerf
    }
}
