//! Stanford PLY: ASCII, little-endian and big-endian.
//!
//! Read are x, y, z of the element `vertex` and the list `vertex_indices` or `vertex_index` of the element
//! `face`; other properties and elements are passed over. Counts in the header are promises that are compared
//! with the bytes at hand before anything is reserved for them.

mod body;
mod header;

use body::Body;
use header::{Element, Header, Property, Shape};

use super::error::{InvalidMeshFile, Place, Problem};
use super::text::{check_face, point};
use crate::geometry::Point3;
use crate::geometry::mesh::PolyMesh;

/// Reads a PLY file's content.
///
/// # Errors
/// Names the line of an ASCII file or the record of a binary one, the value and the limit.
pub fn parse(bytes: &[u8]) -> Result<PolyMesh, InvalidMeshFile> {
    let (header, mut body) = header::parse(bytes)?;
    let columns = Columns::find(&header)?;
    let mut mesh = PolyMesh::default();
    for element in &header.elements {
        body.require_room(element)?;
        // Records without properties take no bytes, so their count is bounded by nothing.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for index in 0..count {
            body.begin(element, index)?;
            match element.name.as_str() {
                "vertex" => mesh.vertices.push(vertex(&mut body, element, columns.position)?),
                "face" => {
                    mesh.faces.push(face(&mut body, element, columns.indices, columns.vertex_count)?);
                }
                _ => skip(&mut body, &element.properties)?,
            }
            body.end(element)?;
        }
    }
    body.require_end()?;
    Ok(mesh)
}

/// Where the header places what is read.
struct Columns {
    /// Properties x, y, z of a vertex.
    position: [usize; 3],
    /// The list of a face's vertices.
    indices: usize,
    /// Vertices that the header states.
    vertex_count: u64,
}

impl Columns {
    fn find(header: &Header) -> Result<Self, InvalidMeshFile> {
        let element = |name: &str| header.elements.iter().find(|element| element.name == name);
        let missing = |expected: &str| {
            let problem =
                Problem::Unexpected { expected: expected.to_owned(), found: "end_header".to_owned() };
            Place::Line(header.last_line).error(problem)
        };
        let vertices =
            element("vertex").filter(|e| e.count > 0).ok_or(Place::File.error(Problem::NoVertices))?;
        let faces = element("face").filter(|e| e.count > 0).ok_or(Place::File.error(Problem::NoFaces))?;
        let coordinate = |name: &str| {
            let is_it = |p: &Property| p.name == name && matches!(p.shape, Shape::Scalar(_));
            vertices
                .properties
                .iter()
                .position(is_it)
                .ok_or_else(|| missing(&format!("a scalar property {name} of element vertex")))
        };
        let is_indices = |p: &Property| {
            let is_integer = matches!(p.shape, Shape::List { item, .. } if item.is_integer());
            is_integer && (p.name == "vertex_indices" || p.name == "vertex_index")
        };
        Ok(Self {
            position: [coordinate("x")?, coordinate("y")?, coordinate("z")?],
            indices: faces
                .properties
                .iter()
                .position(is_indices)
                .ok_or_else(|| missing("an integer list vertex_indices or vertex_index of element face"))?,
            vertex_count: vertices.count,
        })
    }
}

fn vertex(body: &mut Body, element: &Element, position: [usize; 3]) -> Result<Point3, InvalidMeshFile> {
    let mut coordinates = [0.0; 3];
    for (column, property) in element.properties.iter().enumerate() {
        match property.shape {
            Shape::Scalar(kind) => {
                let value = body.value(kind)?;
                if let Some(axis) = position.iter().position(|&p| p == column) {
                    coordinates[axis] = value;
                }
            }
            Shape::List { .. } => skip(body, std::slice::from_ref(property))?,
        }
    }
    point(coordinates).map_err(|problem| body.place().error(problem))
}

fn face(
    body: &mut Body,
    element: &Element,
    indices: usize,
    vertex_count: u64,
) -> Result<Vec<usize>, InvalidMeshFile> {
    let mut face = Vec::new();
    for (column, property) in element.properties.iter().enumerate() {
        match property.shape {
            Shape::List { count, item } if column == indices => {
                for _ in 0..body.list_length(count, item)? {
                    // Integers of 32 bits and less are exact in f64.
                    let index = body.value(item)? as i64;
                    let vertex = u64::try_from(index).ok().filter(|&vertex| vertex < vertex_count);
                    let out_of_range =
                        Problem::IndexOutOfRange { index, first: 0, last: vertex_count as i64 - 1 };
                    face.push(vertex.ok_or_else(|| body.place().error(out_of_range))? as usize);
                }
            }
            _ => skip(body, std::slice::from_ref(property))?,
        }
    }
    check_face(&face, 0).map_err(|problem| body.place().error(problem))?;
    Ok(face)
}

/// Passes over the values of `properties`.
fn skip(body: &mut Body, properties: &[Property]) -> Result<(), InvalidMeshFile> {
    for property in properties {
        match property.shape {
            Shape::Scalar(kind) => {
                body.value(kind)?;
            }
            Shape::List { count, item } => {
                for _ in 0..body.list_length(count, item)? {
                    body.value(item)?;
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
