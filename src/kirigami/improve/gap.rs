//! Room for ligaments: where the hinge points of a closed sheet stand when slits pass between them.

use std::collections::HashMap;

use crate::geometry::{Point3, Vector3, centroid};
use crate::kirigami::design::Design;

/// The neighbourhoods of a closed, flat sheet: which vertices are hinged together, and what lies across each side.
pub struct Slits {
    /// Per piece and vertex, the vertices hinged with it (itself among them).
    groups: Vec<Vec<Vec<[usize; 2]>>>,
    /// The piece to the left of each directed pair of corners.
    left: HashMap<[usize; 2], usize>,
}

impl Slits {
    /// Of a design whose pieces share the corners between which their sides lie.
    pub fn new(design: &Design) -> Self {
        let own = |piece: usize| (0..design.pieces[piece].corners.len()).map(move |v| vec![[piece, v]]);
        let mut groups: Vec<Vec<Vec<[usize; 2]>>> =
            (0..design.pieces.len()).map(|piece| own(piece).collect()).collect();
        for hinge in &design.hinges {
            let [j, k] = [0, 1].map(|end| [hinge.pieces[end], hinge.vertices[end]]);
            groups[j[0]][j[1]].push(k);
            groups[k[0]][k[1]].push(j);
        }
        let mut left = HashMap::new();
        for (id, piece) in design.pieces.iter().enumerate() {
            for (v, &corner) in piece.corners.iter().enumerate() {
                left.insert([corner, piece.corners[(v + 1) % piece.corners.len()]], id);
            }
        }
        Self { groups, left }
    }

    /// A hinge whose pieces do not lie side by side at its corner: its slit is not closed.
    pub fn unclosed(&self, design: &Design) -> Option<usize> {
        design.hinges.iter().position(|hinge| {
            let [j, v] = [hinge.pieces[0], hinge.vertices[0]];
            self.sides(design, [j, v]).iter().all(|&(_, across)| across != Some(hinge.pieces[1]))
        })
    }

    /// The far corners of a vertex' two sides, and the pieces across them.
    fn sides(&self, design: &Design, [piece, vertex]: [usize; 2]) -> [(usize, Option<usize>); 2] {
        let corners = &design.pieces[piece].corners;
        let n = corners.len();
        let (at, next, previous) =
            (corners[vertex], corners[(vertex + 1) % n], corners[(vertex + n - 1) % n]);
        [(next, self.left.get(&[next, at]).copied()), (previous, self.left.get(&[at, previous]).copied())]
    }

    /// Offset of each vertex from its corner, in units of half the gap: along the unit normal of the slit that passes
    /// the corner, towards the vertex' own pieces; zero where none passes. `corners`: where the corners are.
    pub fn offsets(&self, design: &Design, corners: &[Point3]) -> Vec<Vec<Vector3>> {
        let of_piece = |(id, groups): (usize, &Vec<Vec<[usize; 2]>>)| {
            groups.iter().enumerate().map(|(v, group)| self.offset(design, corners, [id, v], group)).collect()
        };
        self.groups.iter().enumerate().map(of_piece).collect()
    }

    fn offset(&self, design: &Design, corners: &[Point3], own: [usize; 2], group: &[[usize; 2]]) -> Vector3 {
        let at = corners[design.pieces[own[0]].corners[own[1]]];
        let members: Vec<usize> = group.iter().map(|member| member[0]).collect();
        // Sides that do not lie between two of the group's pieces: slits, and the sheet's border.
        let outer: Vec<(usize, Option<usize>)> = group
            .iter()
            .flat_map(|&member| self.sides(design, member))
            .filter(|(_, across)| across.is_none_or(|piece| !members.contains(&piece)))
            .collect();
        let slits: Vec<usize> =
            outer.iter().filter(|(_, across)| across.is_some()).map(|(far, _)| *far).collect();
        let along = match (group.len(), &slits[..], &outer[..]) {
            (_, [], _) => return Vector3::zeros(),
            (2, _, [(a, _), (b, _)]) => corners[*a] - corners[*b],
            (1, [far], _) => corners[*far] - at,
            (1, [a, b], _) => corners[*a] - corners[*b],
            // Three pieces in one hinge, or a fan that is no fan: left as it is.
            _ => return Vector3::zeros(),
        };
        let normal = Vector3::new(-along.y, along.x, 0.0).try_normalize(0.0).unwrap_or_default();
        let cell = |piece: usize| {
            let own: Vec<Point3> = design.pieces[piece].corners.iter().map(|&c| corners[c]).collect();
            centroid(&own) - at
        };
        let inwards: Vector3 = members.iter().map(|&piece| cell(piece)).sum();
        normal * normal.dot(&inwards).signum()
    }
}
