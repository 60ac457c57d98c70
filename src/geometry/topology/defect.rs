//! What keeps a mesh from being a disk, in words.

use std::fmt;

use crate::geometry::Point3;

/// Why a mesh is not a disk, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct NotADisk {
    /// The reason.
    pub defect: Defect,
    /// A vertex of the offending place, in the file's units; `None` where the mesh as a whole is meant.
    pub at: Option<Point3>,
}

impl fmt::Display for NotADisk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.defect)?;
        match self.at {
            Some(at) => write!(f, " (at x {}, y {}, z {})", at.x, at.y, at.z),
            None => Ok(()),
        }
    }
}

impl std::error::Error for NotADisk {}

/// What keeps a mesh from being a disk. Indices count from 0, the messages from 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Defect {
    /// There is no face.
    #[error("the mesh has no faces")]
    NoFaces,
    /// More than two faces share an edge.
    #[error(
        "{} faces ({}) share the edge from vertex {} to {}, an edge has one or two: \
         delete what branches off or lies double",
        .faces.len(), list(.faces), .edge[0] + 1, .edge[1] + 1
    )]
    BranchingEdge {
        /// The vertices of the edge.
        edge: [usize; 2],
        /// All faces at the edge.
        faces: Vec<usize>,
    },
    /// Two faces run through an edge in the same direction.
    #[error(
        "face {} and face {} both run from vertex {} to {}: one is wound the wrong way{}; unify the normals",
        .faces[0] + 1, .faces[1] + 1, .edge[0] + 1, .edge[1] + 1, and_more(*.more)
    )]
    Winding {
        /// The vertices of the edge, in the direction of both faces.
        edge: [usize; 2],
        /// The two faces.
        faces: [usize; 2],
        /// Number of further edges of this kind.
        more: usize,
    },
    /// No choice of windings agrees: a Möbius strip or worse.
    #[error(
        "the surface has only one side: however the faces are wound, two of them disagree, as face {} and face \
         {} do between vertex {} and {}; cut the strip open",
        .faces[0] + 1, .faces[1] + 1, .edge[0] + 1, .edge[1] + 1
    )]
    OneSided {
        /// The vertices of an edge where the windings disagree.
        edge: [usize; 2],
        /// The two faces.
        faces: [usize; 2],
    },
    /// The faces at a vertex touch in that vertex only.
    #[error(
        "the faces at vertex {} form {fans} fans that touch only there (face {} is in one of them, face {} in \
         another): split the vertex or join the faces",
        .vertex + 1, .faces[0] + 1, .faces[1] + 1
    )]
    PinchedVertex {
        /// The vertex.
        vertex: usize,
        /// Number of fans.
        fans: usize,
        /// One face of each of the first two fans.
        faces: [usize; 2],
    },
    /// Several parts.
    #[error(
        "the mesh has {} components, with {} faces: keep one of them, or join them by welding their vertices",
        .sizes.len(), sizes_list(.sizes)
    )]
    Components {
        /// Number of faces of each, largest first.
        sizes: Vec<usize>,
    },
    /// No boundary.
    #[error(
        "the mesh is a closed surface of genus {genus} ({}), not a disk: cut it open and keep the part that the \
         sheet is to cover",
        closed_name(*.genus)
    )]
    Closed {
        /// Number of handles.
        genus: usize,
    },
    /// Genus 0 with several boundary loops.
    #[error(
        "the mesh is {} with {} boundary loops (of {} edges), not a disk: fill the holes, or cut the mesh from \
         one loop to the next",
        holed_name(.loops.len()), .loops.len(), sizes_list(.loops)
    )]
    Holes {
        /// Number of edges of each boundary loop, largest first.
        loops: Vec<usize>,
    },
    /// Handles and a boundary.
    #[error(
        "the mesh has {genus} handle{} and {} boundary loop{} (for one handle and one loop: a torus with a hole), \
         not a disk: cut each handle open",
        plural(*.genus), .loops.len(), plural(.loops.len())
    )]
    Handles {
        /// Number of handles.
        genus: usize,
        /// Number of edges of each boundary loop, largest first.
        loops: Vec<usize>,
    },
}

/// At most this many numbers are listed in a message.
const MAX_LISTED: usize = 6;

/// Indices, counted from 1.
fn list(indices: &[usize]) -> String {
    sizes_list(&indices.iter().map(|index| index + 1).collect::<Vec<_>>())
}

/// "200, 10 and 2".
fn sizes_list(numbers: &[usize]) -> String {
    let text = |numbers: &[usize]| numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    match numbers {
        [many @ .., _] if many.len() >= MAX_LISTED => {
            format!("{} and {} more", text(&numbers[..MAX_LISTED]), numbers.len() - MAX_LISTED)
        }
        [several @ .., last] if !several.is_empty() => format!("{} and {last}", text(several)),
        _ => text(numbers),
    }
}

fn and_more(more: usize) -> String {
    if more == 0 { String::new() } else { format!(" (likewise at {more} more edge{})", plural(more)) }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

fn closed_name(genus: usize) -> &'static str {
    match genus {
        0 => "like a sphere",
        1 => "like a torus",
        _ => "with several handles",
    }
}

fn holed_name(loops: usize) -> String {
    if loops == 2 { "an annulus".to_owned() } else { format!("a disk with {} holes", loops - 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_cut_short() {
        assert_eq!(sizes_list(&[200]), "200");
        assert_eq!(sizes_list(&[200, 10]), "200 and 10");
        assert_eq!(sizes_list(&[200, 10, 2]), "200, 10 and 2");
        assert_eq!(sizes_list(&[9, 8, 7, 6, 5, 4]), "9, 8, 7, 6, 5 and 4");
        assert_eq!(sizes_list(&[9, 8, 7, 6, 5, 4, 3, 2]), "9, 8, 7, 6, 5, 4 and 2 more");
    }
}
