//! Which corners of which pieces are hinged, and which pieces hang together.

use std::collections::HashSet;

use super::error::{ImportError, named};
use super::source::Source;
use crate::geometry::Point3;
use crate::geometry::coincidence::{Near, clusters, mean, members, near_pairs};
use crate::kirigami::hinges::Joint;

/// All corners of all pieces in one row.
pub struct Corners {
    /// #C: the piece of each corner.
    pub piece: Vec<usize>,
    /// #C: the number of each corner in its piece.
    pub vertex: Vec<usize>,
    /// #P: the first corner of each piece.
    pub first: Vec<usize>,
}

impl Corners {
    /// Numbers the corners of `polygons`.
    pub fn new(polygons: &[Vec<Point3>]) -> Self {
        let mut corners = Self { piece: Vec::new(), vertex: Vec::new(), first: Vec::new() };
        for (piece, polygon) in polygons.iter().enumerate() {
            corners.first.push(corners.piece.len());
            corners.piece.extend(std::iter::repeat_n(piece, polygon.len()));
            corners.vertex.extend(0..polygon.len());
        }
        corners
    }
}

/// The points of a state in the order of [`Corners`].
pub fn row(polygons: &[Vec<Point3>]) -> Vec<Point3> {
    polygons.iter().flatten().copied().collect()
}

/// Finds the hinges and moves the corners of each hinge to their mean, in both states. Returns them with warnings.
///
/// # Errors
/// A constraint whose corners are apart, no hinges at all, or pieces that do not hang together.
pub fn joints(source: &mut Source, tolerance: f64) -> Result<(Vec<Joint>, Vec<String>), ImportError> {
    let corners = Corners::new(&source.closed);
    let mut warnings = Vec::new();
    let coincident = coincident(source, &corners, tolerance);
    let (joints, cluster_of) = match &source.constraints {
        None => {
            let (joints, many) = chains(&coincident, &corners);
            if let Some(cluster) = many {
                let pieces: Vec<usize> = cluster.iter().map(|&corner| corners.piece[corner]).collect();
                warnings.push(format!("{} meet in one hinge point and are hinged in a row", named(&pieces)));
            }
            (joints, coincident)
        }
        Some(_) => constrained(source, &corners, &coincident, tolerance, &mut warnings)?,
    };
    if joints.is_empty() {
        return Err(ImportError::NoHinges { tolerance });
    }
    check_connected(&joints, source.closed.len(), tolerance)?;
    for cluster in members(&cluster_of).iter().filter(|cluster| cluster.len() > 1) {
        for polygons in [&mut source.closed, &mut source.open] {
            let at = mean(cluster.iter().map(|&c| polygons[corners.piece[c]][corners.vertex[c]]));
            for &c in cluster {
                polygons[corners.piece[c]][corners.vertex[c]] = at;
            }
        }
    }
    Ok((joints, warnings))
}

/// Clusters of corners of different pieces that coincide in both states.
fn coincident(source: &Source, corners: &Corners, tolerance: f64) -> Vec<usize> {
    let open = row(&source.open);
    let pairs = near_pairs(&row(&source.closed), tolerance)
        .into_iter()
        .map(|Near { points: [i, j], distance }| Near {
            points: [i, j],
            distance: distance.max((open[i] - open[j]).norm()),
        })
        .filter(|near| near.distance <= tolerance);
    clusters(pairs.collect(), &corners.piece)
}

/// Joints of clusters of two; more pieces are joined in a row. Returns also the first cluster of more than two.
fn chains(cluster_of: &[usize], corners: &Corners) -> (Vec<Joint>, Option<Vec<usize>>) {
    let clusters = members(cluster_of);
    let joint = |pair: &[usize]| Joint {
        pieces: [corners.piece[pair[0]], corners.piece[pair[1]]],
        vertices: [corners.vertex[pair[0]], corners.vertex[pair[1]]],
    };
    let mut joints: Vec<Joint> = clusters.iter().flat_map(|cluster| cluster.windows(2).map(joint)).collect();
    joints.sort_unstable_by_key(|joint| (joint.pieces, joint.vertices));
    (joints, clusters.into_iter().find(|cluster| cluster.len() > 2))
}

/// The joints that the source names, each once, and the clusters of corners that they make.
fn constrained(
    source: &Source,
    corners: &Corners,
    coincident: &[usize],
    tolerance: f64,
    warnings: &mut Vec<String>,
) -> Result<(Vec<Joint>, Vec<usize>), ImportError> {
    let mut joints: Vec<Joint> = Vec::new();
    let mut pairs = Vec::new();
    let mut known = HashSet::new();
    for constraint in source.constraints.iter().flatten() {
        let ([j, k], [a, b]) = (constraint.pieces, constraint.corners);
        for (state, polygons) in [("closed", &source.closed), ("open", &source.open)] {
            let distance = (polygons[j][a] - polygons[k][b]).norm();
            if distance > tolerance {
                return Err(ImportError::ConstraintApart {
                    source_name: constraint.place.clone(),
                    pieces: [j, k],
                    corners: [a, b],
                    state,
                    distance,
                    tolerance,
                });
            }
        }
        let mut points = [corners.first[j] + a, corners.first[k] + b];
        points.sort_unstable();
        if known.insert(points) {
            pairs.push(Near { points, distance: 0.0 });
            joints.push(Joint { pieces: [j, k], vertices: [a, b] });
        }
    }
    let cluster_of = clusters(pairs, &corners.piece);
    let unnamed: Vec<Vec<usize>> = members(coincident)
        .into_iter()
        .filter(|cluster| cluster.windows(2).any(|pair| cluster_of[pair[0]] != cluster_of[pair[1]]))
        .collect();
    if let Some(first) = unnamed.first() {
        let pieces: Vec<usize> = first.iter().map(|&corner| corners.piece[corner]).collect();
        warnings.push(format!(
            "{} places where corners coincide in both states are no hinges by the constraints; the first is of {}",
            unnamed.len(),
            named(&pieces)
        ));
    }
    Ok((joints, cluster_of))
}

fn check_connected(joints: &[Joint], count: usize, tolerance: f64) -> Result<(), ImportError> {
    let owners: Vec<usize> = (0..count).collect();
    let pairs = joints.iter().map(|joint| Near { points: joint.pieces, distance: 0.0 });
    let parts = members(&clusters(pairs.collect(), &owners));
    if parts.len() == 1 {
        return Ok(());
    }
    let smallest = parts.iter().min_by_key(|part| part.len()).map_or(String::new(), |part| named(part));
    Err(ImportError::NotConnected { parts: parts.len(), smallest, tolerance })
}
