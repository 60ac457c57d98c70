//! All cuts of an open sheet.

use kurbo::Point;

use super::neck::{Neck, necks};
use super::rim::rims;
use super::trace::trace;
use crate::fabrication::error::FabricationError;
use crate::fabrication::layout::{CutKind, CutPath, PathVertex};
use crate::fabrication::topology::Topology;
use crate::kirigami::design::Design;
use crate::profile::Profile;

/// The straight end of a window beside a ligament.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flat {
    /// Index into [`WindowCuts::paths`].
    pub path: usize,
    /// The vertex of the path from which it leads to the next one.
    pub vertex: usize,
}

/// The cuts: windows and border loops.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowCuts {
    /// The paths, all closed, the material to the left.
    pub paths: Vec<CutPath>,
    /// The two flats beside each hinge's ligament, in the hinges' order.
    pub flats: Vec<[Flat; 2]>,
    /// Where the ligaments belong, in the hinges' order.
    pub necks: Vec<Neck>,
}

impl WindowCuts {
    /// Builds all cuts: windows in the corners' order, then the border loops.
    ///
    /// # Errors
    /// See [`trace`]; several outer borders.
    pub fn new(
        design: &Design,
        topology: &Topology,
        profile: &Profile,
        lengths: &[f64],
    ) -> Result<Self, FabricationError> {
        let necks = necks(design, profile, lengths)?;
        let mut flats: Vec<Vec<Flat>> = vec![Vec::new(); necks.len()];
        let mut paths = Vec::new();
        for rim in rims(design, topology, profile)? {
            let traced = trace(&rim, design, &necks, profile)?;
            for (hinge, vertex) in traced.flats {
                flats[hinge].push(Flat { path: paths.len(), vertex });
            }
            paths.push(traced.path);
        }
        let count = paths.iter().filter(|path| path.kind == CutKind::Border).count();
        if count != 1 {
            return Err(FabricationError::SeveralParts { count });
        }
        let pair = |(hinge, flats): (usize, Vec<Flat>)| {
            <[Flat; 2]>::try_from(flats).map_err(|flats| FabricationError::BadHinge {
                hinge,
                reason: format!("{} windows instead of 2 end at it", flats.len()),
            })
        };
        let flats = flats.into_iter().enumerate().map(pair).collect::<Result<_, _>>()?;
        Ok(WindowCuts { paths, flats, necks })
    }

    /// The ends of a flat.
    pub fn segment(&self, flat: Flat) -> [Point; 2] {
        let vertices = &self.paths[flat.path].vertices;
        [flat.vertex, flat.vertex + 1].map(|i| vertices[i % vertices.len()].point)
    }

    /// The same cuts, each begun in the middle of its longest straight, far from ligaments.
    pub fn started_on_longest_straights(mut self) -> Self {
        let mut taken: Vec<Vec<usize>> = vec![Vec::new(); self.paths.len()];
        for flat in self.flats.iter().flatten() {
            taken[flat.path].push(flat.vertex);
        }
        let starts: Vec<usize> = self
            .paths
            .iter_mut()
            .zip(taken)
            .map(|(path, flats)| {
                let from = longest_straight(&path.vertices, &flats);
                let next = path.vertices[(from + 1) % path.vertices.len()].point;
                let point = path.vertices[from].point.midpoint(next);
                path.vertices.rotate_left(from + 1);
                path.vertices.insert(0, PathVertex { point, bulge: 0.0 });
                from
            })
            .collect();
        for flat in self.flats.iter_mut().flatten() {
            let count = self.paths[flat.path].vertices.len() - 1;
            flat.vertex = (flat.vertex + count - starts[flat.path] - 1) % count + 1;
        }
        self
    }
}

/// The vertex from which the longest straight segment leaves that is no flat.
fn longest_straight(vertices: &[PathVertex], flats: &[usize]) -> usize {
    let mut best = (0, 0.0);
    for (i, vertex) in vertices.iter().enumerate() {
        let length = vertex.point.distance(vertices[(i + 1) % vertices.len()].point);
        if vertex.bulge == 0.0 && length > best.1 && !flats.contains(&i) {
            best = (i, length);
        }
    }
    best.0
}
